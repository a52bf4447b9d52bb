"""Whether the paper's order of paths holds, and which single factor brings it about."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
import math
from typing import Final, NamedTuple

from lta_studies.light.evaluation.cells import Cell
from lta_studies.light.evaluation.intervals import Mean, SEED
from lta_studies.light.evaluation.paper import ORDER
import numpy as np

SURE: Final = 0.95  # of the draws in which an order must hold to be told as found
FEWEST: Final = 5  # arrivals of each; fewer, resampled, look surer than they are
AS_FLOWN: Final = 'as_flown'  # the case in which nothing is changed


class Found(NamedTuple):
    """
    How the paths are ordered in one case.

    Attributes
    ----------
    case : str
        Which.
    paths : dict
        Mean path by strategy. [m]
    holds : bool
        Whether the means are in the paper's order.
    share : float
        Part of the bootstrap's draws in which they are; NaN where one arrived too seldom.

    """

    case: str
    paths: dict[str, Mean]
    holds: bool
    share: float

    @property
    def sure(self) -> bool:
        """Whether the order is found beyond chance."""
        return self.holds and self.share >= SURE


def orders(cells: Sequence[Cell]) -> list[Found]:
    """Return the order in each case in which all of the paper's strategies flew."""
    by_case: dict[str, dict[str, Cell]] = {}
    for cell in cells:
        by_case.setdefault(cell.case, {})[cell.strategy] = cell
    return [
        found(case, {name: own[name] for name in ORDER})
        for case, own in by_case.items()
        if set(ORDER) <= own.keys()
    ]


def found(case: str, own: Mapping[str, Cell]) -> Found:
    """Return the order of the paths in one case."""
    paths = {name: cell.mean('path_length') for name, cell in own.items()}
    values = [list(cell.figure('path_length').values()) for cell in own.values()]
    means = [each.value for each in paths.values()]
    holds = all(a < b for a, b in pairwise(means))
    return Found(case, paths, holds, share(values))


def share(values: Sequence[Sequence[float]]) -> float:
    """Return the part of draws in which the means of resampled flights rise; NaN of too few."""
    if min(map(len, values)) < FEWEST:
        return math.nan
    chance = np.random.default_rng(SEED)
    drawn = [
        np.array(own)[chance.integers(len(own), size=(4000, len(own)))].mean(axis=1)
        for own in values
    ]
    rises = np.all([a < b for a, b in pairwise(drawn)], axis=0)
    return float(rises.mean())


def statement(
    indoors: Sequence[Found], ablations: Sequence[Found], titles: Mapping[str, str]
) -> str:
    """Return in words whether the paper's order holds, and what brings it about."""
    words = f"The paper's order of paths, {' < '.join(name.upper() for name in ORDER)},"
    unchanged = [each for each in ablations if each.case == AS_FLOWN]
    here = next(iter([*indoors, *unchanged]), None)
    if here is None:
        return f'{words} was not flown.'
    if here.sure:
        return f'{words} holds as flown here (in {draws(here)}).'
    first = f'{words} does not hold beyond chance as flown here (in {draws(here)})'
    if not ablations:
        return f'{first}; the ablations were not flown.'
    bring = [each for each in ablations if each.case != AS_FLOWN and each.sure]
    if not bring:
        return f'{first}, and none of the factors alone brings it about.'
    names = '; '.join(f'{titles.get(each.case, each.case)} (in {draws(each)})' for each in bring)
    return f'{first}. One factor alone brings it about: {names}.'


def draws(found: Found) -> str:
    """Return in words how often the order holds by chance."""
    if math.isnan(found.share):
        return 'none: too few arrived'
    return f'{100 * found.share:.0f} % of resampled flights'
