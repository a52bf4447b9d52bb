"""Group flights by strategy and case, and compute statistics with bootstrap intervals."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
import math
from typing import Final, final

from lta_flight.sweep.job_runner import FAILED, SweepRow
from lta_flight.sweep.statistics import (
    BOOTSTRAP_DRAWS,
    bootstrap_mean,
    BOOTSTRAP_SEED,
    BootstrapMean,
    format_value,
    is_number,
    REACHED,
    ShareInterval,
    wilson_interval,
)
import numpy as np

STRATEGY_PATH: Final = 'strategy'
FEWEST_VALUES: Final = 5  # values of an order; the bootstrap is overconfident with fewer


@final
@dataclass(frozen=True, slots=True)
class StrategyFlights:
    """All seeds of one strategy in one case, of flights that could be simulated."""

    strategy: str
    case: str  # label of the case: its name, its values in SI units, or both
    place: float  # number that the cases vary, in SI units; NaN without one
    rows: Mapping[int, SweepRow]  # by seed

    @property
    def reached_share(self) -> ShareInterval:
        """Share of the flights that reached the lamp, with its Wilson interval."""
        return wilson_interval(len(self.arrivals), len(self.rows))

    @property
    def arrivals(self) -> dict[int, SweepRow]:
        """Flights that reached the lamp, by seed."""
        return {seed: row for seed, row in self.rows.items() if row.outcome == REACHED}

    def arrival_values(self, name: str) -> dict[int, float]:
        """Return a figure of the flights that reached the lamp, by seed."""
        values = {seed: row.figures.get(name) for seed, row in self.arrivals.items()}
        return {seed: float(value) for seed, value in values.items() if value is not None}

    def mean(self, name: str) -> BootstrapMean:
        """Return the mean of a figure over the flights that reached the lamp."""
        return bootstrap_mean(list(self.arrival_values(name).values()))


def group_flights(rows: Iterable[SweepRow]) -> list[StrategyFlights]:
    """Return flights by case and strategy, in the order of their sweep."""
    grouped: dict[tuple[str, str], list[SweepRow]] = {}
    # The order of the sweep, by the index of the first flight
    for row in sorted(rows, key=lambda row: row.index):
        values = [value for path, value in row.values.items() if path != STRATEGY_PATH]
        case = ', '.join(map(format_value, values))
        grouped.setdefault((case, row.values[STRATEGY_PATH]), []).append(row)
    return [
        StrategyFlights(
            strategy,
            case,
            next((float(value) for value in own[0].values.values() if is_number(value)), math.nan),
            {row.seed: row for row in own if row.outcome != FAILED},
        )
        for (case, strategy), own in grouped.items()
    ]


def ordered_share(values: Sequence[Sequence[float]]) -> float:
    """Return the share of bootstrap draws with ascending means; NaN with too few values."""
    if min(map(len, values)) < FEWEST_VALUES:
        return math.nan
    chance = np.random.default_rng(BOOTSTRAP_SEED)
    means = [
        # Strategies are resampled separately: different seeds arrive with each.
        np.array(own)[chance.integers(len(own), size=(BOOTSTRAP_DRAWS, len(own)))].mean(axis=1)
        for own in values
    ]
    rises = np.all([a < b for a, b in pairwise(means)], axis=0)
    return float(rises.mean())
