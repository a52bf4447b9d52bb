"""
What a drone over each cell hears of each lamp: light, and the signal-to-noise ratio it comes to.

Light, diodes, amplifier, converter and demodulation are the simulator's (`lta_sim.counted_light`).
"""

from collections.abc import Callable, Sequence
import math

from lta_config.compilation.compiled import compiled
from lta_model.hull import half_axes
from lta_model.light.field import LightField
from lta_model.light.lambertian import beam, Eye
from lta_model.light.lamp import Lamp
from lta_model.light.modulation import SquareWave
from lta_model.light.pencils import LAMPS, scratch_for, SHARE
from lta_model.light.setting import set_for
from lta_sim.counted_light import expected, Listening, listening_of, on_ring
from lta_studies.light.plan.crosstalk import crosstalk
from lta_studies.light.plan.ear import Ear
from lta_studies.light.plan.floor import Floor
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_studies.light.plan.frequencies import LOWEST
from lta_studies.light.plan.mounts import Mount, Vector
from lta_studies.light.plan.polygon import Array, Mask
from lta_studies.light.plan.rays import over_cells
from lta_studies.light.plan.together import heard_together, is_full, Numbers
import numpy as np

NEARLY = 1.0 - 1e-9
HEADINGS = 64  # of a full turn, 5.6 degrees apart


def field_of(plan: FloorPlan, mount: Mount, frequency: float) -> LightField:
    """Return the light of one lamp [Hz] in the hall's ambient light, without any reflection."""
    lamp = plan.lamp
    return LightField(
        lamps=(
            Lamp(
                position=mount.position,
                axis=mount.axis,
                flux=lamp.flux.si,
                wave=SquareWave(frequency, lamp.duty.si),
                efficacy=lamp.efficacy.si,
                order=lamp.order,
            ),
        ),
        ambient=plan.ambient.ambient,
    )


def listening(plan: FloorPlan, ear: Ear, mount: Mount, frequency: float) -> Listening:
    """Return what decides how a lamp is heard at a frequency. [Hz]"""
    field = field_of(plan, mount, frequency)
    return listening_of(
        field,
        set_for(field, ear.vehicle),
        half_axes(ear.vehicle.file.hull),
        ear.demodulation.model_copy(update={'frequency': frequency}),
        ear.light.sample_rate.si,
        ear.light.samples,
    )


def numbers_of(heard: Listening) -> Numbers:
    """Return what is the same for all lamps, as `ratio` takes it."""
    return (
        heard.counts, heard.dark, heard.steady, heard.top, heard.variance, heard.shot,
        heard.shot * heard.duty, heard.samples,
    )  # fmt: skip


def snr_of(heard: Listening, share: float, light: float) -> float:
    """
    Return the SNR that a lamp comes to on a diode, were it alone.

    Parameters
    ----------
    heard : Listening
        The lamp.
    share : float
        What the diode reads of light that comes alike from all sides.
    light : float
        What it reads of the lamp. [lx]

    """
    own, steady = heard.counts * light, share * heard.steady
    if is_full(own, share, numbers_of(heard)):
        return 0.0
    swing, quiet, _ = expected(heard, own, steady)
    return swing / (quiet + heard.hum * share)


def least_light(heard: Listening, share: float, needed: float) -> float:
    """Return the light from which the SNR is as needed; infinite if it never is. [lx]"""
    low, high = (
        0.0,
        max(heard.top - heard.dark - share * heard.steady, 0.0) / heard.counts * NEARLY,
    )
    if snr_of(heard, share, high) < needed:
        return math.inf
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if snr_of(heard, share, middle) >= needed else (middle, high)
    return high


