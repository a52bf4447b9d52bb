"""Group flights by strategy and case, and compute statistics with bootstrap intervals."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
import math
from typing import Final, final, NamedTuple

from lta_config.schema.sweep_file import CASE_COLUMN
from lta_flight.flight_spec import FlightSpec
from lta_flight.sweep.job_runner import FAILED, SweepRow
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.statistics import format_value, REACHED, ShareInterval, wilson_interval
from lta_studies.light.evaluation.flights import PILOT, STRATEGY_PATH
from lta_studies.light.evaluation.sets import find_flight_set
import numpy as np

BOOTSTRAP_DRAWS: Final = 4000
BOOTSTRAP_SEED: Final = 7
INTERVAL_ENDS: Final = (2.5, 97.5)  # %
FEWEST_VALUES: Final = 5  # values of an order; the bootstrap is overconfident with fewer


class BootstrapMean(NamedTuple):
    """A mean, or a ratio of means, with its 95 % interval and number of flights."""

    value: float
    low: float
    high: float
    flights: int


def bootstrap_mean(values: Sequence[float]) -> BootstrapMean:
    """
    Return a mean with its percentile bootstrap interval.

    Efron and Tibshirani, An Introduction to the Bootstrap (1993), chapter 13. NaN without values;
    a single value has no interval.
    """
    # A mean is a ratio with the denominator 1.
    return bootstrap_ratio(values, [1.0] * len(values))


def bootstrap_ratio(above: Sequence[float], below: Sequence[float]) -> BootstrapMean:
    """Return the ratio of two means over the same flights, resampled in pairs."""
    count = len(above)
    if count == 0:
        return BootstrapMean(math.nan, math.nan, math.nan, 0)
    top, bottom = np.array(above, dtype=np.float64), np.array(below, dtype=np.float64)
    value = float(top.mean() / bottom.mean())
    # Resampling one value would give an interval of zero width.
    if count == 1:
        return BootstrapMean(value, math.nan, math.nan, 1)
    # A fixed seed makes the page reproducible.
    resamples = np.random.default_rng(BOOTSTRAP_SEED).integers(
        count, size=(BOOTSTRAP_DRAWS, count)
    )
    low, high = np.percentile(
        top[resamples].mean(axis=1) / bottom[resamples].mean(axis=1), INTERVAL_ENDS
    )
    return BootstrapMean(value, float(low), float(high), count)


@final
@dataclass(frozen=True, slots=True)
class EvaluationCell:
    """All seeds of one strategy in one case."""

    # Strategy, and label of the case: its name, its values in SI units, or both
    strategy: str
    case: str
    # Common name of cases that differ only along the axis; '' if there is only one family
    family: str
    place: float  # value of the case on the axis of its set; NaN without an axis
    rows: Mapping[int, SweepRow]  # completed flights, by seed
    failed: int = 0  # number of flights that could not be simulated

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

    def ratio_to(self, best: 'EvaluationCell | None', name: str = 'path_length') -> BootstrapMean:
        """Return the ratio of a figure to another cell, over seeds where both arrived."""
        own, other = self.arrival_values(name), {} if best is None else best.arrival_values(name)
        # Paired by seed: the same wind and start for both
        both = sorted(own.keys() & other.keys())
        return bootstrap_ratio([own[seed] for seed in both], [other[seed] for seed in both])


def build_cells(name: str, plan: SweepPlan, rows: Iterable[SweepRow]) -> list[EvaluationCell]:
    """Return the cells of a set by case and strategy, in the order of its sweep."""
    axis = find_flight_set(name).axis
    grouped: dict[tuple[str, str], list[SweepRow]] = {}
    for row in rows:
        grouped.setdefault((format_case(row), row.values[STRATEGY_PATH]), []).append(row)
    cells = []
    places: dict[str, float] = {}
    # The order of the sweep, by the index of the first flight
    for (case, strategy), own in sorted(grouped.items(), key=lambda item: item[1][0].index):
        # Loading a scene is slow, and all strategies of a case share it.
        if case not in places:
            places[case] = (
                math.nan if axis is None else axis.place(build_flight_spec(plan, own[0]))
            )
        # A flight that could not be simulated is counted, but not as a missed lamp.
        completed = {row.seed: row for row in own if row.outcome != FAILED}
        failures = len(own) - len(completed)
        cells.append(
            EvaluationCell(strategy, case, parse_family(own[0]), places[case], completed, failures)
        )
    return cells


def format_case(row: SweepRow) -> str:
    """Return the label of a flight's case."""
    return ', '.join(
        format_value(value) for path, value in row.values.items() if path != STRATEGY_PATH
    )


def parse_family(row: SweepRow) -> str:
    """Return the case name if the case also has values, or without its final number."""
    name = str(row.values.get(CASE_COLUMN, ''))
    if row.values.keys() - {CASE_COLUMN, STRATEGY_PATH}:
        return name
    word, _, number = name.rpartition('_')
    return word if number.isdecimal() else ''


def build_flight_spec(plan: SweepPlan, row: SweepRow) -> FlightSpec:
    """Return the spec of a flight without its strategy, which may be the flights."""
    changes = {
        path: value
        for path, value in plan.build_job(row.index).changes.items()
        if path != STRATEGY_PATH
    }
    return plan.base.with_values(changes)


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


def select_pilot_cells(cells: Iterable[EvaluationCell]) -> dict[str, EvaluationCell]:
    """Return the cells of the reference flights, by case."""
    return {cell.case: cell for cell in cells if cell.strategy == PILOT}
