"""
A course: what is asked for over time, row by row, and how the motors are shaken meanwhile.

Shaking adds to every duty a number that holds for a while and then changes: what a vehicle answers
to it tells its rotors apart. The numbers are drawn from the time alone, so that whoever flies a
course shakes the same.
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
APART: Final = 0.618034  # of a hold, from rotor to rotor: they change one after the other
WORD: Final = (1 << 64) - 1
# Of splitmix64, Steele, Lea and Flood (2014), doi:10.1145/2714064.2660195.
GAMMA, MIX, MIX_AGAIN = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


@final
class CourseRow(StrictModel):
    """What is asked for from one time on; the heading counts from that of the start."""

    at: Time
    altitude: Annotated[Quantity, si_quantity('m', low=0.0, high=1000.0)]
    heading: Annotated[Quantity, si_quantity('rad', low=-100.0, high=100.0)]
    speed: Annotated[Quantity, si_quantity('m/s', low=0.0, high=50.0)]


@final
class MotorExcitation(StrictModel):
    """Numbers within +-`duty`, one a rotor, each for as long as `hold`."""

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
    A whole course.

    The first row is where the vehicle climbs to, the last where it ends: one with altitude 0 is a
    landing. Between the two the motors are shaken, if they are.
    """

    between: Between
    rows: Annotated[list[CourseRow], Field(min_length=1, max_length=1000)]
    shake: MotorExcitation | None = None

    @model_validator(mode='after')
    def _check_order(self) -> Self:
        check_rising_times([row.at.si for row in self.rows])
        return self

    def setpoint_at(self, time: float) -> CourseSetpoint:
        """Return what is asked for at a time; to stay on the floor before the first row. [s]"""
        rows = [(row.altitude.si, row.heading.si, row.speed.si) for row in self.rows]
        before = (0.0, rows[0][1], 0.0)
        return CourseSetpoint(
            *interpolate_rows([row.at.si for row in self.rows], rows, self.between, time, before)
        )

    def excite_duties(
        self, time: float, duties: tuple[float, ...], reversible: Sequence[bool]
    ) -> tuple[float, ...]:
        """
        Return duties with what they are shaken by, within what rotors can.

        Parameters
        ----------
        time : float
            Since the start. [s]
        duties : tuple of float
            As asked for; where all are 0 the motors are off, and stay so.
        reversible : sequence of bool
            By rotor; more duties than these are left as they are.

        """
        begin, end = self.rows[0].at.si, self.rows[-1].at.si
        if self.shake is None or not begin <= time < end or not any(duties):
            return duties
        size, hold = self.shake.duty.si, self.shake.hold.si
        out = list(duties)
        for k, back in enumerate(reversible):
            more = size * hashed_uniform(int(time / hold + APART * k), k)
            out[k] = min(max(out[k] + more, -1.0 if back else 0.0), 1.0)
        return tuple(out)


def check_rising_times(times: Sequence[float]) -> None:
    """Refuse rows that are not in rising order of time; `ValueError`. [s]"""
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError(f'has rows at {list(times)} s; give them in rising order of time')


def interpolate_rows(
    times: Sequence[float],
    rows: Sequence[tuple[float, float, float]],
    between: Between,
    time: float,
    before: tuple[float, float, float],
) -> tuple[float, float, float]:
    """
    Return the row at a time.

    Parameters
    ----------
    times : sequence of float
        Of the rows, rising. [s]
    rows : sequence of tuple
        What is asked for from then on.
    between : str
        Whether the next row is stepped to, or gone to in a straight line.
    time : float
        When. [s]
    before : tuple
        What is asked for before the first row.

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
    """Return a number drawn evenly from [-1, 1) for one hold of one rotor: splitmix64."""
    word = (GAMMA * (index * 64 + rotor + 1)) & WORD
    word = ((word ^ (word >> 30)) * MIX) & WORD
    word = ((word ^ (word >> 27)) * MIX_AGAIN) & WORD
    return float((word ^ (word >> 31)) >> 11) * 2.0**-52 - 1.0
