# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Decide from the energy monitor's reports whether to fly, return, or land at once.

Only fresh reports count. After a while without a report the energy is unknown: the drone lands
where it is, or stays on the ground.
"""

from enum import IntEnum
import math
from typing import final, Literal, NamedTuple

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_control.phases import Mission, Phase
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy

Action = Literal['land', 'return', 'perch']


class FlightPermission(IntEnum):
    """What the energy allows; a larger value ends the flight sooner."""

    FLY = 0
    RESERVE = 1
    DOWN = 2


class ReserveAction(IntEnum):
    """What to do at the energy reserve."""

    LAND = 0
    RETURN = 1
    PERCH = 2


class ReserveRule(NamedTuple):
    """`ReserveResponseSettings` as the mission takes them: numbers alone."""

    action: int
    home: float  # [m]
    patience: float
    turning: float  # [s]


@final
class ReserveResponseSettings(Settings):
    """Action at the energy reserve, and how long a report is valid."""

    action: Action = setting('land', fixed=True)
    """
    What to do at the energy reserve: "land" at once, "return" to the start and land there, or
    "perch": fly on to the lamp and land there (needs a strategy that reports its arrival, such as
    homing).
    """
    stale: float = setting(1.0, 's', 0.2, 600.0)
    """If the latest report of the energy monitor is older than this, the drone lands."""
    home: float = setting(0.5, 'm', 0.05, 100.0)
    """Distance from the start at which the returning drone lands."""
    patience: float = setting(2.0, low=1.0, high=20.0)
    """Time limit of the flight back to the start, as a multiple of distance / airspeed."""
    turning: float = setting(20.0, 's', 0.0, 600.0)
    """Time added to the limit of the flight back, for slowing down and turning."""

    @property
    def rule(self) -> ReserveRule:
        """Return the part that decides in flight."""
        action = ReserveAction[self.action.upper()]
        return ReserveRule(action, self.home, self.patience, self.turning)


class ReserveReport(NamedTuple):
    """Latest report of the energy monitor."""

    reserve_ns: int  # arrival of `energy/reserve` in graph time [ns]
    reserve: bool  # whether the reserve is reached
    urgent: bool  # whether to land at once
    why: str = ''  # reason in words
    # Arrival of `energy/status`, from which `urgent` and `why` are; None: with the reserve
    status_ns: int | None = None

    def age(self, now_ns: int) -> float:
        """Return the time since the arrival of the older part, in graph time [s]."""
        status_ns = self.reserve_ns if self.status_ns is None else self.status_ns
        return (now_ns - min(self.reserve_ns, status_ns)) * 1e-9


def decide_permission(
    settings: ReserveResponseSettings, word: ReserveReport | None, now_ns: int
) -> FlightPermission:
    """Return what the energy allows; without a fresh report the drone must land."""
    if word is None or word.age(now_ns) > settings.stale or word.urgent:
        return FlightPermission.DOWN
    return permission_at_reserve(word.reserve)


def permission_at_reserve(reserve: bool) -> FlightPermission:
    """Return what the energy allows, by whether the reserve is reached."""
    return FlightPermission.RESERVE if reserve else FlightPermission.FLY


def explain_restriction(
    settings: ReserveResponseSettings, word: ReserveReport | None, now_ns: int
) -> str:
    """Return why the energy restricts the flight, in words."""
    if word is None:
        return 'no report from the energy monitor'
    age = word.age(now_ns)
    if age > settings.stale:
        return f'no report from the energy monitor for {age:.1f} s'
    return word.why or 'the energy reserve is reached'


Place = tuple[float, float]


def check_reserve(settings: ReserveResponseSettings, strategy: NavigationStrategy) -> None:
    """Raise `BadInput` if the strategy does not support the action at the reserve."""
    if settings.action == 'perch' and not strategy.arrives:
        raise BadInput(
            f'The strategy {strategy.name} never reports an arrival at a lamp, so it does not '
            'support reserve.action perch; choose the strategy homing, or set '
            'reserve.action to land or return.'
        )


def apply_reserve(
    rule: ReserveRule,
    speed: float,
    mission: Mission,
    sight: LightMeasurement,
    order: FlightPermission,
) -> Mission:
    """
    Return the mission after applying the energy reserve.

    A flight back is never restarted and always ends in a landing, wherever it has led: it uses
    dead reckoning, which drifts with the wind. `speed` is its airspeed. [m/s]
    """
    if mission.phase == Phase.HOME:
        mission = mission._replace(left=mission.left - sight.interval)
        near = distance_to_start(mission.start, sight.position) <= rule.home
        over = near or mission.left <= 0.0 or order == FlightPermission.DOWN
        return mission._replace(phase=Phase.LAND) if over else mission
    if order == FlightPermission.FLY or mission.phase == Phase.LAND:
        return mission
    # During the climb the drone is still near its start, so it lands at once.
    if order == FlightPermission.RESERVE and mission.phase != Phase.CLIMB:
        # Continue to the lamp; the landing follows on arrival
        if rule.action == ReserveAction.PERCH and mission.phase == Phase.SEEK:
            return mission
        if rule.action == ReserveAction.RETURN and speed > 0.0:
            way = distance_to_start(mission.start, sight.position)
            # A time limit, because a head wind may make the start unreachable
            left = rule.turning + rule.patience * way / speed
            return mission._replace(phase=Phase.HOME, left=left)
    return mission._replace(phase=Phase.LAND)


def heading_to_start(start: Place, place: Place) -> float:
    """Return the heading to the start [rad, odom]."""
    return math.atan2(start[1] - place[1], start[0] - place[0])


def distance_to_start(start: Place, place: Place) -> float:
    """Return the distance from the start [m]."""
    return math.hypot(start[0] - place[0], start[1] - place[1])
