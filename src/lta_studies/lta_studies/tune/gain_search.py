"""
Search for gains that fly well over a range of helium losses, by CMA-ES.

CMA-ES needs few evaluations and no gradients, and uses only the ranking of the costs, which may be
discontinuous. Each candidate flies the same test flights with the same seeds. Its cost is the
average of the mean and the worst cost. A candidate outside the bounds is flown at the bound, plus
a penalty for the distance.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from cmaes import CMA
from lta_report.study_store import StudyStore
from lta_report.workers import ItemFailure
from lta_studies.tune.evaluation import CandidateCosts, refuse_failure
from lta_studies.tune.parameters import TunableParameter
import numpy as np
from numpy.typing import NDArray

STEP = 0.35  # of log(gain): the first generation changes gains by a factor of about 1.4
OUTSIDE = 0.1  # penalty per squared unit of log(gain) beyond a bound

Numbers = Mapping[str, float]
Fly = Callable[[Numbers], list[float] | ItemFailure]
Vector = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class GainSearchResult:
    """Result of a gain search."""

    numbers: Numbers  # best parameter values, by path
    # Cost of the best candidate and of the start
    cost: float
    first: float
    history: tuple[float, ...]  # lowest cost so far, after each candidate
    stopped: bool  # whether the search was interrupted


def robust_cost(costs: Sequence[float]) -> float:
    """Return the average of the mean and the worst cost of a candidate's test flights."""
    return 0.5 * (sum(costs) / len(costs) + max(costs))


def search_gains(
    numbers: Sequence[TunableParameter],
    fly: Fly,
    store: StudyStore[CandidateCosts],
    budget: int,
    seed: int,
    tell: Callable[[int, float], None] = lambda count, best: None,
) -> GainSearchResult:
    """
    Search for the best gains within a budget of candidates.

    Parameters
    ----------
    numbers : sequence of TunableParameter
        Parameters to search, with their start values.
    fly : callable
        Returns the cost of each test flight of a candidate, or the failure of one.
    store : StudyStore
        Earlier evaluations; new ones are added.
    budget : int
        Number of candidates, including the start.
    tell : callable
        Progress callback: number of candidates flown, lowest cost so far.

    """
    judge = _CandidateEvaluator(numbers, fly, store, tell)
    stopped = False
    try:
        start = np.log([number.value for number in numbers])
        # The start gains count as the first candidate, so the result is never worse than them.
        judge.evaluate_costs([start])
        search = CMA(start, STEP, seed=seed)
        while len(judge.history) < budget:
            # The budget may cut the last generation short
            count = min(search.population_size, budget - len(judge.history))
            points = [search.ask() for _ in range(count)]
            costs = judge.evaluate_costs(points)
            if count == search.population_size:
                search.tell(list(zip(points, costs, strict=True)))
    # Ctrl-C ends the search with the best candidate so far.
    except KeyboardInterrupt:
        stopped = True
        if judge.best is None:
            raise
    assert judge.best is not None
    cost, best = judge.best
    return GainSearchResult(best, cost, judge.history[0], tuple(judge.history), stopped)


@final
class _CandidateEvaluator:
    """Evaluates candidates (logarithms of the parameters) and stores the best."""

    def __init__(
        self,
        numbers: Sequence[TunableParameter],
        fly: Fly,
        store: StudyStore[CandidateCosts],
        tell: Callable[[int, float], None],
    ) -> None:
        self._paths = [number.path for number in numbers]
        self._ends = np.log([number.search_bounds() for number in numbers])
        self._fly, self._store, self._tell = fly, store, tell
        self.best: tuple[float, dict[str, float]] | None = None
        self.history: list[float] = []

    def evaluate_costs(self, points: Sequence[Vector]) -> list[float]:
        """Return the costs of candidates, including penalties for exceeded bounds."""
        inside = [np.clip(point, self._ends[:, 0], self._ends[:, 1]) for point in points]
        values = [dict(zip(self._paths, np.exp(p).tolist(), strict=True)) for p in inside]
        costs = []
        evaluations = _fly_candidates(values, self._fly, self._store)
        for value, cases in zip(values, evaluations, strict=True):
            cost = robust_cost(cases)
            costs.append(cost)
            if self.best is None or cost < self.best[0]:
                self.best = (cost, value)
            self.history.append(self.best[0])
            self._tell(len(self.history), self.best[0])
        # Only the search sees the penalty; history and result hold the flown cost.
        beyond = [float(((a - b) ** 2).sum()) for a, b in zip(points, inside, strict=True)]
        return [cost + OUTSIDE * far for cost, far in zip(costs, beyond, strict=True)]


def _fly_candidates(
    values: Sequence[dict[str, float]], fly: Fly, store: StudyStore[CandidateCosts]
) -> Iterator[list[float]]:
    """Yield the costs of candidates; take them from the store where possible."""
    for value in values:
        numbers = tuple(value.values())
        if numbers not in store:
            costs = fly(value)
            # Stored before the next is flown, so that an interrupt loses one.
            store.add(
                numbers,
                costs if isinstance(costs, ItemFailure) else CandidateCosts(numbers, costs),
            )
        yield refuse_failure(store.failures.get(numbers) or store.results[numbers]).costs
