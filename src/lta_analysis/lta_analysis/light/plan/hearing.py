"""
What a drone over each cell hears of each lamp: light, and the signal-to-noise ratio it comes to.

Light, diodes, amplifier, converter and demodulation are the simulator's (`lta_sim.heard_lamp`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_analysis.light.plan.floor import Floor
from lta_analysis.light.plan.floor_plan import FloorPlan
from lta_analysis.light.plan.mounts import Mount
from lta_analysis.light.plan.polygon import Array
from lta_analysis.light.plan.rays import over_cells
from lta_config.topics import Light
from lta_sim.compiled import compiled
from lta_sim.heard_lamp import Listening, listening_of
from lta_sim.hull import half_axes
from lta_sim.lambertian import beam
from lta_sim.light_field import Ambient, Lamp, LightField
from lta_sim.vehicle import Vehicle
from lta_vlc.demodulation import Demodulation
from lta_vlc.modulation import SquareWave
import numpy as np

HEADINGS = 64  # of a full turn, 5.6 degrees apart


@final
@dataclass(frozen=True, slots=True)
class Ear:
    """
    Who listens.

    Attributes
    ----------
    vehicle : Vehicle
        Its hull and ring.
    demodulation : Demodulation
        How it listens; the frequency is each lamp's.
    light : Light
        Sampling rate and block length.
    margin : float
        How far above the threshold the SNR must be.

    """

    vehicle: Vehicle
    demodulation: Demodulation
    light: Light
    margin: float

    @property
    def needed(self) -> float:
        """The SNR from which a lamp counts as heard."""
        return self.margin * self.demodulation.threshold


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


def ratio(heard: Listening, light: Array, others: Array | float = 0.0) -> Array:
    """
    Return the SNR that light of a lamp comes to, without the scatter of single blocks.

    Parameters
    ----------
    heard : Listening
        The lamp.
    light : ndarray
        Of that lamp while it is on, on the diode that gets most of it. [lx]
    others : ndarray or float
        What other lamps leave in the bins that tell the noise. [counts]

    """
    counts = heard.counts * light
    swing = np.minimum(heard.rest + counts, heard.top) - min(heard.rest, heard.top)
    variance = heard.variance + heard.shot * heard.duty * counts
    quiet = np.sqrt(math.pi * variance / heard.samples) + heard.leak * counts + heard.hum + others
    return np.asarray(heard.gain * swing / quiet)


def least_light(heard: Listening, needed: float) -> float:
    """Return the light from which the SNR is as needed; infinite if it never is. [lx]"""
    low, high = 0.0, heard.top / heard.counts
    if ratio(heard, np.array(high)) < needed:
        return math.inf
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if ratio(heard, np.array(middle)) >= needed else (middle, high)
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
    centres = floor.centres
    cells = np.hstack([centres, np.full((len(centres), 1), plan.altitude.si)])
    planes, hull = ear.vehicle.diodes.planes, half_axes(ear.vehicle.file.hull)
    headings = headings_of(planes, hull)
    light = np.zeros((len(mounts), 2, len(cells)))
    for k, mount in enumerate(mounts):
        lamp = beam(field_of(plan, mount, 1.0))
        kernel(lamp, cells, floor.walls, planes, hull, headings, faintest, light[k])
        tick()
    return light


def headings_of(planes: Array, hull: tuple[float, float, float]) -> Array:
    """Return cosine and sine of the headings to look at: where a turn changes nothing, fewer."""
    turn = 2.0 * math.pi / len(planes)
    cosine, sine = math.cos(turn), math.sin(turn)
    turned = planes @ np.kron(np.eye(2), [[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
    alike = hull[0] == hull[1] and np.allclose(np.roll(turned, 1, axis=0), planes, atol=1e-9)
    count, span = (max(HEADINGS // len(planes), 4), turn) if alike else (HEADINGS, 2.0 * math.pi)
    angles = np.arange(count) * (span / count)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)
