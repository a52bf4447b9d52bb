"""Build the tables of the evaluation, for page, terminal and docs."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_report.formatting import MISSING
from lta_report.report import TextTable
from lta_report.result_table import format_share, format_value
from lta_studies.light.evaluation.cells import EvaluationCell, select_pilot_cells
from lta_studies.light.evaluation.flights import PILOT
from lta_studies.light.evaluation.sets import EvaluationAxis, find_flight_set

STRATEGY_LABELS: Final[Mapping[str, str]] = {
    'bag': 'BAG', 'dga': 'DGA', 'des': 'DES', 'homing': 'homing', PILOT: 'pilot',
}  # fmt: skip
FACTOR_LABELS: Final[Mapping[str, str]] = {
    'as_flown': 'as flown',
    'head': 'head wind',
    'cross': 'cross wind',
    'tail': 'tail wind',
    'light_wind': '0.22 m/s outside',
    'more_wind': '0.36 m/s outside',
    'start_heading': 'start heading within 30\N{DEGREE SIGN} of the lamp',
    'open_walls': 'no walls; flights that leave the room fail',
    'not_stopping': 'DGA does not stop to turn',
    'no_computing': 'DGA needs no computing time',
    'plane_through_origin': 'plane of DGA through the origin, as printed',
    'ideal_cosine': 'diodes with an ideal cosine response',
    'narrow_diodes': 'narrow diodes (cosine to the power of 4)',
    'small_swing': 'DES swings its nose by 0.5 rad',
    'gradient_alone': 'DES uses only the gradient',
    'scan_and_gradient': 'DES uses scan and gradient',
}


def label_strategy(name: str) -> str:
    """Return the label of a strategy."""
    return STRATEGY_LABELS.get(name, name)


def label_factor(name: str) -> str:
    """Return the label of a named case."""
    return FACTOR_LABELS.get(name, name.replace('_', ' ')) or MISSING


def label_case(cell: EvaluationCell, axis: EvaluationAxis | None) -> str:
    """Return the label of a cell's case: its name, or its value on the axis."""
    if axis is None or math.isnan(cell.place):
        return label_factor(cell.case)
    family = f'{label_factor(cell.family)}, ' if cell.family else ''
    return f'{family}{cell.place:,.6g} {axis.unit}'


SET_HEADS: Final = (
    'case', 'strategy', 'flights', 'reached', 'path [m]', 'time [s]', 'path / pilot',
)  # fmt: skip


def build_set_table(name: str, cells: Sequence[EvaluationCell]) -> TextTable:
    """Return the table of a set, with a row for each case and strategy."""
    part, best = find_flight_set(name), select_pilot_cells(cells)
    rows = [
        [
            label_case(cell, part.axis),
            label_strategy(cell.strategy),
            str(len(cell.rows)) + (f' (+{cell.failed} failed)' if cell.failed else ''),
            format_share(cell.reached_share),
            format_value(cell.mean('path_length'), 1),
            format_value(cell.mean('search_time'), 1),
            MISSING if cell.strategy == PILOT
            else format_value(cell.ratio_to(best.get(cell.case)), 2),
        ]
        for cell in cells
    ]  # fmt: skip
    return TextTable(part.title, SET_HEADS, rows, printed=False)
