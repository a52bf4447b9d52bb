"""Build the tables of the evaluation, for page, terminal and docs."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_report.formatting import format_number, MISSING
from lta_report.report import TextTable
from lta_studies.light.evaluation import labels, paper, pilot
from lta_studies.light.evaluation.cells import EvaluationCell, select_pilot_cells
from lta_studies.light.evaluation.path_order import PathOrder
from lta_studies.light.evaluation.sets import find_flight_set, INDOORS
from lta_studies.light.evaluation.wind import ALLOWED

SET_HEADS: Final = (
    'case', 'strategy', 'flights', 'reached', 'path [m]', 'time [s]', 'path / pilot',
)  # fmt: skip
PAPER_HEADS: Final = ('strategy', 'path here [m]', 'paper', 'time here [s]', 'paper')
WIND_HEADS: Final = ('wind at 10 m', 'strategy', 'reached here', 'paper')
ORDER_HEADS: Final = (
    'changed', *map(labels.label_strategy, paper.ORDER), 'order of the paper', 'draws',
)  # fmt: skip
TARGET_HEADS: Final = ('case', 'reached', 'at least', 'path / pilot', 'at most', 'met')
OURS: Final = 'homing'
SHARE_WANTED: Final = 0.95
RATIO_WANTED: Final = 1.1


def build_set_table(name: str, cells: Sequence[EvaluationCell]) -> TextTable:
    """Return the table of a set, with a row for each case and strategy."""
    part, best = find_flight_set(name), select_pilot_cells(cells)
    rows = [
        [
            labels.label_case(cell, part.axis),
            labels.label_strategy(cell.strategy),
            str(len(cell.rows)) + (f' (+{cell.failed} failed)' if cell.failed else ''),
            labels.format_share(cell.reached_share),
            labels.format_mean(cell.mean('path_length')),
            labels.format_mean(cell.mean('search_time')),
            MISSING if cell.strategy == pilot.NAME
            else labels.format_mean(cell.ratio_to(best.get(cell.case)), 2),
        ]
        for cell in cells
    ]  # fmt: skip
    return TextTable(part.title, SET_HEADS, rows, printed=False)


def build_paper_table(cells: Sequence[EvaluationCell]) -> TextTable:
    """Return the table that compares the indoor flights with the paper's."""
    own = {cell.strategy: cell for cell in cells}
    rows = [
        [
            labels.label_strategy(name),
            labels.format_mean(own[name].mean('path_length')), f'{figures.path:g}',
            labels.format_mean(own[name].mean('search_time')), format_number(figures.time, 1),
        ]
        for name, figures in paper.INDOORS.items()
        if name in own
    ]  # fmt: skip
    return TextTable('Comparison with the paper, indoors', PAPER_HEADS, rows)


def build_wind_table(cells: Sequence[EvaluationCell]) -> TextTable:
    """Return the table that compares success in the paper's winds."""
    rows = [
        [
            f'{cell.place:g} m/s',
            labels.label_strategy(cell.strategy),
            labels.format_share(cell.reached_share),
            'reached' if cell.strategy in paper.OUTDOORS[cell.place] else 'failed',
        ]
        for cell in cells
        # Only the paper's winds and strategies
        if cell.place in paper.OUTDOORS and cell.strategy in paper.ORDER
    ]
    return TextTable("Comparison with the paper, in the paper's winds", WIND_HEADS, rows)


def build_order_table(orders: Sequence[PathOrder], statement: str) -> TextTable:
    """Return the table of the order of paths, with a row for each ablation."""
    rows = [
        [
            labels.label_factor(each.case),
            *(labels.format_mean(each.paths[name]) for name in paper.ORDER),
            'yes' if each.is_significant else 'not significant' if each.holds else 'no',
            MISSING if math.isnan(each.share) else f'{100 * each.share:.0f} %',
        ]
        for each in orders
    ]
    heading = "What causes the paper's order"
    return TextTable(heading, ORDER_HEADS, rows, statement, printed=False)


def build_target_table(sets: Mapping[str, Sequence[EvaluationCell]]) -> TextTable:
    """Return the table of targets: whether our strategy meets them in each piloted case."""
    rows = []
    for name, cells in sets.items():
        part, best = find_flight_set(name), select_pilot_cells(cells)
        for cell in cells:
            # The targets apply in wind that the vehicle can fly against, relative to the pilot.
            if cell.strategy != OURS or not part.piloted or cell.wind > ALLOWED:
                continue
            reached, ratio = cell.reached_share, cell.ratio_to(best.get(cell.case))
            met = reached.value >= SHARE_WANTED and ratio.value <= RATIO_WANTED
            title = (
                part.title
                if name == INDOORS
                else f'{part.title}: {labels.label_case(cell, part.axis)}'
            )
            rows.append(
                [
                    title, labels.format_share(reached), f'{100 * SHARE_WANTED:.0f} %',
                    labels.format_mean(ratio, 2), f'{RATIO_WANTED:g}', 'yes' if met else 'no',
                ]
            )  # fmt: skip
    return TextTable('Targets of our strategy', TARGET_HEADS, rows)
