"""
The search itself: gains that fly a spread of losses best, mean and worst alike.

Each candidate flies the same examinations with the same chance. Its cost is half the mean and half
the worst over them; a candidate outside the bounds is flown at the bound and pays for the
distance.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_studies.tune.cma_es import CmaEsSearch, Vector
from lta_studies.tune.evaluation_log import EvaluationLog
from lta_studies.tune.parameters import TunableParameter
import numpy as np

STEP = 0.35  # of the logarithm: the first generation turns gains by a factor of 1.4
OUTSIDE = 0.1  # cost of one unit of the logarithm beyond a bound, squared

Numbers = Mapping[str, float]
Fly = Callable[[Numbers], list[float]]


@final
@dataclass(frozen=True, slots=True)
class GainSearchResult:
    """
    What a search found.

    Attributes
    ----------
    numbers : mapping
        The best, by path.
    cost, first : float
        Its cost, and that of the start.
    history : tuple of float
        Least cost so far, candidate by candidate.
    stopped : bool
        Whether it was interrupted.

    """

    numbers: Numbers
    cost: float
    first: float
    history: tuple[float, ...]
    stopped: bool


def robust_cost(costs: Sequence[float]) -> float:
    """Return the cost of a candidate from those of its examinations."""
    return 0.5 * (sum(costs) / len(costs) + max(costs))


def search_gains(
    numbers: Sequence[TunableParameter],
    fly: Fly,
    book: EvaluationLog,
    budget: int,
    seed: int,
    tell: Callable[[int, float], None] = lambda count, best: None,
) -> GainSearchResult:
    """
    Return the best of as many candidates as the budget allows.

    Parameters
    ----------
    numbers : sequence of Number
        What is searched, from where.
    fly : callable
        Returns the costs of a candidate by examination.
    book : Book
        What was flown before, and will be.
    budget : int
        Candidates, the start among them.
    seed : int
        Of the search.
    tell : callable
        Hears how many candidates were flown, and the least cost.

    """
    judge = _CandidateEvaluator(numbers, fly, book, tell)
    stopped = False
    try:
        start = np.log([number.value for number in numbers])
        judge.evaluate_costs([start])
        search = CmaEsSearch(start.tolist(), STEP, seed)
        while len(judge.history) < budget:
            points = search.ask()[: budget - len(judge.history)]
            costs = judge.evaluate_costs(points)
            if len(points) == search.size:  # what is left of the budget may be less
                search.tell(points, costs)
    except KeyboardInterrupt:
        stopped = True
        if judge.best is None:
            raise
    assert judge.best is not None
    cost, best = judge.best
    return GainSearchResult(best, cost, judge.history[0], tuple(judge.history), stopped)


@final
class _CandidateEvaluator:
    """Who has candidates flown and remembers the best; points are logarithms."""

    def __init__(
        self,
        numbers: Sequence[TunableParameter],
        fly: Fly,
        book: EvaluationLog,
        tell: Callable[[int, float], None],
    ) -> None:
        self._paths = [number.path for number in numbers]
        self._ends = np.log([number.search_bounds() for number in numbers])
        self._fly, self._book, self._tell = fly, book, tell
        self.best: tuple[float, dict[str, float]] | None = None
        self.history: list[float] = []

    def evaluate_costs(self, points: Sequence[Vector]) -> list[float]:
        """Return the costs of candidates, with what those beyond a bound pay."""
        inside = [np.clip(point, self._ends[:, 0], self._ends[:, 1]) for point in points]
        values = [dict(zip(self._paths, np.exp(p).tolist(), strict=True)) for p in inside]
        costs = []
        told = _fly_candidates(values, self._fly, self._book, len(self.history))
        for value, cases in zip(values, told, strict=True):
            cost = robust_cost(cases)
            costs.append(cost)
            if self.best is None or cost < self.best[0]:
                self.best = (cost, value)
            self.history.append(self.best[0])
            self._tell(len(self.history), self.best[0])
        beyond = [float(((a - b) ** 2).sum()) for a, b in zip(points, inside, strict=True)]
        return [cost + OUTSIDE * far for cost, far in zip(costs, beyond, strict=True)]


def _fly_candidates(
    values: Sequence[dict[str, float]], fly: Fly, book: EvaluationLog, place: int
) -> Iterator[list[float]]:
    """Yield the costs of candidates, from the book where they are in it."""
    for k, value in enumerate(values):
        numbers = list(value.values())
        costs = book.find_costs(place + k, numbers)
        if costs is None:
            # One candidate at a time: each is kept before the next is flown.
            costs = fly(value)
            book.add(numbers, costs)
        yield costs
