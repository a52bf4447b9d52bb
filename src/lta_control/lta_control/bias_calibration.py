"""
What the drone learns at rest on level ground.

The means of what the IMU reads while nothing moves are its biases; the mean pressure, taken down
to the floor, is the zero of the pressure height. Who is moved meanwhile begins anew. A drone that
floats sways: what it may is more than wind does to one that stands on the floor (6 deg/s and
0.03 g off the mean in a gusty hall), and its mean is then nearly that of one at rest.
"""

import math
from typing import Final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_control.attitude import Vector

MOVED_RATE: Final = math.radians(10.0)  # rad/s off the mean; a hand turns it by more
MOVED_FORCE: Final = 0.1 * STANDARD_GRAVITY  # m/s2 off the mean
# Three times what the data sheet of the IMU allows, about the bias that the vehicle file tells:
# more is a drone that turns, or stands tilted.
MOST_RATE: Final = math.radians(3.0)  # rad/s
MOST_FORCE: Final = 0.06 * STANDARD_GRAVITY  # m/s2


class RestSums(NamedTuple):
    """Sums gathered at rest; the mean of each is a bias."""

    samples: int = 0
    rates: Vector = (0.0, 0.0, 0.0)
    force: Vector = (0.0, 0.0, 0.0)
    pressure: float = 0.0
    pressures: int = 0


class SensorBiases(NamedTuple):
    """What the sensors read at rest beyond the truth."""

    rates: Vector = (0.0, 0.0, 0.0)  # [rad/s]
    force: Vector = (0.0, 0.0, 0.0)  # [m/s2]
    pressure: float = 0.0  # at the floor [Pa]


def rest_step(rest: RestSums, rates: Vector, force: Vector, pressure: float) -> RestSums:
    """
    Return the sums with one more sample; of that one alone where the drone has been moved.

    Parameters
    ----------
    rest : Rest
        The sums so far.
    rates, force : tuple
        Measured angular rates [rad/s] and specific force [m/s2], body frame.
    pressure : float
        Measured pressure, NaN where none has come. [Pa]

    """
    before = reset_unless_still(rest, not _is_disturbed(rest, rates, force))
    w, f, air = before.rates, before.force, before.pressure
    heard = math.isfinite(pressure)
    return RestSums(
        before.samples + 1,
        (w[0] + rates[0], w[1] + rates[1], w[2] + rates[2]),
        (f[0] + force[0], f[1] + force[1], f[2] + force[2]),
        air + pressure if heard else air,
        before.pressures + (1 if heard else 0),
    )


def reset_unless_still(rest: RestSums, still: bool) -> RestSums:
    """Return the sums, or none where the rest begins anew; products, so that types stay."""
    one = 1 if still else 0
    w, f = rest.rates, rest.force
    return RestSums(
        one * rest.samples,
        (one * w[0], one * w[1], one * w[2]),
        (one * f[0], one * f[1], one * f[2]),
        one * rest.pressure,
        one * rest.pressures,
    )


def _is_disturbed(rest: RestSums, rates: Vector, force: Vector) -> bool:
    """Tell whether a sample lies farther off the means so far than a drone at rest sways."""
    if rest.samples == 0:
        return False
    n = 1.0 * rest.samples
    return _exceeds_limit(rates, rest.rates, n, MOVED_RATE) or _exceeds_limit(
        force, rest.force, n, MOVED_FORCE
    )


def _exceeds_limit(sample: Vector, sums: Vector, n: float, limit: float) -> bool:
    return (
        abs(sample[0] - sums[0] / n) > limit
        or abs(sample[1] - sums[1] / n) > limit
        or abs(sample[2] - sums[2] / n) > limit
    )


def is_turning(biases: SensorBiases, expected: Vector) -> bool:
    """
    Tell whether the rates are a turn: no gyroscope is so far off what is told of it.

    Parameters
    ----------
    biases : Biases
        The means at rest.
    told : tuple of float
        The bias that the vehicle file gives the gyroscope. [rad/s]

    """
    return largest_deviation(biases.rates, expected) > MOST_RATE


def is_tilted(biases: SensorBiases, expected: Vector) -> bool:
    """Tell whether the force is that of a tilt; `told` as in `is_turning`, in m/s2."""
    return largest_deviation(biases.force, expected) > MOST_FORCE


def largest_deviation(measured: Vector, expected: Vector) -> float:
    """Return how far a mean is off what is told of it, on the worst axis; unit as they have."""
    x, y, z = measured[0] - expected[0], measured[1] - expected[1], measured[2] - expected[2]
    return max(abs(x), abs(y), abs(z))


def compute_biases(rest: RestSums, height: float, air_density: float) -> SensorBiases:
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
    return SensorBiases(
        (rest.rates[0] / n, rest.rates[1] / n, rest.rates[2] / n),
        (rest.force[0] / n, rest.force[1] / n, rest.force[2] / n - STANDARD_GRAVITY),
        rest.pressure / rest.pressures + air_density * STANDARD_GRAVITY * height,
    )
