# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tasks of a commanded flight: kinds, limits, progress and results."""

from dataclasses import dataclass
from enum import IntEnum, StrEnum
import math
from typing import final, NamedTuple

from lta_config.settings import setting, Settings
from lta_control.place_hold import Route

NO_ROUTE = Route()


@final
class TaskLimits(Settings):
    """Limits of commanded tasks."""

    take_off: float = setting(60.0, 's', 1.0, 3600.0)
    """Time limit of a take-off; after that, the drone lands."""
    go_to_lamp: float = setting(180.0, 's', 1.0, 86400.0)
    """Time limit of a flight to a lamp; after that, the drone holds."""
    unseen: float = setting(60.0, 's', 1.0, 3600.0)
    """Time without light from the lamp after which a flight to it ends and the drone holds."""
    place: float = setting(180.0, 's', 1.0, 86400.0)
    """
    Time limit of the way to each place of go_to_pose and follow_path; after that, the drone holds.
    """
    tolerance: float = setting(1.0, 'm', 0.05, 100.0)
    """Distance from a place that counts as there, where the goal names none."""
    land: float = setting(60.0, 's', 1.0, 3600.0)
    """Time limit of a landing; after that, it is reported as failed and goes on."""


class TaskKind(StrEnum):
    """What can be commanded; the values are the names of the actions."""

    TAKE_OFF = 'take_off'
    GO_TO_LAMP = 'go_to_lamp'
    GO_TO_POSE = 'go_to_pose'
    FOLLOW_PATH = 'follow_path'
    LAND = 'land'


TO_PLACES = (TaskKind.GO_TO_POSE, TaskKind.FOLLOW_PATH)


class TaskOutcome(IntEnum):
    """How a task ended; the numbers are those of the .action files."""

    SUCCEEDED = 0
    TIMEOUT = 2
    RESERVE = 3
    FAULT = 4
    CANCELED = 5
    NOT_SEEN = 6


class TaskResult(NamedTuple):
    """How a task ended, and why in words."""

    outcome: TaskOutcome
    message: str


class TaskProgress(NamedTuple):
    """The drone and its lamp or place after the newest light block; NaN: unknown."""

    height: float = math.nan  # of the hull centre above the floor [m]
    climb: float = math.nan  # [m/s]
    seen: bool = False
    distance: float = math.nan  # horizontal, to the lamp; else to the place [m]
    bearing: float = math.nan  # of the lamp, from the nose, counter-clockwise [rad]
    place: int = 0  # index of the place to which it flies


@final
@dataclass(slots=True, eq=False)
class FlightTask:
    """A task that was requested."""

    kind: TaskKind
    # Height of a take-off [m] or frequency of a lamp [Hz]; 0: as in the settings
    value: float = 0.0
    route: Route = NO_ROUTE  # of a flight to places
    place: int = 0  # index of the next one
    result: TaskResult | None = None  # None while it is flown
    newest_ns: int | None = None  # stamp of its newest light block [ns]
    # Time since its first block, and since light from the lamp or the first block [ns]
    flown_ns: int = 0
    unseen_ns: int = 0
    arrived_ns: int | None = None  # `flown_ns` at its arrival; None away from lamp or place
    driven: bool = False  # whether a motor has turned

    def advance(self, stamp_ns: int) -> None:
        """Count the time since the last block; none where the stamps jump back."""
        if self.newest_ns is not None:
            passed = max(stamp_ns - self.newest_ns, 0)
            self.flown_ns += passed
            self.unseen_ns += passed
        self.newest_ns = stamp_ns
