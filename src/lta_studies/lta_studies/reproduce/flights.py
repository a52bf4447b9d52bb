"""Flights to a lamp for the rows of navigation: some cells of the sets of `lta light evaluate`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from pathlib import Path
from typing import Any, final

from lta_config.schema.sweep_file import Seeds
from lta_config.typed import typed
from lta_flight.ingredients import spoken
from lta_flight.simulate import simulate_once, Simulated
from lta_flight.sweep.plan import Plan
from lta_flight.sweep.statistics import Share
from lta_studies.light.evaluation import pilot
from lta_studies.light.evaluation.cells import Cell, cells_of
from lta_studies.light.evaluation.flying import fly_task, plan_of, STRATEGY, whole
from lta_studies.light.evaluation.intervals import Mean
from lta_studies.reproduce.found import Value
from lta_studies.reproduce.recorded import way
from plotly.graph_objects import Figure

PAPERS = ('bag', 'dga', 'des')


class Quiet:
    """A watcher who shows nothing."""

    def at(self, time: float, distance: float, pace: float) -> None:
        """Look away."""

    def say(self, sentence: str) -> None:
        """Keep silent."""


@final
@dataclass(frozen=True, slots=True)
class Group:
    """Flights of one set, as they were planned, by strategy and case."""

    plan: Plan
    cells: Sequence[Cell]

    def of(self, strategy: str, case: str = '') -> Cell:
        """Return the flights of a strategy, in a case that is called so or begins so."""
        return next(
            each for each in self.cells
            if each.strategy == strategy and each.case.startswith(case)
        )  # fmt: skip

    def strategies(self, case: str = '') -> dict[str, Cell]:
        """Return the flights of all strategies in a case."""
        return {each.strategy: each for each in self.cells if each.case.startswith(case)}


def fly(
    part: str,
    seeds: int,
    *,
    strategies: Sequence[str] = PAPERS,
    cases: Sequence[str] = (),
    vary: Mapping[str, Sequence[Any]] | None = None,
    change: Mapping[str, Any] | None = None,
) -> Group:
    """
    Return flights of a set, each strategy with the same seeds.

    Parameters
    ----------
    part : str
        Of `lta_studies.light.evaluation.sets`.
    seeds : int
        Flights of each.
    strategies, cases : sequence of str
        Which; all cases where none is named.
    vary, change : mapping, optional
        What is varied instead of the set's own, and what is changed besides.

    """
    file = plan_of(part).file
    plan = Plan(
        file.model_copy(
            update={
                'seeds': Seeds(first=file.seeds.first, count=seeds),
                'cases': {k: v for k, v in file.cases.items() if not cases or k in cases},
                'vary': {**file.vary, **(vary or {}), STRATEGY: list(strategies)},
                'settings': {**file.settings, **(change or {})},
            }
        )
    )
    rows = [fly_task(whole(plan, plan.job(k), k)) for k in range(plan.count)]
    return Group(plan, cells_of(part, plan, rows))


def mean_of(found: Mean) -> Value:
    """Return a mean with its bootstrap interval as a value."""
    return Value(found.value, found.low, found.high, found.flights)


def share_of(cell: Cell) -> Value:
    """Return the share of flights that reached the lamp, with Wilson's interval."""
    found: Share = cell.reached
    if len(cell.rows) == 1:
        return Value(found.value, math.nan, math.nan, 1)
    return Value(found.value, found.low, found.high, len(cell.rows))


def figures(name: str, cell: Cell) -> dict[str, Value]:
    """Return share, path [m] and time [s] of the flights of a cell."""
    return {
        f'{name}_reached': share_of(cell),
        f'{name}_path': mean_of(cell.mean('path_length')),
        f'{name}_time': mean_of(cell.mean('search_time')),
    }


def command(group: Group, cell: Cell, seed: int) -> str:
    """Return what to type to fly one flight of a cell again."""
    order = simulated(group, cell, seed)
    sets = [word for each in order.changes for word in ('--set', each)]
    return typed(
        'simulate', '--scenario', order.scenario, '--strategy', order.strategy, '--seed',
        str(seed), *sets,
    )  # fmt: skip


def simulated(group: Group, cell: Cell, seed: int, out: Path | None = None) -> Simulated:
    """Return the order of one flight of a cell, recorded."""
    base, row = group.plan.base, cell.rows[seed]
    changes = {**base.replaced, **group.plan.job(row.index).changes}
    strategy = str(changes.pop(STRATEGY))
    return Simulated(
        base.names['vehicle'], base.names['scenario'], strategy, base.names['gains'], seed,
        tuple(spoken(changes)), out,
    )  # fmt: skip


def uncrowded(figure: Figure) -> Figure:
    """Return a field from above whose few metres from start to lamp have room for their words."""
    figure.layout.annotations = [
        each for each in figure.layout.annotations if not each.text.startswith('goal')
    ]
    figure.for_each_annotation(lambda word: word.update(xshift=-24), {'text': 'start'})
    return figure.update_xaxes(dtick=10).update_yaxes(dtick=10)


def record(group: Group, cells: Sequence[Cell], seed: int, folder: Path) -> str:
    """Record a flight of each strategy but the pilot's; return the page's way there."""
    for cell in cells:
        if cell.strategy != pilot.NAME and seed in cell.rows:
            simulate_once(simulated(group, cell, seed, folder / cell.strategy), Quiet())
    return way(folder)
