"""
Manoeuvres to choose the next flight from, each shaken or not, short or long.

All take off, do the same thing over and over, and land with time enough to come down.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
import math
from typing import Any, Final, final, NamedTuple

import numpy as np

TAKE_OFF: Final = 2.5  # s; the estimator has learnt its biases by then
CLIMB: Final = 6.0  # s
DESCENT: Final = 40.0  # s; a vehicle that is hardly heavier than air comes down slowly
LENGTHS: Final = (45.0, 120.0)  # s; of what is done in the air
SHAKES: Final = (0.0, 0.2)  # of a duty
HOLD: Final = 0.7  # s
CRUISE: Final = 0.5  # m/s
DEEP, HIGH = 0.1, 1.6  # m above where it stands: as low and as high as it goes


class Leg(NamedTuple):
    """Altitude [m], heading [rad] and speed [m/s], and for how long [s]."""

    altitude: float
    heading: float
    speed: float
    lasts: float


@final
@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """
    One of them.

    Attributes
    ----------
    about : str
        What it does, in words.
    course : mapping
        As a scenario file has it.
    length : float
        Until the end of the landing. [s]
    cost : float
        What it asks of people and vehicle: seconds, shaken ones counting more.

    """

    about: str
    course: Mapping[str, Any]
    length: float
    cost: float


@final
@dataclass(frozen=True, slots=True)
class Space:
    """
    Heights between which a vehicle may fly.

    Attributes
    ----------
    low, high : float
        Of the hull centre. [m]

    """

    low: float
    high: float

    @property
    def middle(self) -> float:
        """Between the two. [m]"""
        return 0.5 * (self.low + self.high)


def _hover(space: Space, _: int) -> Leg:
    return Leg(space.middle, 0.0, 0.0, 10.0)


def _heights(space: Space, k: int) -> Leg:
    return Leg((space.high, space.low)[k % 2], 0.0, 0.0, 12.0)


def _speeds(space: Space, k: int) -> Leg:
    speed = (0.3, 0.6, 1.0, 1.6)[k // 2 % 4] * CRUISE
    return Leg(space.middle, math.pi * (k % 2), speed, 8.0)


def _yaws(space: Space, k: int) -> Leg:
    return Leg(space.middle, (1.2, -1.2)[k % 2], 0.0, 4.0)


def _laps(space: Space, k: int) -> Leg:
    height = (space.low + 0.3 * (space.high - space.low), space.high)[k // 8 % 2]
    return Leg(height, 0.25 * math.pi * (k + 1), CRUISE, 4.0)


def _all(space: Space, k: int) -> Leg:
    rng = np.random.default_rng([k, 31])
    heading = float(np.sum([np.random.default_rng([i, 32]).uniform(-2, 2) for i in range(k + 1)]))
    height, speed = rng.uniform(space.low, space.high), rng.choice([0.0, 0.6, 1.2])
    return Leg(float(height), heading, float(speed) * CRUISE, 7.0)


MANOEUVRES: Final[dict[str, tuple[str, Callable[[Space, int], Leg]]]] = {
    'hover': ('hover on the spot', _hover),
    'heights': ('climb and come down in steps', _heights),
    'speeds': ('fly out and back, faster and faster', _speeds),
    'yaws': ('turn left and right on the spot', _yaws),
    'laps': ('fly laps at two heights', _laps),
    'all': ('change height, heading and speed at once', _all),
}


def manoeuvre(name: str, space: Space, length: float, shake: float) -> Manoeuvre:
    """
    Return a manoeuvre.

    Parameters
    ----------
    name : str
        Of MANOEUVRES.
    space : Space
        Where it may fly.
    length : float
        Of what is done in the air. [s]
    shake : float
        Of each duty, either way; 0 is not shaken.

    """
    about, leg = MANOEUVRES[name]
    first = leg(space, 0)
    rows = [_row(TAKE_OFF, Leg(space.middle, first.heading, 0.0, CLIMB))]
    at, k = TAKE_OFF + CLIMB, 0
    while at < TAKE_OFF + CLIMB + length:
        now = leg(space, k)
        rows.append(_row(at, now))
        at, k = at + now.lasts, k + 1
    rows.append(_row(at, Leg(0.0, now.heading, 0.0, DESCENT)))
    course: dict[str, Any] = {'between': 'step', 'rows': rows}
    if shake:
        course['shake'] = {'duty': _si(shake, '1'), 'hold': _si(HOLD, 's')}
        about += f', the motors shaken by {100.0 * shake:.0f} %'
    return Manoeuvre(about, course, at + DESCENT, (at + DESCENT) * (1.0 + 2.0 * shake))


def family(space: Space) -> list[Manoeuvre]:
    """Return all manoeuvres, each in each length and with each shake, the cheapest first."""
    made = [
        manoeuvre(name, space, length, shake)
        for name in MANOEUVRES
        for length in LENGTHS
        for shake in SHAKES
    ]
    return sorted(made, key=lambda one: one.cost)


def _row(at: float, leg: Leg) -> dict[str, Any]:
    return {
        'at': _si(round(at, 3), 's'),
        'altitude': _si(round(leg.altitude, 3), 'm'),
        'heading': _si(round(leg.heading, 4), 'rad'),
        'speed': _si(round(leg.speed, 3), 'm/s'),
    }


def _si(value: float, unit: str) -> dict[str, Any]:
    return {'value': value, 'unit': unit}
