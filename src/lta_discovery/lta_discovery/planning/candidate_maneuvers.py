"""
Define the manoeuvres for the next flight, with and without dither, short and long.

All take off, repeat one pattern, and leave enough time to land.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
import math
from typing import Any, Final, final, NamedTuple

import numpy as np

TAKE_OFF: Final = 2.5  # s; time for the estimator to learn its biases
CLIMB: Final = 6.0  # s
SINK_TIME: Final = 40.0  # s; a nearly neutral vehicle descends slowly
LENGTHS: Final = (45.0, 120.0)  # s; duration of the pattern
SHAKES: Final = (0.0, 0.2)  # duty; amplitude of the dither
HOLD: Final = 0.7  # s
CRUISE: Final = 0.5  # m/s
DEEP, HIGH = 0.1, 1.6  # m above the standing height: lowest and highest altitude


class PlannedLeg(NamedTuple):
    """Altitude [m], heading [rad] and speed [m/s], and duration [s]."""

    altitude: float
    heading: float
    speed: float
    lasts: float


@final
@dataclass(frozen=True, slots=True)
class PlannedManeuver:
    """A manoeuvre."""

    about: str
    course: Mapping[str, Any]  # in the format of a scenario file
    length: float  # until the end of the landing [s]
    cost: float  # effort: seconds, weighted more with dither


@final
@dataclass(frozen=True, slots=True)
class AltitudeRange:
    """Permitted altitudes."""

    # Of the hull centre [m]
    low: float
    high: float

    @property
    def middle(self) -> float:
        """Middle of the range. [m]"""
        return 0.5 * (self.low + self.high)


def _hover_leg(space: AltitudeRange, _: int) -> PlannedLeg:
    return PlannedLeg(space.middle, 0.0, 0.0, 10.0)


def _heights_leg(space: AltitudeRange, k: int) -> PlannedLeg:
    return PlannedLeg((space.high, space.low)[k % 2], 0.0, 0.0, 12.0)


def _speeds_leg(space: AltitudeRange, k: int) -> PlannedLeg:
    # Each speed out and back
    speed = (0.3, 0.6, 1.0, 1.6)[k // 2 % 4] * CRUISE
    return PlannedLeg(space.middle, math.pi * (k % 2), speed, 8.0)


def _yaws_leg(space: AltitudeRange, k: int) -> PlannedLeg:
    return PlannedLeg(space.middle, (1.2, -1.2)[k % 2], 0.0, 4.0)


def _laps_leg(space: AltitudeRange, k: int) -> PlannedLeg:
    # A lap is 8 legs of 45 degrees, then the height changes
    height = (space.low + 0.3 * (space.high - space.low), space.high)[k // 8 % 2]
    return PlannedLeg(height, 0.25 * math.pi * (k + 1), CRUISE, 4.0)


def _random_leg(space: AltitudeRange, k: int) -> PlannedLeg:
    rng = np.random.default_rng([k, 31])
    # A random walk, reproducible for each leg
    heading = float(np.sum([np.random.default_rng([i, 32]).uniform(-2, 2) for i in range(k + 1)]))
    height, speed = rng.uniform(space.low, space.high), rng.choice([0.0, 0.6, 1.2])
    return PlannedLeg(float(height), heading, float(speed) * CRUISE, 7.0)


MANOEUVRES: Final[dict[str, tuple[str, Callable[[AltitudeRange, int], PlannedLeg]]]] = {
    'hover': ('hover on the spot', _hover_leg),
    'heights': ('climb and descend in steps', _heights_leg),
    'speeds': ('fly out and back at increasing speeds', _speeds_leg),
    'yaws': ('turn left and right on the spot', _yaws_leg),
    'laps': ('fly laps at two heights', _laps_leg),
    'all': ('change height, heading and speed at once', _random_leg),
}


def build_maneuver(
    name: str, space: AltitudeRange, length: float, shake: float
) -> PlannedManeuver:
    """
    Build a manoeuvre.

    `length`: duration of the pattern [s]. `shake`: amplitude of the dither, in duty; 0 for none.
    """
    about, leg = MANOEUVRES[name]
    first = leg(space, 0)
    rows = [_build_row(TAKE_OFF, PlannedLeg(space.middle, first.heading, 0.0, CLIMB))]
    at, k = TAKE_OFF + CLIMB, 0
    while at < TAKE_OFF + CLIMB + length:
        now = leg(space, k)
        rows.append(_build_row(at, now))
        at, k = at + now.lasts, k + 1
    # Land: altitude 0, with time to descend.
    rows.append(_build_row(at, PlannedLeg(0.0, now.heading, 0.0, SINK_TIME)))
    course: dict[str, Any] = {'between': 'step', 'rows': rows}
    if shake:
        course['shake'] = {'duty': _build_quantity(shake, '1'), 'hold': _build_quantity(HOLD, 's')}
        about += f', with a random dither of {100.0 * shake:.0f} % duty on the motors'
    # Effort in seconds; flights without dither are preferred
    return PlannedManeuver(about, course, at + SINK_TIME, (at + SINK_TIME) * (1.0 + 2.0 * shake))


def list_maneuvers(space: AltitudeRange) -> list[PlannedManeuver]:
    """Return all manoeuvres in each length and with each dither, the cheapest first."""
    manoeuvres = [
        build_maneuver(name, space, length, shake)
        for name in MANOEUVRES
        for length in LENGTHS
        for shake in SHAKES
    ]
    return sorted(manoeuvres, key=lambda one: one.cost)


def _build_row(at: float, leg: PlannedLeg) -> dict[str, Any]:
    return {
        'at': _build_quantity(round(at, 3), 's'),
        'altitude': _build_quantity(round(leg.altitude, 3), 'm'),
        'heading': _build_quantity(round(leg.heading, 4), 'rad'),
        'speed': _build_quantity(round(leg.speed, 3), 'm/s'),
    }


def _build_quantity(value: float, unit: str) -> dict[str, Any]:
    return {'value': value, 'unit': unit}
