r"""
A flickering lamp with a wide beam: where it is, how bright, and when.

A Lambertian emitter, :math:`I = \frac{m+1}{2\pi} \Phi \cos^m\alpha` (Kahn and Barry, Wireless
infrared communications, Proc. IEEE 85, 1997, eq. 9). At the half-power angle :math:`\alpha_{1/2}`
it shines half as bright as ahead: :math:`m = -\ln 2 / \ln\cos\alpha_{1/2}` (eq. 10), 1 for 60
degrees.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_model.light.clock_error import DriftingClock, RIGHT
from lta_model.light.light_checks import require, require_efficacy
from lta_model.light.modulation import SquareWave
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


def lambertian_order(half_power: float) -> float:
    """Return the Lambertian order of a lamp with a half-power angle. [rad]"""
    # Rounded: 60 degrees are the order 1 exactly, which needs no power.
    return round(-math.log(2.0) / math.log(math.cos(half_power)), 12)


@final
@dataclass(frozen=True, slots=True)
class BeaconLamp:
    """A flickering lamp without optics."""

    # Centre of the emitting disc [m], and direction of the beam, of any length but zero [map]
    position: Vector
    axis: Vector
    flux: float  # luminous flux while on [lm]
    wave: SquareWave  # when it is on
    efficacy: float  # luminous flux by radiant flux [lm/W]
    order: float = 1.0  # Lambertian order: 1 for a half-power angle of 60 degrees
    radius: float = 0.015  # radius of the emitting disc, which bounds the light close by [m]
    # Time from 10 % to 90 % of its light at switching on, and back at switching off [s]
    rise: float = 0.0
    clock: DriftingClock = RIGHT  # timing error of its flicker

    def __post_init__(self) -> None:
        """Refuse an impossible lamp."""
        numbers = (*self.position, *self.axis, self.flux, self.order, self.radius, self.rise)
        require(
            all(map(math.isfinite, numbers)),
            'A number of the lamp is infinite or NaN; correct it. Position, axis, luminous flux, '
            f'Lambertian order, radius and rise time are {numbers}.',
        )
        require(
            math.hypot(*self.axis) > 0.0,
            'The axis of the lamp is zero; give the direction in which the lamp faces.',
        )
        require(
            self.flux >= 0.0,
            f'The lamp has a luminous flux of {self.flux} lm; the flux must be 0 or more.',
        )
        require(
            self.order > 0.0,
            f'The lamp has the Lambertian order {self.order}; the order must be above 0.',
        )
        require(
            self.radius > 0.0,
            f'The lamp has a radius of {self.radius} m; the radius must be positive.',
        )
        # The lamp must reach full light within each phase of its period
        shortest = min(self.wave.duty, 1.0 - self.wave.duty) / self.wave.frequency
        require(
            0.0 <= self.rise <= shortest,
            f'The lamp takes {1e3 * self.rise:g} ms to reach full light but is on or off for '
            f'only {1e3 * shortest:g} ms of each flicker period; shorten its rise time or lower '
            'its frequency.',
        )
        require_efficacy(self.efficacy)

    @property
    def intensity(self) -> float:
        """Luminous intensity on the axis while on. [cd]"""
        # Integrates to the flux over the half space
        return (self.order + 1.0) / (2.0 * math.pi) * self.flux

    @property
    def direction(self) -> Vector:
        """Unit axis. [map]"""
        length = math.hypot(*self.axis)
        x, y, z = self.axis
        return x / length, y / length, z / length


def direct_illuminance(lamp: BeaconLamp, points: Array, normals: Array) -> Array:
    """
    Return the illuminance by the lamp alone while it is on, without reflections. [lx]

    `points` [m] and unit `normals` of the planes are in `map`, shape (..., 3). The result is zero
    behind lamp and plane. The distance enters as d^2 + radius^2: exact on the axis of a Lambertian
    disc, and finite at the lamp.
    """
    ray = points - np.array(lamp.position)
    squared = np.einsum('...k,...k->...', ray, ray)
    # The tiny summand avoids 0 / 0 at the lamp itself
    distance = np.sqrt(squared) + np.finfo(np.float64).tiny
    leaving = np.maximum(ray @ np.array(lamp.direction) / distance, 0.0) ** lamp.order
    arriving = np.maximum(-np.einsum('...k,...k->...', ray, normals) / distance, 0.0)
    return np.asarray(lamp.intensity * leaving * arriving / (squared + lamp.radius**2))
