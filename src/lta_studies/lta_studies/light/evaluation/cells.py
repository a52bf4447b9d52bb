"""What the flights of one strategy in one case of a set come to, with intervals."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.sweep_file import CASE
from lta_flight.ingredients import Ingredients
from lta_flight.sweep.flown import FAILED, Row
from lta_flight.sweep.plan import Plan
from lta_flight.sweep.statistics import REACHED, Share, told, wilson
from lta_studies.light.evaluation import pilot
from lta_studies.light.evaluation.flying import STRATEGY
from lta_studies.light.evaluation.intervals import Mean, mean, ratio
from lta_studies.light.evaluation.sets import flight_set
from lta_studies.light.evaluation.wind import share_of_top


@final
@dataclass(frozen=True, slots=True)
class Cell:
    """
    All seeds of one strategy in one case.

    Attributes
    ----------
    strategy, case : str
        Who flew, and what the case is called: its name, its values in SI, or both.
    family : str
        What cases have in common that differ along the axis only; '' where all have it.
    place : float
        Where the case lies on the axis of its set; NaN without one.
    wind : float
        Mean wind plus one deviation at the hull, over the top airspeed. [1]
    rows : dict
        The flights that could be flown, by seed.
    failed : int
        How many could not.

    """

    strategy: str
    case: str
    family: str
    place: float
    wind: float
    rows: Mapping[int, Row]
    failed: int = 0

    @property
    def reached(self) -> Share:
        """Share of the flights that reached the lamp, with Wilson's interval."""
        return wilson(len(self.arrivals), len(self.rows))

    @property
    def arrivals(self) -> dict[int, Row]:
        """The flights that reached the lamp, by seed."""
        return {seed: row for seed, row in self.rows.items() if row.outcome == REACHED}

    def figure(self, name: str) -> dict[int, float]:
        """Return a figure of `Results` of the flights that reached the lamp, by seed."""
        found = {seed: row.figures.get(name) for seed, row in self.arrivals.items()}
        return {seed: float(value) for seed, value in found.items() if value is not None}

    def mean(self, name: str) -> Mean:
        """Return the mean of a figure over the flights that reached the lamp."""
        return mean(list(self.figure(name).values()))

    def against(self, best: 'Cell | None', name: str = 'path_length') -> Mean:
        """Return a figure over that of another flyer, over the seeds in which both arrived."""
        own, other = self.figure(name), {} if best is None else best.figure(name)
        both = sorted(own.keys() & other.keys())
        return ratio([own[seed] for seed in both], [other[seed] for seed in both])


def cells_of(name: str, plan: Plan, rows: Iterable[Row]) -> list[Cell]:
    """Return a set's flights by case and strategy, in the order of its sweep."""
    axis = flight_set(name).axis
    grouped: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        grouped.setdefault((case_of(row), row.values[STRATEGY]), []).append(row)
    found = []
    known: dict[str, tuple[float, float]] = {}
    for (case, strategy), own in sorted(grouped.items(), key=lambda item: item[1][0].index):
        if case not in known:
            made_of = ingredients(plan, own[0])
            known[case] = (
                math.nan if axis is None else axis.place(made_of),
                share_of_top(made_of),
            )
        flown = {row.seed: row for row in own if row.outcome != FAILED}
        failures = len(own) - len(flown)
        found.append(Cell(strategy, case, family_of(own[0]), *known[case], flown, failures))
    return found


def case_of(row: Row) -> str:
    """Return what the case of a flight is called."""
    return ', '.join(told(value) for path, value in row.values.items() if path != STRATEGY)


def family_of(row: Row) -> str:
    """Return the name of a case that has values besides, or a number at the end of its name."""
    name = str(row.values.get(CASE, ''))
    if row.values.keys() - {CASE, STRATEGY}:
        return name
    word, _, number = name.rpartition('_')
    return word if number.isdecimal() else ''


def ingredients(plan: Plan, row: Row) -> Ingredients:
    """Return what a flight was made of, but for its strategy, which may be the pilot."""
    changes = {
        path: value for path, value in plan.job(row.index).changes.items() if path != STRATEGY
    }
    return plan.base.with_values(changes)


def pilots(cells: Iterable[Cell]) -> dict[str, Cell]:
    """Return the pilot's flights by case."""
    return {cell.case: cell for cell in cells if cell.strategy == pilot.NAME}
