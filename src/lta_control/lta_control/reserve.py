"""
How the navigator obeys the energy monitor: fly, come home, or come down at once.

It believes only what is fresh. What it has not heard for a while says that nothing is known of the
energy, and then the drone comes down where it is; on the ground it stays there.
"""

from enum import IntEnum
from typing import final, Literal, NamedTuple

from lta_config.settings import setting, Settings

Action = Literal['land', 'return', 'perch']


class FlightPermission(IntEnum):
    """What the energy allows; the larger, the sooner the flight must end."""

    FLY = 0
    RESERVE = 1
    DOWN = 2


@final
class ReserveActionSettings(Settings):
    """What to do when the energy reserve is reached, and how long to believe what was said."""

    action: Action = setting(
        'land',
        'At the reserve: land here, return to the start and land there, or fly on to the lamp '
        '(a strategy that arrives, as homing) and come down there.',
        fixed=True,
    )
    stale: float = setting(
        1.0,
        'Age of the newest word of the energy monitor from which the drone comes down.',
        unit='s',
        low=0.2,
        high=600.0,
    )
    home: float = setting(
        0.5, 'Distance from the start at which it lands.', unit='m', low=0.05, high=100.0
    )
    patience: float = setting(
        2.0,
        'Times the flight back may take what its distance and the speed ask for.',
        low=1.0,
        high=20.0,
    )
    turning: float = setting(
        20.0, 'Time to coast and turn, on top of that.', unit='s', low=0.0, high=600.0
    )


class ReserveReport(NamedTuple):
    """
    What the energy monitor said last.

    Attributes
    ----------
    stamp_ns : int
        When it came, in graph time. [ns]
    reserve : bool
        Whether the reserve is reached.
    urgent : bool
        Whether to come down at once.
    why : str
        In words.

    """

    stamp_ns: int
    reserve: bool
    urgent: bool
    why: str = ''


def decide_permission(
    settings: ReserveActionSettings, word: ReserveReport | None, now_ns: int
) -> FlightPermission:
    """Return what the energy allows; who has heard nothing, or nothing lately, comes down. [ns]"""
    if word is None or is_stale(settings, word, now_ns) or word.urgent:
        return FlightPermission.DOWN
    return FlightPermission.RESERVE if word.reserve else FlightPermission.FLY


def is_stale(settings: ReserveActionSettings, word: ReserveReport, now_ns: int) -> bool:
    """Tell whether a word is too old to be believed. [ns]"""
    return (now_ns - word.stamp_ns) * 1e-9 > settings.stale


def explain_restriction(
    settings: ReserveActionSettings, word: ReserveReport | None, now_ns: int
) -> str:
    """Return why the energy forbids to fly, in words. [ns]"""
    if word is None:
        return 'nothing has been heard of the energy'
    age = (now_ns - word.stamp_ns) * 1e-9
    if is_stale(settings, word, now_ns):
        return f'nothing has been heard of the energy for {age:.1f} s'
    return word.why or 'the energy reserve is reached'
