"""Build the tables of the evaluation, for page and docs."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_report.formatting import format_number, MISSING
from lta_studies.light.evaluation import labels, paper, pilot
from lta_studies.light.evaluation.cells import EvaluationCell, select_pilot_cells
from lta_studies.light.evaluation.path_order import PathOrder
from lta_studies.light.evaluation.sets import find_flight_set, INDOORS
from lta_studies.light.evaluation.wind import ALLOWED

HEADS: Final = ('case', 'strategy', 'flights', 'reached', 'path [m]', 'time [s]', 'path / pilot')
PAPER_HEADS: Final = ('strategy', 'path here [m]', 'paper', 'time here [s]', 'paper')
OUTDOOR_HEADS: Final = ('wind at 10 m', 'strategy', 'reached here', 'paper')
ORDER_HEADS: Final = (
    'changed',
    *map(labels.label_strategy, paper.ORDER),
    'order of the paper',
    'draws',
)
TARGET_HEADS: Final = ('case', 'reached', 'at least', 'path / pilot', 'at most', 'met')
SHARE_WANTED: Final = 0.95
RATIO_WANTED: Final = 1.1

Lines = list[list[str]]


def build_set_rows(name: str, cells: Sequence[EvaluationCell]) -> Lines:
    """Return a row for each case and strategy of a set."""
    axis, best = find_flight_set(name).axis, select_pilot_cells(cells)
    return [
        [
            labels.label_case(cell, axis),
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


def build_paper_rows(cells: Sequence[EvaluationCell]) -> Lines:
    """Return rows that compare the indoor flights with the paper's."""
    own = {cell.strategy: cell for cell in cells}
    return [
        [
            labels.label_strategy(name),
            labels.format_mean(own[name].mean('path_length')), f'{flown.path:g}',
            labels.format_mean(own[name].mean('search_time')), format_number(flown.time, 1),
        ]
        for name, flown in paper.INDOORS.items()
        if name in own
    ]  # fmt: skip


def build_wind_rows(cells: Sequence[EvaluationCell]) -> Lines:
    """Return rows that compare success in the paper's winds."""
    return [
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


def build_path_order_rows(orders: Sequence[PathOrder]) -> Lines:
    """Return a row with the order of paths for each ablation."""
    return [
        [
            labels.label_factor(each.case),
            *(labels.format_mean(each.paths[name]) for name in paper.ORDER),
            'yes' if each.is_significant else 'not significant' if each.holds else 'no',
            MISSING if math.isnan(each.share) else f'{100 * each.share:.0f} %',
        ]
        for each in orders
    ]


def build_target_rows(findings: Mapping[str, Sequence[EvaluationCell]], ours: str) -> Lines:
    """Return a row for each piloted case: whether our strategy meets its targets."""
    made = []
    for name, cells in findings.items():
        part, best = find_flight_set(name), select_pilot_cells(cells)
        for cell in cells:
            # The targets apply in wind that the vehicle can fly against, relative to the pilot.
            if cell.strategy != ours or not part.piloted or cell.wind > ALLOWED:
                continue
            reached, ratio = cell.reached_share, cell.ratio_to(best.get(cell.case))
            met = reached.value >= SHARE_WANTED and ratio.value <= RATIO_WANTED
            title = (
                part.title
                if name == INDOORS
                else f'{part.title}: {labels.label_case(cell, part.axis)}'
            )
            made.append(
                [
                    title, labels.format_share(reached), f'{100 * SHARE_WANTED:.0f} %',
                    labels.format_mean(ratio, 2), f'{RATIO_WANTED:g}', 'yes' if met else 'no',
                ]
            )  # fmt: skip
    return made


def format_markdown_table(heads: Sequence[str], body: Lines) -> str:
    """Return a Markdown table."""
    rows = [heads, ['---'] * len(heads), *body]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows) + '\n'
