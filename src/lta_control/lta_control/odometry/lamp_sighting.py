"""The lamp as the filter of the motion over ground takes it from one light block."""

import math
from typing import NamedTuple

from lta_control.sighting import bearing_deviation, facing_strength, LampPosition

TRUSTED = 0.05  # rad: a lamp partly hidden by the hull is reported with a larger deviation
NEAREST_SIGHTING = 0.3  # m


class LampSighting(NamedTuple):
    """A lamp as one light block shows it."""

    # In the body frame, and its standard deviation [rad]
    bearing: float
    deviation: float
    # Rough distance [m], and its relative standard deviation
    distance: float
    spread: float
    strength: float  # amplitude of a diode that would face the lamp [ADC counts]
    frequency: float  # which tells lamps apart [Hz]
    age: float  # time since the middle of the block [s]


def build_sighting(
    lamp: LampPosition | None,
    axes: tuple[tuple[float, float], ...],
    amplitudes: tuple[float, ...],
    frequencies: tuple[float, ...],
    age: float,
) -> LampSighting | None:
    """
    Return the sighting of one block; None where no lamp is seen well.

    `lamp` is its estimate in the body frame; the tuples have one item per diode. `age` is the time
    since the middle of the block [s].
    """
    if lamp is None or not amplitudes or len(frequencies) != len(amplitudes):
        return None
    distance, deviation = math.hypot(lamp.x, lamp.y), bearing_deviation(lamp)
    finite = tuple([a if math.isfinite(a) else 0.0 for a in amplitudes])
    strength = facing_strength(axes, finite)
    frequency = frequencies[finite.index(max(finite))]
    # NaN compares false
    if not (
        deviation <= TRUSTED and distance > NEAREST_SIGHTING and strength > 0.0 and frequency > 0.0
    ):
        return None
    xx, xy, yy = lamp.spread
    x, y = lamp.x / distance, lamp.y / distance
    along = max(x * x * xx + 2.0 * x * y * xy + y * y * yy, 0.0)
    return LampSighting(
        math.atan2(lamp.y, lamp.x),
        deviation,
        distance,
        math.sqrt(along) / distance,
        strength,
        frequency,
        age,
    )
