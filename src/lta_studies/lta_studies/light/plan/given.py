"""What a layout is made of, as files have it, with single parameters replaced (--set)."""

from collections.abc import Sequence

from lta_config.errors import unknown
from lta_config.files import checked, find, load_yaml
from lta_config.override import assignment, override
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.topics import topic_table
from lta_model.vehicle import Vehicle
from lta_studies.light.plan.ear import Ear
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_vlc.settings import Demodulation

ROOTS = ('plan', 'vehicle', 'demodulator')


def given(
    plan: str, vehicle: str, margin: float, changes: Sequence[str] = ()
) -> tuple[FloorPlan, Ear]:
    """
    Return hall and drone.

    Parameters
    ----------
    plan, vehicle : str
        Shipped names or paths.
    margin : float
        How far above the demodulator's threshold the SNR must be.
    changes : sequence of str
        `PATH=VALUE`, the first word of the path one of plan, vehicle and demodulator.

    Raises
    ------
    BadInput
        If a file or a change cannot be used.

    """
    files = {'plan': find('floor plan', plan), 'vehicle': find('vehicle', vehicle)}
    contents = {root: load_yaml(path) for root, path in files.items()}
    contents['demodulator'] = Demodulation().model_dump()
    for text in changes:
        path, value = assignment(text)
        root, _, below = path.partition('.')
        if root not in ROOTS or not below:
            raise unknown('parameter', path, [f'{name}. ...' for name in ROOTS])
        contents[root] = override(contents[root], below, value, root)
    hall = checked(FloorPlan, contents['plan'], str(files['plan']))
    flown = Vehicle(checked(VehicleFile, contents['vehicle'], str(files['vehicle'])))
    settings = checked(Demodulation, contents['demodulator'], 'The demodulator')
    return hall, Ear(flown, settings, topic_table().light, margin)
