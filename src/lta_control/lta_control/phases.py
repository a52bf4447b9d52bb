"""How far a mission has come: what the drone is doing, where it began, which lamp it is about."""

from enum import StrEnum
from typing import NamedTuple

from lta_control.strategies.protocol import Memory

SWITCHING = 2  # turns from asking for another beacon until what is heard is surely its light


class Phase(StrEnum):
    """What the drone is doing."""

    REST = 'rest'
    CLIMB = 'climb'
    SEEK = 'seek'
    ARRIVED = 'arrived'
    HOME = 'home'
    LAND = 'land'


class Mission(NamedTuple):
    """
    How far the drone has come.

    Attributes
    ----------
    phase : Phase
        What it is doing.
    memory : tuple of float
        The strategy's, once it has begun.
    leg : int
        Which lamp of its route it seeks or stays at, from 0.
    asked : int
        Which one it listens for: `leg`, or the next.
    turns : int
        Light blocks since it began to listen for that one.
    heard : int
        How many of them, at the end and without a gap, had the lamp in sight.
    refused : bool
        Whether it stays because the next lamp was not heard.
    start : tuple of float
        Where it took off, by dead reckoning. [m, odom]
    left : float
        Time in which its flight back must be over. [s]

    """

    phase: Phase = Phase.REST
    memory: Memory = ()
    leg: int = 0
    asked: int = 0
    turns: int = SWITCHING
    heard: int = 0
    refused: bool = False
    start: tuple[float, float] = (0.0, 0.0)
    left: float = 0.0
