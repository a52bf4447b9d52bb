"""
What a drone over each cell hears of each lamp: light, and the signal-to-noise ratio it comes to.

Light, diodes, amplifier, converter and demodulation are the simulator's (`lta_sim.heard_lamp`).
"""

from collections.abc import Callable, Sequence
import math

from lta_analysis.light.plan.crosstalk import crosstalk
from lta_analysis.light.plan.ear import Ear
from lta_analysis.light.plan.floor import Floor
from lta_analysis.light.plan.floor_plan import FloorPlan
from lta_analysis.light.plan.mounts import Mount, Vector
from lta_analysis.light.plan.polygon import Array, Mask
from lta_analysis.light.plan.rays import over_cells
from lta_analysis.light.plan.together import heard_together, ratio
from lta_sim.compiled import compiled
from lta_sim.heard_lamp import Listening, listening_of
from lta_sim.hull import half_axes
from lta_sim.lambertian import beam
from lta_sim.light_field import Ambient, Lamp, LightField
from lta_vlc.modulation import SquareWave
import numpy as np

# How often a lamp reads what others leave in its window: the bearing errs by 12 degrees at most.
PURE = 5.0
HEADINGS = 64  # of a full turn, 5.6 degrees apart


def field_of(plan: FloorPlan, mount: Mount, frequency: float) -> LightField:
    """Return the light of one lamp in the hall's ambient light, without any reflection."""
    lamp, ambient = plan.lamp, plan.ambient
    return LightField(
        lamp=Lamp(
            position=mount.position,
            axis=mount.axis,
            flux=lamp.flux.si,
            wave=SquareWave(frequency, lamp.duty.si),
            efficacy=lamp.efficacy.si,
            order=lamp.order,
        ),
        ambient=Ambient(
            efficacy=ambient.efficacy.si,
            steady=ambient.steady.si,
            mains=ambient.mains_amplitude.si,
            mains_frequency=ambient.mains_frequency.si,
        ),
    )


def listening(plan: FloorPlan, ear: Ear, mount: Mount, frequency: float) -> Listening:
    """Return what decides how a lamp is heard at a frequency."""
    return listening_of(
        field_of(plan, mount, frequency),
        ear.vehicle.diodes,
        ear.demodulation.model_copy(update={'frequency': frequency}),
        ear.light.sample_rate.si,
        ear.light.samples,
    )


def snr_of(heard: Listening, light: float) -> float:
    """Return the SNR that light of a lamp comes to on a diode, were the lamp alone. [lx]"""
    own = heard.counts * light
    return ratio(
        own, 0.0, 0.0, heard.gain, heard.leak, heard.hum, heard.rest, heard.top, heard.variance,
        heard.shot * heard.duty, heard.samples,
    )[1]  # fmt: skip


def least_light(heard: Listening, needed: float) -> float:
    """Return the light from which the SNR is as needed; infinite if it never is. [lx]"""
    low, high = 0.0, max(heard.top - heard.rest, 0.0) / heard.counts
    if snr_of(heard, high) < needed:
        return math.inf
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if snr_of(heard, middle) >= needed else (middle, high)
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
    headings = headings_of(planes, hull)
    light = np.zeros((len(mounts), 2, len(cells)))
    for k, mount in enumerate(mounts):
        lamp = beam(field_of(plan, mount, 1.0))
        kernel(lamp, cells, floor.walls, planes, hull, headings, faintest, light[k])
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
    one = heard[0]
    numbers = (one.counts, one.rest, one.top, one.variance, one.shot * one.duty, one.samples)
    window, quiet = crosstalk(ear, tones, plan.lamp.duty.si)
    snr = np.empty(visible.shape)
    kernel(
        np.array([each.lamp for each in heard]), visible, cells, planes, hull,
        headings_of(planes, hull), numbers,
        np.array([(each.gain, each.leak, each.hum) for each in heard]), window, quiet, PURE,
        np.empty(len(heard)), snr,
    )  # fmt: skip
    return snr


def _seen_from(plan: FloorPlan, ear: Ear, floor: Floor) -> tuple[Array, Array, Vector]:
    """Return the hull centres over the wanted cells, the diodes and half the size of the hull."""
    centres = floor.centres
    cells = np.hstack([centres, np.full((len(centres), 1), plan.altitude.si)])
    return cells, ear.vehicle.diodes.planes, half_axes(ear.vehicle.file.hull)


def headings_of(planes: Array, hull: Vector) -> Array:
    """Return cosine and sine of the headings to look at: where a turn changes nothing, fewer."""
    turn = 2.0 * math.pi / len(planes)
    cosine, sine = math.cos(turn), math.sin(turn)
    turned = planes @ np.kron(np.eye(2), [[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
    alike = hull[0] == hull[1] and np.allclose(np.roll(turned, 1, axis=0), planes, atol=1e-9)
    count, span = (max(HEADINGS // len(planes), 4), turn) if alike else (HEADINGS, 2.0 * math.pi)
    angles = np.arange(count) * (span / count)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)
