"""
What the drone learns at rest on level ground.

The means of what the IMU reads while nothing moves are its biases; the mean pressure, taken down
to the floor, is the zero of the pressure height.
"""

import math
from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_control.attitude import Vector


class Rest(NamedTuple):
    """Sums gathered at rest; the mean of each is a bias."""

    samples: int = 0
    rates: Vector = (0.0, 0.0, 0.0)
    force: Vector = (0.0, 0.0, 0.0)
    pressure: float = 0.0
    pressures: int = 0


class Biases(NamedTuple):
    """What the sensors read at rest beyond the truth."""

    rates: Vector = (0.0, 0.0, 0.0)  # [rad/s]
    force: Vector = (0.0, 0.0, 0.0)  # [m/s2]
    pressure: float = 0.0  # at the floor [Pa]


def rest_step(rest: Rest, rates: Vector, force: Vector, pressure: float) -> Rest:
    """
    Return the sums with one more sample.

    Parameters
    ----------
    rest : Rest
        The sums so far.
    rates, force : tuple
        Measured angular rates [rad/s] and specific force [m/s2], body frame.
    pressure : float
        Measured pressure, NaN where none has come. [Pa]

    """
    heard = math.isfinite(pressure)
    return Rest(
        rest.samples + 1,
        (rest.rates[0] + rates[0], rest.rates[1] + rates[1], rest.rates[2] + rates[2]),
        (rest.force[0] + force[0], rest.force[1] + force[1], rest.force[2] + force[2]),
        rest.pressure + pressure if heard else rest.pressure,
        rest.pressures + 1 if heard else rest.pressures,
    )


def biases_of(rest: Rest, height: float, air_density: float) -> Biases:
    """
    Return the biases that the means give; the ground counts as level.

    Parameters
    ----------
    rest : Rest
        Sums with at least one sample and one pressure.
    height : float
        Of the hull centre above the floor. [m]
    air_density : float
        For the pressure at the floor. [kg/m3]

    """
    n = 1.0 * rest.samples
    return Biases(
        (rest.rates[0] / n, rest.rates[1] / n, rest.rates[2] / n),
        (rest.force[0] / n, rest.force[1] / n, rest.force[2] / n - STANDARD_GRAVITY),
        rest.pressure / rest.pressures + air_density * STANDARD_GRAVITY * height,
    )
