"""Where the lamp is in the body frame, as far as one bearing tells."""

from dataclasses import dataclass
import math
from typing import final

from lta_config.settings import setting, Settings
from lta_vlc.array import Bearing
import numpy as np
from numpy.typing import NDArray


@final
class LampPrior(Settings):
    """What is known of the lamp before it is seen: one bearing tells neither range nor height."""

    distance: float = setting(
        4.0, 'Expected horizontal distance to the lamp', unit='m', low=0.1, high=100.0
    )
    distance_deviation: float = setting(
        3.0, 'Standard deviation of that distance', unit='m', low=0.0, high=100.0
    )
    height_deviation: float = setting(
        1.0,
        "Standard deviation of the lamp's height over the drone",
        unit='m',
        low=0.0,
        high=100.0,
    )
    bearing_deviation: float = setting(
        0.05,
        'Standard deviation of the bearing from all that is not noise: reflections, unequal '
        'diodes, tilt, turning within a block',
        unit='rad',
        low=0.0,
        high=3.15,
    )


@final
@dataclass(frozen=True, slots=True)
class LampEstimate:
    """
    The lamp in the body frame.

    Parameters
    ----------
    position : ndarray of float64, shape (3,)
        Position. [m, body FLU]
    covariance : ndarray of float64, shape (3, 3)
        Its covariance. [m^2, body FLU]

    """

    position: NDArray[np.float64]
    covariance: NDArray[np.float64]


def ray_of(angle: float) -> tuple[float, float]:
    """Return the unit vector of a bearing. [rad]"""
    return math.cos(angle), math.sin(angle)


def bearing_through(angle: float, prior: LampPrior) -> float:
    """
    Return the bearing of the lamp that the message of `lamp_estimate` gives back. [rad]

    The message carries a point: the last bit of the angle is not kept. A loop that sends no
    messages takes it through the same arithmetic.
    """
    x, y = ray_of(angle)
    return math.atan2(prior.distance * y, prior.distance * x)


def lamp_estimate(bearing: Bearing, prior: LampPrior) -> LampEstimate:
    """
    Return the lamp as a point on the ray of its bearing, uncertain mostly along that ray.

    Parameters
    ----------
    bearing : Bearing
        Direction and its deviation from noise.
    prior : LampPrior
        Distance and height, which the bearing does not tell, and the rest of its error.

    Returns
    -------
    LampEstimate
        Mean at the prior distance and at the drone's own height.

    Notes
    -----
    To first order in the angle the error across the ray is distance times angle, so its variance
    is (distance^2 + distance_deviation^2) times that of the angle. Not the exact moments of a
    sector: for an angle known worse than half a radian the true region is bent.

    """
    ray = np.array([*ray_of(bearing.angle), 0.0])
    left = np.array([-ray[1], ray[0], 0.0])
    up = np.array([0.0, 0.0, 1.0])
    along = prior.distance_deviation**2
    angle = bearing.deviation**2 + prior.bearing_deviation**2
    across = (prior.distance**2 + along) * angle
    covariance = (
        along * np.outer(ray, ray)
        + across * np.outer(left, left)
        + prior.height_deviation**2 * np.outer(up, up)
    )
    return LampEstimate(prior.distance * ray, covariance)
