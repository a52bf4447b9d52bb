# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A course: setpoints over time, and an optional excitation of the motors for identification.

The excitation adds a piecewise constant number to each duty. The vehicle's response separates the
effects of its rotors. The numbers depend on the time alone, so every vehicle that flies a course
gets the same excitation.
"""

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Final, final, Literal, NamedTuple, Self

from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import Field, model_validator

Time = Annotated[Quantity, si_quantity('s', low=0.0, high=3600.0)]
Between = Literal['step', 'ramp']
# Shift of the changes from rotor to rotor, in holds. The golden ratio keeps them apart
ROTOR_SHIFT: Final = 0.618034
WORD_MASK: Final = (1 << 64) - 1  # mask of 64 bits
# Constants of splitmix64, Steele, Lea and Flood (2014), doi:10.1145/2714064.2660195
GAMMA, FIRST_MIX, SECOND_MIX = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


@final
class CourseRow(StrictModel):
    """Setpoints from one time on; the heading is relative to that at the start."""

    at: Time
    altitude: Annotated[Quantity, si_quantity('m', low=0.0, high=1000.0)]
    heading: Annotated[Quantity, si_quantity('rad', low=-100.0, high=100.0)]
    speed: Annotated[Quantity, si_quantity('m/s', low=0.0, high=50.0)]


@final
class MotorExcitation(StrictModel):
    """Excitation of each rotor by numbers within +-`duty`, each held for `hold`."""

    duty: Annotated[Quantity, si_quantity('1', above=0.0, high=0.5)]
    hold: Annotated[Quantity, si_quantity('s', low=0.05, high=60.0)]


@final
class CourseSetpoint(NamedTuple):
    """Altitude of the hull centre [m], heading [rad] and forward airspeed [m/s]."""

    altitude: float
    heading: float
    speed: float


@final
class Course(StrictModel):
    """
    Setpoints over time.

    The vehicle climbs to the first row and ends with the last one; altitude 0 there is a landing.
    The motors are excited between the two if `shake` is given.
    """

    between: Between
    rows: Annotated[list[CourseRow], Field(min_length=1, max_length=1000)]
    shake: MotorExcitation | None = None

    @model_validator(mode='after')
    def _check_order(self) -> Self:
        check_rising_times([row.at.si for row in self.rows])
        return self

    def setpoint_at(self, time: float) -> CourseSetpoint:
        """Return the setpoint at a time [s]; before the first row, to stay on the floor."""
        rows = [(row.altitude.si, row.heading.si, row.speed.si) for row in self.rows]
        before = (0.0, rows[0][1], 0.0)
        return CourseSetpoint(
            *interpolate_rows([row.at.si for row in self.rows], rows, self.between, time, before)
        )

    def excite_duties(
        self, time: float, duties: tuple[float, ...], reversible: Sequence[bool]
    ) -> tuple[float, ...]:
        """
        Return duties with the excitation added, limited to the range of each rotor.

        `time`: since the start [s]. `duties`: commanded duties. If all are 0 the motors are off,
        and stay off. `reversible`: by rotor; further duties are returned unchanged.
        """
        # No excitation during the climb to the first row and after the last
        begin, end = self.rows[0].at.si, self.rows[-1].at.si
        if self.shake is None or not begin <= time < end or not any(duties):
            return duties
        size, hold = self.shake.duty.si, self.shake.hold.si
        out = list(duties)
        for k, back in enumerate(reversible):
            # The index of the hold is the only random state, so no seed is needed
            more = size * hashed_uniform(int(time / hold + ROTOR_SHIFT * k), k)
            out[k] = min(max(out[k] + more, -1.0 if back else 0.0), 1.0)
        return tuple(out)


def check_rising_times(times: Sequence[float]) -> None:
    """Raise `ValueError` unless the times [s] of the rows increase."""
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError(
            f'has rows at the times {list(times)} s, but each time must be later than the one '
            'before; sort the rows by time, and remove duplicates'
        )


def interpolate_rows(
    times: Sequence[float],
    rows: Sequence[tuple[float, float, float]],
    between: Between,
    time: float,
    before: tuple[float, float, float],
) -> tuple[float, float, float]:
    """
    Return the values at a time.

    Parameters
    ----------
    times : sequence of float
        Times of the rows, increasing. [s]
    rows : sequence of tuple
        Values from each time on.
    between : str
        'step' holds each row until the next, 'ramp' interpolates linearly.
    time : float
        The time to evaluate at. [s]
    before : tuple
        Values before the first row.

    """
    index = bisect_right(times, time) - 1
    if index < 0:
        return before
    now = rows[index]
    if between == 'step' or index + 1 == len(rows):
        return now
    part = (time - times[index]) / (times[index + 1] - times[index])
    a, b, c = (p + part * (q - p) for p, q in zip(now, rows[index + 1], strict=True))
    return a, b, c


def hashed_uniform(index: int, rotor: int) -> float:
    """Return a uniform number from [-1, 1) for one hold of one rotor, by splitmix64."""
    # 64 rotors per hold; + 1 because 0 would map to itself
    word = (GAMMA * (index * 64 + rotor + 1)) & WORD_MASK
    word = ((word ^ (word >> 30)) * FIRST_MIX) & WORD_MASK
    word = ((word ^ (word >> 27)) * SECOND_MIX) & WORD_MASK
    # The upper 53 bits fill the mantissa of a double: [0, 2^53) to [-1, 1)
    return float((word ^ (word >> 31)) >> 11) * 2.0**-52 - 1.0
