"""Test whether the paper's order of path lengths holds, and which factor causes it."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
import math
from typing import Final, NamedTuple

from lta_studies.light.evaluation.cells import BootstrapMean, EvaluationCell, SEED
from lta_studies.light.evaluation.paper import ORDER
import numpy as np

SURE: Final = 0.95  # share of bootstrap draws for a significant order
FEWEST: Final = 5  # arrivals per strategy; the bootstrap is overconfident with fewer
AS_FLOWN: Final = 'as_flown'  # the case in which nothing is changed


class PathOrder(NamedTuple):
    """Order of the paths in one case."""

    case: str  # name of the case
    paths: dict[str, BootstrapMean]  # mean path by strategy [m]
    holds: bool  # whether the means are in the paper's order
    share: float  # share of bootstrap draws in that order; NaN with too few arrivals

    @property
    def is_significant(self) -> bool:
        """Whether the order is statistically significant."""
        return self.holds and self.share >= SURE


def find_path_orders(cells: Sequence[EvaluationCell]) -> list[PathOrder]:
    """Return the order in each case with all of the paper's strategies."""
    by_case: dict[str, dict[str, EvaluationCell]] = {}
    for cell in cells:
        by_case.setdefault(cell.case, {})[cell.strategy] = cell
    return [
        assess_path_order(case, {name: own[name] for name in ORDER})
        for case, own in by_case.items()
        if set(ORDER) <= own.keys()
    ]


def assess_path_order(case: str, own: Mapping[str, EvaluationCell]) -> PathOrder:
    """Assess the order of the paths in one case."""
    paths = {name: cell.mean('path_length') for name, cell in own.items()}
    values = [list(cell.arrival_values('path_length').values()) for cell in own.values()]
    means = [each.value for each in paths.values()]
    # The mapping is in the order of the paper, shortest path first.
    holds = all(a < b for a, b in pairwise(means))
    return PathOrder(case, paths, holds, ordered_share(values))


def ordered_share(values: Sequence[Sequence[float]]) -> float:
    """Return the share of bootstrap draws with ascending means; NaN with too few values."""
    if min(map(len, values)) < FEWEST:
        return math.nan
    chance = np.random.default_rng(SEED)
    means = [
        # Strategies are resampled separately: different seeds arrive with each.
        np.array(own)[chance.integers(len(own), size=(4000, len(own)))].mean(axis=1)
        for own in values
    ]
    rises = np.all([a < b for a, b in pairwise(means)], axis=0)
    return float(rises.mean())


def describe_order(
    indoors: Sequence[PathOrder], ablations: Sequence[PathOrder], titles: Mapping[str, str]
) -> str:
    """Describe whether the paper's order holds, and which factor causes it."""
    words = (
        f'The order of path lengths in the paper, {" < ".join(name.upper() for name in ORDER)},'
    )
    unchanged = [each for each in ablations if each.case == AS_FLOWN]
    here = next(iter([*indoors, *unchanged]), None)
    if here is None:
        return f'{words} was not flown.'
    if here.is_significant:
        return f'{words} holds in our flights ({format_ordered_share(here)}).'
    first = f'{words} is not significant in our flights ({format_ordered_share(here)})'
    if not ablations:
        return f'{first}; the flights with one factor changed were not flown.'
    # A factor causes the order if changing it alone makes the order significant.
    bring = [each for each in ablations if each.case != AS_FLOWN and each.is_significant]
    if not bring:
        return f'{first}, and no single factor causes it.'
    names = '; '.join(
        f'{titles.get(each.case, each.case)} ({format_ordered_share(each)})' for each in bring
    )
    return f'{first}. It becomes significant if one of these factors is changed: {names}.'


def format_ordered_share(order: PathOrder) -> str:
    """Format the share of bootstrap draws with the order."""
    if math.isnan(order.share):
        return 'too few flights arrived'
    return f'in {100 * order.share:.0f} % of resampled flights'
