r"""
The light at a point in a room: the flickering lamp, its diffuse echo, and the ambient light.

Map frame. Three parts, each in lux on a small plane at a point:

- direct light of a Lambertian lamp, :math:`I = \frac{m+1}{2\pi} \Phi \cos^m\alpha` (Kahn and
  Barry, Wireless infrared communications, Proc. IEEE 85, 1997, eq. 9) by the inverse square;
- light of the lamp between the walls of a closed room, uniform and from all sides, by Sumpner's
  sphere (Phil. Mag. 35, 1893): :math:`E = \Phi \varrho / (A (1 - \varrho))`. It flickers too;
- ambient light, uniform and from all sides: a steady part and the flicker of the mains.

Lux over the luminous efficacy of the light (white LED 300 lm/W, sun 105) is irradiance.

Left out: the first reflections, which depend on place and so pull a bearing; the shade of the
drone's own hull; the lamp's rise time; light that arrives later (20 ns, against milliseconds).
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.errors import BadInput
from lta_vlc.modulation import SquareWave
import numpy as np
from numpy.typing import NDArray

MOST_EFFICACY = 683.0  # lm/W, by definition of the lumen, of green light at 555 nm

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


def _require(holds: bool, sentence: str) -> None:
    """Raise `BadInput` with the sentence unless the condition holds."""
    if not holds:
        raise BadInput(sentence)


def _require_efficacy(efficacy: float) -> None:
    _require(
        0.0 < efficacy <= MOST_EFFICACY,
        f'The light has an efficacy of {efficacy} lm/W; give one above 0 and up to '
        f'{MOST_EFFICACY:g}.',
    )


@final
@dataclass(frozen=True, slots=True)
class Lamp:
    """
    A flickering lamp with a wide beam and no optics.

    Parameters
    ----------
    position : tuple of 3 floats
        Centre of the emitting disc. [m, map]
    axis : tuple of 3 floats
        Direction of the beam's middle, of any length but zero. [map]
    flux : float
        Luminous flux while on. [lm]
    wave : SquareWave
        When it is on.
    efficacy : float
        Luminous flux by radiant flux. [lm/W]
    order : float
        Lambertian order: 1 for a half-power angle of 60 degrees.
    radius : float
        Radius of the emitting disc, which bounds the light close by. [m]

    """

    position: Vector
    axis: Vector
    flux: float
    wave: SquareWave
    efficacy: float
    order: float = 1.0
    radius: float = 0.015

    def __post_init__(self) -> None:
        """Refuse what cannot shine."""
        numbers = (*self.position, *self.axis, self.flux, self.order, self.radius)
        _require(
            all(map(math.isfinite, numbers)),
            f'The lamp {numbers} has a number that is not finite; correct it.',
        )
        _require(
            math.hypot(*self.axis) > 0.0,
            'The axis of the lamp has no length; give the direction it faces.',
        )
        _require(self.flux >= 0.0, f'The lamp has a flux of {self.flux} lm; give 0 or more.')
        _require(self.order > 0.0, f'The lamp has the order {self.order}; give one above 0.')
        _require(self.radius > 0.0, f'The lamp has a radius of {self.radius} m; make it positive.')
        _require_efficacy(self.efficacy)

    @property
    def intensity(self) -> float:
        """Luminous intensity on the axis while on. [cd]"""
        return (self.order + 1.0) / (2.0 * math.pi) * self.flux


@final
@dataclass(frozen=True, slots=True)
class Room:
    """
    A closed box whose surfaces reflect diffusely.

    Parameters
    ----------
    size : tuple of 3 floats
        Length, width and height. [m]
    albedo : float
        Part of the light that its surfaces throw back, the mean of all, 0 to below 1.

    """

    size: Vector
    albedo: float

    def __post_init__(self) -> None:
        """Refuse what is no room."""
        _require(
            all(math.isfinite(side) and side > 0.0 for side in self.size),
            f'The room measures {self.size} m; make every side positive.',
        )
        _require(
            0.0 <= self.albedo < 1.0,
            f'The room has an albedo of {self.albedo}; choose one from 0 to below 1.',
        )

    def diffuse(self, flux: float) -> float:
        """Return the illuminance by light between the surfaces (Sumpner), flux in lm. [lx]"""
        length, width, height = self.size
        area = 2.0 * (length * width + length * height + width * height)
        return flux * self.albedo / (area * (1.0 - self.albedo))


@final
@dataclass(frozen=True, slots=True)
class Ambient:
    """
    Light that is not the lamp's, the same on every plane.

    Parameters
    ----------
    efficacy : float
        Luminous by radiant flux, of the steady part and the flicker alike. [lm/W]
    steady : float
        Mean illuminance. [lx]
    mains : float
        Amplitude of the flicker of lamps on the mains, at most `steady`. [lx]
    mains_frequency : float
        Frequency of that flicker, twice that of the mains. [Hz]
    mains_phase : float
        Its phase at time zero. [cycles]

    """

    efficacy: float
    steady: float = 0.0
    mains: float = 0.0
    mains_frequency: float = 100.0
    mains_phase: float = 0.0

    def __post_init__(self) -> None:
        """Refuse negative or endless light."""
        _require_efficacy(self.efficacy)
        _require(
            math.isfinite(self.steady) and self.steady >= 0.0,
            f'The ambient light is {self.steady} lx; give 0 or more.',
        )
        _require(
            0.0 <= self.mains <= self.steady,
            f'The mains flicker by {self.mains} lx around {self.steady} lx; give an amplitude '
            'from 0 to that mean.',
        )
        _require(
            math.isfinite(self.mains_frequency) and self.mains_frequency > 0.0,
            f'The mains flicker at {self.mains_frequency} Hz; give a positive frequency.',
        )
        _require(
            math.isfinite(self.mains_phase),
            f'The mains have a phase of {self.mains_phase} cycles; give a finite one.',
        )


@final
@dataclass(frozen=True, slots=True)
class LightField:
    """
    All light of a scene.

    Parameters
    ----------
    lamp : Lamp
        The beacon.
    ambient : Ambient
        The rest.
    room : Room or None
        The closed room around the lamp; None outdoors.

    """

    lamp: Lamp
    ambient: Ambient
    room: Room | None = None


@final
@dataclass(frozen=True, slots=True)
class Illuminance:
    """
    Light on each of a set of small planes.

    Parameters
    ----------
    modulated : ndarray of float64
        Light of the lamp while it is on. [lx]
    steady : ndarray of float64
        Mean ambient light. [lx]
    mains : ndarray of float64
        Amplitude of the mains flicker. [lx]

    """

    modulated: Array
    steady: Array
    mains: Array


def direct(lamp: Lamp, points: Array, normals: Array) -> Array:
    """
    Return the illuminance by the lamp alone, while it is on, without any reflection.

    Parameters
    ----------
    lamp : Lamp
        The lamp.
    points : ndarray of float64, shape (..., 3)
        Where. [m, map]
    normals : ndarray of float64, shape (..., 3)
        Unit normals of the planes lit. [map]

    Returns
    -------
    ndarray of float64, shape (...)
        Illuminance, zero behind the lamp and behind the plane. [lx]

    Notes
    -----
    The distance enters as d^2 + radius^2: exact on the axis of a Lambertian disc, and finite
    where a drone touches the lamp.

    """
    axis = np.array(lamp.axis) / math.hypot(*lamp.axis)
    ray = points - np.array(lamp.position)
    squared = np.einsum('...k,...k->...', ray, ray)
    distance = np.sqrt(squared) + np.finfo(np.float64).tiny
    leaving = np.maximum(ray @ axis / distance, 0.0) ** lamp.order
    arriving = np.maximum(-np.einsum('...k,...k->...', ray, normals) / distance, 0.0)
    return np.asarray(lamp.intensity * leaving * arriving / (squared + lamp.radius**2))


def illuminance(field: LightField, points: Array, normals: Array) -> Illuminance:
    """
    Return the light on small planes, part by part.

    Parameters
    ----------
    field : LightField
        The scene.
    points : ndarray of float64, shape (..., 3)
        Where. [m, map]
    normals : ndarray of float64, shape (..., 3)
        Unit normals of the planes. [map]

    Returns
    -------
    Illuminance
        Arrays of shape (...).

    """
    modulated = direct(field.lamp, points, normals)
    if field.room is not None:
        modulated = modulated + field.room.diffuse(field.lamp.flux)
    steady = np.full(modulated.shape, field.ambient.steady)
    mains = np.full(modulated.shape, field.ambient.mains)
    return Illuminance(modulated, steady, mains)


def mean_illuminance(field: LightField, points: Array, normals: Array) -> Array:
    """Return the light on small planes averaged over the flicker. [lx]"""
    light = illuminance(field, points, normals)
    return light.modulated * field.lamp.wave.duty + light.steady


def mean_irradiance(field: LightField, points: Array, normals: Array) -> Array:
    """Return the radiant power on small planes by area, averaged over the flicker. [W/m2]"""
    light = illuminance(field, points, normals)
    lamp = light.modulated * (field.lamp.wave.duty / field.lamp.efficacy)
    return lamp + light.steady / field.ambient.efficacy
