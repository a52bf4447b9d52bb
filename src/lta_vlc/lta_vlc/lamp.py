# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Estimate the lamp position in the body frame from one direction and a prior."""

from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_config.settings import setting, Settings
import numpy as np
from numpy.typing import NDArray

OFF_AXIS_COSINE = 0.8  # mean cosine at which a Lambertian beam leaves a lamp that is flown to
OFF_AXIS_DEVIATION = 0.15  # relative, of a range by strength: the beam's angle is not known


@final
@dataclass(frozen=True, slots=True)
class Direction:
    """Direction to the lamp in the body frame."""

    # Unit vector from the middle of the diodes
    x: float
    y: float
    z: float
    # Covariance of azimuth and elevation by noise, unequal gains, reflections and priors [rad2]
    azimuth_variance: float
    cross_variance: float
    elevation_variance: float
    # Reading of a nominal diode that faces the lamp, of its direct light alone [counts]
    strength: float
    strength_deviation: float
    pedestal: float  # reading by diffuse light, the same for all diodes [counts]

    @property
    def azimuth(self) -> float:
        """Angle counter-clockwise from forward [rad]."""
        return math.atan2(self.y, self.x)

    @property
    def elevation(self) -> float:
        """Angle above the plane of forward and left [rad]."""
        return math.atan2(self.z, math.sqrt(self.x * self.x + self.y * self.y))

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of azimuth and elevation, shape (2, 2) [rad2]."""
        cross = self.cross_variance
        return np.array([[self.azimuth_variance, cross], [cross, self.elevation_variance]])


@final
class LampPrior(Settings):
    """Prior on the lamp: one direction does not determine its range."""

    distance: float = setting(4.0, 'm', 0.1, 100.0)
    """Expected distance to the lamp."""
    distance_deviation: float = setting(3.0, 'm', 0.0, 100.0)
    """Standard deviation of the expected distance to the lamp."""
    height_deviation: float = setting(1.0, 'm', 0.0, 100.0)
    """Standard deviation of the height difference between lamp and drone."""
    intensity: float = setting(0.0, 'counts', 0.0, 1e9)
    """
    Reading of a nominal photodiode that faces the lamp from 1 m away on the lamp's axis; 0: not
    measured.
    """


@final
class LampEstimate(NamedTuple):
    """The lamp in the body frame FLU: position x, y, z [m] and its covariance xx to zz [m2]."""

    x: float
    y: float
    z: float
    xx: float
    xy: float
    xz: float
    yy: float
    yz: float
    zz: float


def estimate_range(direction: Direction, prior: LampPrior) -> tuple[float, float]:
    """
    Return the distance to the lamp and its standard deviation [m].

    By the inverse square law if the lamp's strength was measured, else the prior.
    """
    # Not measured: strength says nothing about the range
    if not prior.intensity > 0.0:
        return prior.distance, prior.distance_deviation
    # Inverse-square law; OFF_AXIS_COSINE is the beam's loss off its axis
    distance = math.sqrt(prior.intensity * OFF_AXIS_COSINE / direction.strength)
    # d ~ S^(-1/2), so relative errors halve
    relative = 0.5 * direction.strength_deviation / direction.strength
    return distance, distance * math.sqrt(OFF_AXIS_DEVIATION**2 + relative**2)


def estimate_lamp_position(direction: Direction, prior: LampPrior) -> LampEstimate:
    """
    Return the lamp on the ray of its direction, uncertain mostly along that ray.

    To first order in the angles the error across the ray is distance times angle, so its variance
    is (distance^2 + its variance) times that of the angle. Not the exact moments of a sector: for
    an angle known worse than half a radian the true region is bent.
    """
    x, y, z = direction.x, direction.y, direction.z
    distance, deviation = estimate_range(direction, prior)
    along = deviation * deviation
    level = math.sqrt(x * x + y * y)
    a, b = -y / level, x / level  # to the left of the ray
    d, e = -z * x / level, -z * y / level  # and, with `level`, upwards
    # Second moment of the distance
    square = distance * distance + along
    left = square * direction.azimuth_variance * level * level
    up = square * direction.elevation_variance
    both = square * direction.cross_variance * level
    return LampEstimate(
        distance * x,
        distance * y,
        distance * z,
        along * x * x + left * a * a + up * d * d + 2.0 * both * a * d,
        along * x * y + left * a * b + up * d * e + both * (a * e + b * d),
        along * x * z + up * d * level + both * a * level,
        along * y * y + left * b * b + up * e * e + 2.0 * both * b * e,
        along * y * z + up * e * level + both * b * level,
        along * z * z + up * level * level,
    )
