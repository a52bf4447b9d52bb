"""Load the input files of a layout, with single parameters replaced (--set)."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from lta_config.errors import unknown_name_error
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import replace_parameter
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.topics import load_topic_table
from lta_model.vehicle import Vehicle
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_studies.light.plan.receiver import LightReceiver
from lta_vlc.settings import DemodulationSettings

ROOTS = ('plan', 'vehicle', 'demodulator')


def load_inputs(
    plan: str, vehicle: str, margin: float, changes: Mapping[str, Any] = MappingProxyType({})
) -> tuple[FloorPlan, LightReceiver]:
    """
    Load the hall and the receiver.

    `plan`, `vehicle`: shipped names or paths. `margin`: required SNR relative to the demodulator's
    threshold. `changes`: values by path, which starts with plan, vehicle or demodulator.
    Raise `BadInput` if a file or a change cannot be used.
    """
    files = {'plan': find_file('floor plan', plan), 'vehicle': find_file('vehicle', vehicle)}
    contents = {root: load_yaml(path) for root, path in files.items()}
    # The demodulator has no file of its own: --set changes its defaults.
    contents['demodulator'] = DemodulationSettings().model_dump()
    for path, value in changes.items():
        root, _, below = path.partition('.')
        if root not in ROOTS or not below:
            raise unknown_name_error('parameter', path, [f'{name}. ...' for name in ROOTS])
        contents[root] = replace_parameter(contents[root], below, value, root)
    hall = validate_content(FloorPlan, contents['plan'], str(files['plan']))
    receiver = Vehicle(validate_content(VehicleFile, contents['vehicle'], str(files['vehicle'])))
    settings = validate_content(DemodulationSettings, contents['demodulator'], 'The demodulator')
    return hall, LightReceiver(receiver, settings, load_topic_table().light, margin)
