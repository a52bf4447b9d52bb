"""
The search itself: gains that fly a spread of losses best, mean and worst alike.

Each candidate flies the same examinations with the same chance. Its cost is half the mean and half
the worst over them; a candidate outside the bounds is flown at the bound and pays for the
distance.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_analysis.tune.book import Book
from lta_analysis.tune.numbers import Number
from lta_analysis.tune.search import Search, Vector
import numpy as np

STEP = 0.35  # of the logarithm: the first generation turns gains by a factor of 1.4
OUTSIDE = 0.1  # cost of one unit of the logarithm beyond a bound, squared

Numbers = Mapping[str, float]
Fly = Callable[[Sequence[Numbers]], list[list[float]]]


@final
@dataclass(frozen=True, slots=True)
class Found:
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


def robust(costs: Sequence[float]) -> float:
    """Return the cost of a candidate from those of its examinations."""
    return 0.5 * (sum(costs) / len(costs) + max(costs))


def find(
    numbers: Sequence[Number],
    fly: Fly,
    book: Book,
    budget: int,
    seed: int,
    tell: Callable[[int, float], None] = lambda count, best: None,
) -> Found:
    """
    Return the best of as many candidates as the budget allows.

    Parameters
    ----------
    numbers : sequence of Number
        What is searched, from where.
    fly : callable
        Returns the costs by examination for each of some candidates.
    book : Book
        What was flown before, and will be.
    budget : int
        Candidates, the start among them.
    seed : int
        Of the search.
    tell : callable
        Hears how many candidates were flown, and the least cost.

    """
    paths = [number.path for number in numbers]
    ends = np.log([number.ends() for number in numbers])
    start = np.log([number.value for number in numbers])
    best: tuple[float, dict[str, float]] | None = None
    history: list[float] = []

    def judged(points: Sequence[Vector]) -> list[float]:
        nonlocal best
        inside = [np.clip(point, ends[:, 0], ends[:, 1]) for point in points]
        values = [dict(zip(paths, np.exp(p).tolist(), strict=True)) for p in inside]
        costs = []
        for value, cases in zip(values, _flown(values, fly, book, len(history)), strict=True):
            cost = robust(cases)
            costs.append(cost)
            if best is None or cost < best[0]:
                best = (cost, value)
            history.append(best[0])
            tell(len(history), best[0])
        beyond = [float(((a - b) ** 2).sum()) for a, b in zip(points, inside, strict=True)]
        return [cost + OUTSIDE * far for cost, far in zip(costs, beyond, strict=True)]

    stopped = False
    try:
        judged([start])
        search = Search(start.tolist(), STEP, seed)
        while len(history) < budget:
            points = search.ask()[: budget - len(history)]
            costs = judged(points)
            if len(points) == search.size:  # what is left of the budget may be less
                search.tell(points, costs)
    except KeyboardInterrupt:
        stopped = True
        if best is None:
            raise
    assert best is not None
    return Found(best[1], best[0], history[0], tuple(history), stopped)


def _flown(
    values: Sequence[dict[str, float]], fly: Fly, book: Book, place: int
) -> list[list[float]]:
    """Return the costs of candidates, from the book where they are in it."""
    told = [book.known(place + k, list(each.values())) for k, each in enumerate(values)]
    missing = [each for each, known in zip(values, told, strict=True) if known is None]
    fresh = iter(fly(missing) if missing else [])
    out = []
    for value, known in zip(values, told, strict=True):
        if known is None:
            costs = next(fresh)
            book.add(list(value.values()), costs)
            out.append(costs)
        else:
            out.append(known)
    return out
