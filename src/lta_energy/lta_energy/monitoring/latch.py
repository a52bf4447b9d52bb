"""Provide a latch that switches on and off only after a delay."""

from typing import NamedTuple

ROUNDING = 1e-6  # s; of a sum of differences of stamps


class Latch(NamedTuple):
    """Whether it is on, and how long its condition has disagreed with that. [s]"""

    on: bool = False
    since: float = 0.0


def update_latch(latch: Latch, condition: bool, dt: float, rise: float, fall: float) -> Latch:
    """
    Update the latch with its condition after a time step.

    `dt`: time since the last update [s]. `rise`, `fall`: time that the condition must hold to
    switch on, and be absent to switch off; 0 is at once [s].
    """
    if condition == latch.on:
        return Latch(latch.on, 0.0)
    since = latch.since + dt
    if since + ROUNDING >= (rise if condition else fall):
        return Latch(condition, 0.0)
    return Latch(latch.on, since)
