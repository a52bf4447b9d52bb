"""What an evaluation came to: its figures, its sentences, and both as JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from pathlib import Path
from typing import Any, Final, final

from lta_flight.sweep.plan import Plan
from lta_flight.sweep.statistics import Share
from lta_studies.light.evaluation import grounds, paper, pilot, words
from lta_studies.light.evaluation.cells import Cell, pilots
from lta_studies.light.evaluation.intervals import Mean
from lta_studies.light.evaluation.order import Found, orders, statement
from lta_studies.light.evaluation.run import Evaluated
from lta_studies.light.evaluation.sets import ABLATIONS, INDOORS, ROUGHNESS, SETS

OURS: Final = 'homing'
FIGURES: Final = {'path_length': 'm', 'search_time': 's', 'flight_time': 's', 'energy': 'J'}


@final
@dataclass(frozen=True)
class Findings:
    """All that page, JSON and tables are made of."""

    done: Evaluated

    @property
    def cells(self) -> Mapping[str, Sequence[Cell]]:
        """What was found, by set."""
        return self.done.cells

    @property
    def plans(self) -> Mapping[str, Plan]:
        """The sets, by name."""
        return self.done.plans

    @property
    def folder(self) -> Path:
        """Where the results are."""
        return self.done.order.folder

    @property
    def seeds(self) -> int:
        """Seeds that were asked for."""
        return self.done.order.seeds

    @property
    def work(self) -> float:
        """Time of all flights together. [s]"""
        return self.done.work

    @property
    def ours(self) -> str:
        """The strategy that is to be better than the paper's."""
        return OURS

    @property
    def all_sets(self) -> Sequence[str]:
        """Names of every set."""
        return list(SETS)

    @property
    def flights(self) -> int:
        """Flights there are."""
        return sum(len(cell.rows) + cell.failed for own in self.cells.values() for cell in own)

    @property
    def failed(self) -> int:
        """Flights that could not be flown."""
        return sum(cell.failed for own in self.cells.values() for cell in own)

    @property
    def count(self) -> str:
        """How many flights there are, in words."""
        of = '' if self.flights == self.done.total else f' of {self.done.total}'
        lost = f', {self.failed} of them failed' if self.failed else ''
        return f'{self.flights}{of} flights{lost}'

    @cached_property
    def ablations(self) -> list[Found]:
        """How the paths are ordered with one factor changed at a time."""
        return orders(self.cells.get(ABLATIONS, []))

    @property
    def statement(self) -> str:
        """What brings about the paper's order of paths."""
        return statement(orders(self.cells.get(INDOORS, [])), self.ablations, words.FACTORS)

    @property
    def cautions(self) -> list[str]:
        """What to keep in mind beside the paper's figures."""
        ground = grounds.statement(self.cells.get(ROUGHNESS, []))
        return [*([ground] if ground else []), *paper.CAUTIONS]

    @property
    def title(self) -> str:
        """What came out, in a sentence."""
        flown = [name for name, own in self.cells.items() if any(cell.rows for cell in own)]
        if not flown:
            return 'No flight could be flown.'
        name = INDOORS if INDOORS in flown else flown[0]
        cells = [cell for cell in self.cells[name] if cell.rows and cell.strategy != pilot.NAME]
        told = ', '.join(
            f'{words.strategy(cell.strategy)} {100 * cell.reached.value:.0f} %'
            for cell in cells
            if cell.case == cells[0].case
        )
        where = 'Indoors from 7 m' if name == INDOORS else SETS[name].title
        return f'{where}, the lamp is reached by {told}.'

    @property
    def about(self) -> str:
        """What was done, in two sentences."""
        return (
            f'Navigation strategies over {len(self.cells)} '
            f'set{"s" if len(self.cells) > 1 else ""} of scenes, {self.seeds} '
            f'seed{"s" if self.seeds > 1 else ""} each, the same for all. {self.statement}'
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the figures, ready for JSON; what is no number is null."""
        return {
            'seeds': self.seeds,
            'flights': self.flights,
            'failed': self.failed,
            'statement': self.statement,
            'sets': {name: told(own) for name, own in self.cells.items()},
            'ablations': [
                {'case': each.case, 'holds': each.holds, 'share': number(each.share)}
                for each in self.ablations
            ],
            'paper': {name: flown._asdict() for name, flown in paper.INDOORS.items()},
            'units': {**FIGURES, 'reached': '1', 'ratio': '1', 'wind': '1'},
        }


def told(cells: Sequence[Cell]) -> list[dict[str, Any]]:
    """Return a set's figures."""
    best = pilots(cells)
    return [
        {
            'case': cell.case,
            'strategy': cell.strategy,
            'place': number(cell.place),
            'wind': number(cell.wind),
            'flights': len(cell.rows),
            'failed': cell.failed,
            'reached': ends(cell.reached),
            **{name: ends(cell.mean(name)) for name in FIGURES},
            'ratio': ends(cell.against(best.get(cell.case))),
        }
        for cell in cells
    ]


def ends(value: Mean | Share) -> dict[str, float | None]:
    """Return a figure with its interval."""
    return {name: number(part) for name, part in value._asdict().items()}


def number(value: float) -> float | None:
    """Return a number, None where it is none."""
    return value if math.isfinite(value) else None
