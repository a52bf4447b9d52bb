# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""State of a mission: its phase, its start, and its current lamp."""

from enum import IntEnum
from typing import NamedTuple

from lta_control.strategies.protocol import Memory

SWITCHING = 2  # light blocks from requesting a beacon until a block surely holds its light


class Phase(IntEnum):
    """What the drone is doing."""

    REST = 0
    CLIMB = 1
    SEEK = 2
    ARRIVED = 3
    HOME = 4
    LAND = 5
    HOLD = 6  # between two commands, or at a place

    def __str__(self) -> str:
        """Return the name as diagnostics report it."""
        return self.name.lower()


class Mission(NamedTuple):
    """State of a mission."""

    phase: Phase = Phase.REST
    memory: Memory = ()  # memory of the strategy, once it has begun
    leg: int = 0  # index of the lamp that it seeks or holds at, from 0
    target: int = 0  # index of the lamp that it listens for: `leg`, or the next
    turns: int = SWITCHING  # light blocks since it began to listen for that one
    receptions: int = 0  # latest consecutive blocks with that lamp in sight
    refused: bool = False  # whether it stays because the next lamp was not received
    start: tuple[float, float] = (0.0, 0.0)  # take-off position, by dead reckoning [m, odom]
    left: float = 0.0  # remaining time for the flight back [s]
    heading: float = 0.0  # last commanded heading, held while landing [rad, odom]