def light_over(
    plan: FloorPlan,
    ear: Ear,
    floor: Floor,
    mounts: Sequence[Mount],
    faintest: float,
    tick: Callable[[], None],
) -> Array:
    """
    Return the light of every lamp over every wanted cell.

    Parameters
    ----------
    plan, ear, floor, mounts
        Hall, drone, cells and places of lamps.
    faintest : float
        Light below which a lamp counts as dark. [lx]
    tick : callable
        Called once for each lamp.

    Returns
    -------
    ndarray, shape (lamps, 2, cells)
        On the diode that gets most of it, at the worst heading and at the best. [lx]

    """
    (kernel,) = compiled(over_cells)
    cells, planes, hull = _seen_from(plan, ear, floor)
    headings, eye = headings_of(planes, hull), _eye(ear)
    light = np.zeros((len(mounts), 2, len(cells)))
    for k, mount in enumerate(mounts):
        lamp = beam(field_of(plan, mount, 1.0).lamp)
        kernel(lamp, eye, cells, floor.walls, planes, hull, headings, faintest, light[k])
        tick()
    return light


def together(
    plan: FloorPlan, ear: Ear, floor: Floor, mounts: Sequence[Mount], tones: Sequence[float],
    visible: Mask,
) -> Array:  # fmt: skip
    """
    Return the SNR of each lamp over every wanted cell while all of them are on.

    Parameters
    ----------
    plan, ear, floor, mounts
        Hall, drone, cells and lamps.
    tones : sequence of float
        Frequencies of the lamps. [Hz]
    visible : ndarray of bool, shape (lamps, cells)
        Where no wall hides them.

    """
    (kernel,) = compiled(heard_together)
    cells, planes, hull = _seen_from(plan, ear, floor)
    heard = [listening(plan, ear, *pair) for pair in zip(mounts, tones, strict=True)]
    window, quiet = crosstalk(ear, tones, plan.lamp.duty.si)
    snr = np.empty(visible.shape)
    kernel(
        np.array([each.lamp for each in heard]), _eye(ear), np.ascontiguousarray(visible.T),
        cells, planes, hull, headings_of(planes, hull), numbers_of(heard[0]),
        np.array([(each.gain, each.leak, each.hum) for each in heard]), window, quiet,
        np.empty((len(heard), len(planes))), snr,
    )  # fmt: skip
    return snr


def _eye(ear: Ear) -> Eye:
    return Eye(ear.vehicle.diodes.response, ear.vehicle.diodes.edge)


def shares(plan: FloorPlan, ear: Ear) -> Array:
    """Return which part each diode reads of light from all sides alike, shape (diodes,). [1]"""
    nowhere = Mount((0.0, 0.0, plan.lamp.height.si), (1.0, 0.0, 0.0))
    heard = listening(plan, ear, nowhere, LOWEST)
    out = np.empty((LAMPS + 1, len(heard.planes)))
    scratch = np.empty(scratch_for(1))
    on_ring(heard, (0.0, 0.0, plan.altitude.si), (0.0, 0.0, 0.0, 1.0), out, scratch)
    return np.asarray(out[SHARE])


def _seen_from(plan: FloorPlan, ear: Ear, floor: Floor) -> tuple[Array, Array, Vector]:
    """Return the hull centres over the wanted cells, the diodes and half the size of the hull."""
    centres = floor.centres
    cells = np.hstack([centres, np.full((len(centres), 1), plan.altitude.si)])
    diodes = ear.vehicle.diodes
    planes = np.column_stack([diodes.planes, diodes.factors, shares(plan, ear)])
    return cells, planes, half_axes(ear.vehicle.file.hull)


def headings_of(planes: Array, hull: Vector) -> Array:
    """Return cosine and sine of the headings to look at: where a turn changes nothing, fewer."""
    turn = 2.0 * math.pi / len(planes)
    cosine, sine = math.cos(turn), math.sin(turn)
    turned = planes.copy()
    rotation = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    turned[:, :3], turned[:, 3:6] = planes[:, :3] @ rotation, planes[:, 3:6] @ rotation
    alike = hull[0] == hull[1] and np.allclose(np.roll(turned, 1, axis=0), planes, atol=1e-9)
    count, span = (max(HEADINGS // len(planes), 4), turn) if alike else (HEADINGS, 2.0 * math.pi)
    angles = np.arange(count) * (span / count)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)
