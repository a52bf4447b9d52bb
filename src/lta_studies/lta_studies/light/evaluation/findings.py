"""Summarize an evaluation in numbers and sentences, and as JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from pathlib import Path
from typing import Any, Final, final

from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.statistics import ShareInterval
from lta_studies.light.evaluation import ground_roughness, labels, paper, pilot
from lta_studies.light.evaluation.cells import EvaluationCell, select_pilot_cells
from lta_studies.light.evaluation.intervals import BootstrapMean
from lta_studies.light.evaluation.path_order import describe_order, find_path_orders, PathOrder
from lta_studies.light.evaluation.run import EvaluationStatus
from lta_studies.light.evaluation.sets import ABLATIONS, INDOORS, ROUGHNESS, SETS

OURS: Final = 'homing'
FIGURES: Final = {'path_length': 'm', 'search_time': 's', 'flight_time': 's', 'energy': 'J'}


@final
@dataclass(frozen=True)
class EvaluationFindings:
    """Data of the page, the tables and the JSON output."""

    done: EvaluationStatus

    @property
    def cells(self) -> Mapping[str, Sequence[EvaluationCell]]:
        """Results by set."""
        return self.done.cells

    @property
    def plans(self) -> Mapping[str, SweepPlan]:
        """Sweep plans by set."""
        return self.done.plans

    @property
    def folder(self) -> Path:
        """Folder of the results."""
        return self.done.order.folder

    @property
    def seeds(self) -> int:
        """Number of seeds requested."""
        return self.done.order.seeds

    @property
    def computing_time(self) -> float:
        """Computing time of all flights. [s]"""
        return self.done.work

    @property
    def own_strategy(self) -> str:
        """Our strategy, which is compared with the paper's."""
        return OURS

    @property
    def all_sets(self) -> Sequence[str]:
        """Names of all sets."""
        return list(SETS)

    @property
    def flight_count(self) -> int:
        """Number of flights."""
        return sum(len(cell.rows) + cell.failed for own in self.cells.values() for cell in own)

    @property
    def failed_count(self) -> int:
        """Number of flights that could not be simulated."""
        return sum(cell.failed for own in self.cells.values() for cell in own)

    @property
    def flight_count_text(self) -> str:
        """Number of flights in words."""
        # An evaluation that was stopped has fewer flights than requested.
        of = '' if self.flight_count == self.done.total else f' of {self.done.total}'
        lost = (
            f', {self.failed_count} of which could not be simulated' if self.failed_count else ''
        )
        return f'{self.flight_count}{of} flights{lost}'

    @cached_property
    def ablations(self) -> list[PathOrder]:
        """Path orders with one factor changed at a time."""
        return find_path_orders(self.cells.get(ABLATIONS, []))

    @property
    def statement(self) -> str:
        """Sentence on the paper's order of paths and its causes."""
        return describe_order(
            find_path_orders(self.cells.get(INDOORS, [])), self.ablations, labels.FACTORS
        )

    @property
    def cautions(self) -> list[str]:
        """Notes on the comparison with the paper."""
        ground = ground_roughness.describe_grounds(self.cells.get(ROUGHNESS, []))
        return [*([ground] if ground else []), *paper.CAUTIONS]

    @property
    def title(self) -> str:
        """Headline."""
        flown = [name for name, own in self.cells.items() if any(cell.rows for cell in own)]
        if not flown:
            return 'No flight could be simulated.'
        name = INDOORS if INDOORS in flown else flown[0]
        cells = [cell for cell in self.cells[name] if cell.rows and cell.strategy != pilot.NAME]
        shares = ', '.join(
            f'{labels.label_strategy(cell.strategy)} {100 * cell.reached_share.value:.0f} %'
            for cell in cells
            # Of a set with several cases only the first fits into a headline.
            if cell.case == cells[0].case
        )
        # The headline is about the indoor set if it was flown, else the first set.
        where = 'Indoors from 7 m' if name == INDOORS else SETS[name].title
        return f'{where}, the lamp is reached by {shares} (share of the flights).'

    @property
    def about(self) -> str:
        """Description of the evaluation."""
        return (
            f'Navigation strategies, flown in {len(self.cells)} '
            f'set{"s" if len(self.cells) > 1 else ""} of scenes with {self.seeds} '
            f'seed{"s" if self.seeds > 1 else ""} each, the same seeds for all strategies. '
            f'{self.statement}'
        )

    def to_dict(self) -> dict[str, Any]:
        """Convert the results to JSON, with NaN as null."""
        return {
            'seeds': self.seeds,
            'flights': self.flight_count,
            'failed': self.failed_count,
            'statement': self.statement,
            'sets': {name: encode_cells(own) for name, own in self.cells.items()},
            'ablations': [
                {'case': each.case, 'holds': each.holds, 'share': finite_or_none(each.share)}
                for each in self.ablations
            ],
            'paper': {name: flown._asdict() for name, flown in paper.INDOORS.items()},
            'units': {**FIGURES, 'reached': '1', 'ratio': '1', 'wind': '1'},
        }


def encode_cells(cells: Sequence[EvaluationCell]) -> list[dict[str, Any]]:
    """Convert the cells of a set to JSON."""
    best = select_pilot_cells(cells)
    return [
        {
            'case': cell.case,
            'strategy': cell.strategy,
            'place': finite_or_none(cell.place),
            'wind': finite_or_none(cell.wind),
            'flights': len(cell.rows),
            'failed': cell.failed,
            'reached': encode_interval(cell.reached_share),
            **{name: encode_interval(cell.mean(name)) for name in FIGURES},
            'ratio': encode_interval(cell.ratio_to(best.get(cell.case))),
        }
        for cell in cells
    ]


def encode_interval(value: BootstrapMean | ShareInterval) -> dict[str, float | None]:
    """Convert a value with its interval to JSON."""
    return {name: finite_or_none(part) for name, part in value._asdict().items()}


def finite_or_none(value: float) -> float | None:
    """Return a number; None if it is not finite."""
    return value if math.isfinite(value) else None
