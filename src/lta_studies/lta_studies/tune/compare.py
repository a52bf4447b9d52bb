"""What tuned gains bought: old and new through the same draws of loss and chance."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_control.cascade import CascadeGains
from lta_flight.sweep.statistics import Share, wilson
from lta_report.children import Children
from lta_studies.tune.crew import fly_all, Task
from lta_studies.tune.exam import Case, Scene, Step, STEPS
from lta_studies.tune.marks import Report
import numpy as np
from scipy.special import stdtrit

FRESH = 1000  # seeds from here on: none that the search has seen


@final
@dataclass(frozen=True, slots=True)
class Spread:
    """A median with the middle half. [of whatever it is]"""

    median: float
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True)
class Difference:
    """Mean of new less old over the same draws, with its 95 % interval. [1]"""

    mean: float
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True)
class Flights:
    """
    Examinations of one set of gains.

    Attributes
    ----------
    losses : tuple of float
        Lift lost, flight by flight. [kg]
    reports : tuple of Report
        How each went.

    """

    losses: tuple[float, ...]
    reports: tuple[Report, ...]

    @property
    def lost(self) -> Share:
        """Share whose altitude was lost, with its 95 % interval."""
        return wilson(sum(report.lost for report in self.reports), len(self.reports))

    @property
    def reached(self) -> Share:
        """Share whose mission ended at its goal, with its 95 % interval."""
        return wilson(sum(report.reached for report in self.reports), len(self.reports))

    def settled(self, step: int) -> Share:
        """Share in which a step settled, with its 95 % interval."""
        times = [report.marks[step].settle for report in self.reports if report.marks]
        return wilson(sum(map(math.isfinite, times)), len(self.reports))

    def of(self, step: int, figure: str) -> Spread:
        """Return how a figure of a mark spreads."""
        return spread(
            [getattr(report.marks[step], figure) for report in self.reports if report.marks]
        )

    def whole(self, figure: str) -> Spread:
        """Return how a figure of the reports spreads."""
        return spread([getattr(report, figure) for report in self.reports])


def spread(values: Sequence[float]) -> Spread:
    """Return median and quartiles; what never ended stays infinite."""
    ordered = np.sort(np.array(values, dtype=np.float64))
    if not len(ordered):
        return Spread(math.nan, math.nan, math.nan)
    places = (0.5, 0.25, 0.75)
    # The nearest rank: no mean between a number and infinity.
    middle, low, high = (float(ordered[round(p * (len(ordered) - 1))]) for p in places)
    return Spread(middle, low, high)


def difference(old: Flights, new: Flights) -> Difference:
    """Return by how much the cost fell over the same draws (Student's interval of the mean)."""
    pairs = zip(old.reports, new.reports, strict=True)
    gaps = np.array([b.cost - a.cost for a, b in pairs])
    count = len(gaps)
    half = math.inf
    if count > 1:
        quantile = float(stdtrit(count - 1, 0.975))
        half = quantile * float(gaps.std(ddof=1)) / math.sqrt(count)
    mean = float(gaps.mean())
    return Difference(mean, mean - half, mean + half)


def drawn(least: float, most: float, count: int, seed: int) -> list[Case]:
    """Return cases with losses drawn evenly [kg] and seeds that no search has seen."""
    chance = np.random.default_rng(seed)
    losses = chance.uniform(least, most, count).tolist()
    return [Case(loss, FRESH + k) for k, loss in enumerate(losses)]


def compared(
    scene: Scene, both: tuple[CascadeGains, CascadeGains], cases: Sequence[Case], crew: Children
) -> tuple[Flights, Flights]:
    """Fly old and new gains through the same cases."""
    tasks = [Task(scene, gains, case) for gains in both for case in cases]
    reports = fly_all(tasks, crew)
    losses = tuple(case.loss for case in cases)
    count = len(cases)
    return Flights(losses, tuple(reports[:count])), Flights(losses, tuple(reports[count:]))


def step_name(step: Step) -> str:
    """Return what a step is called."""
    change = step.after - step.before
    if step.channel in ('heading', 'course'):
        return f'{step.channel} {math.degrees(change):+.0f} deg'
    return f'{step.channel} {change:+.1f} {"m" if step.channel == "altitude" else "m/s"}'


NAMES = tuple(step_name(step) for step in STEPS)
