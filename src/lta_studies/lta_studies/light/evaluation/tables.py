"""The figures of the evaluation as lines of text: for the page, and for the docs."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_report.formatting import MISSING, number
from lta_studies.light.evaluation import paper, pilot, words
from lta_studies.light.evaluation.cells import Cell, pilots
from lta_studies.light.evaluation.order import Found
from lta_studies.light.evaluation.sets import flight_set, INDOORS
from lta_studies.light.evaluation.wind import ALLOWED

HEADS: Final = ('case', 'strategy', 'flights', 'reached', 'path [m]', 'time [s]', 'path / pilot')
PAPER_HEADS: Final = ('strategy', 'path here [m]', 'paper', 'time here [s]', 'paper')
OUTDOOR_HEADS: Final = ('wind at 10 m', 'strategy', 'reached here', 'paper')
ORDER_HEADS: Final = ('changed', *map(words.strategy, paper.ORDER), 'order of the paper', 'draws')
TARGET_HEADS: Final = ('case', 'reached', 'at least', 'path / pilot', 'at most', 'met')
SHARE_WANTED: Final = 0.95
RATIO_WANTED: Final = 1.1

Lines = list[list[str]]


def lines(name: str, cells: Sequence[Cell]) -> Lines:
    """Return a line for each case and strategy of a set."""
    axis, best = flight_set(name).axis, pilots(cells)
    return [
        [
            words.case(cell, axis),
            words.strategy(cell.strategy),
            str(len(cell.rows)) + (f' (+{cell.failed} failed)' if cell.failed else ''),
            words.share(cell.reached),
            words.amount(cell.mean('path_length')),
            words.amount(cell.mean('search_time')),
            MISSING if cell.strategy == pilot.NAME
            else words.amount(cell.against(best.get(cell.case)), 2),
        ]
        for cell in cells
    ]  # fmt: skip


def beside_paper(cells: Sequence[Cell]) -> Lines:
    """Return the indoor flights beside the paper's."""
    own = {cell.strategy: cell for cell in cells}
    return [
        [
            words.strategy(name),
            words.amount(own[name].mean('path_length')), f'{flown.path:g}',
            words.amount(own[name].mean('search_time')), number(flown.time, 1),
        ]
        for name, flown in paper.INDOORS.items()
        if name in own
    ]  # fmt: skip


def outdoors(cells: Sequence[Cell]) -> Lines:
    """Return who reached the lamp against the paper's winds, here and there."""
    return [
        [
            f'{cell.place:g} m/s',
            words.strategy(cell.strategy),
            words.share(cell.reached),
            'reached' if cell.strategy in paper.OUTDOORS[cell.place] else 'failed',
        ]
        for cell in cells
        if cell.place in paper.OUTDOORS and cell.strategy in paper.ORDER
    ]


def order_lines(found: Sequence[Found]) -> Lines:
    """Return how paths are ordered in each case of the ablations."""
    return [
        [
            words.factor(each.case),
            *(words.amount(each.paths[name]) for name in paper.ORDER),
            'yes' if each.sure else 'not beyond chance' if each.holds else 'no',
            MISSING if math.isnan(each.share) else f'{100 * each.share:.0f} %',
        ]
        for each in found
    ]


def targets(found: Mapping[str, Sequence[Cell]], ours: str) -> Lines:
    """Return whether our strategy reaches what was asked of it, in each piloted case."""
    made = []
    for name, cells in found.items():
        part, best = flight_set(name), pilots(cells)
        for cell in cells:
            if cell.strategy != ours or not part.piloted or cell.wind > ALLOWED:
                continue
            reached, ratio = cell.reached, cell.against(best.get(cell.case))
            met = reached.value >= SHARE_WANTED and ratio.value <= RATIO_WANTED
            title = (
                part.title if name == INDOORS else f'{part.title}: {words.case(cell, part.axis)}'
            )
            made.append(
                [
                    title, words.share(reached), f'{100 * SHARE_WANTED:.0f} %',
                    words.amount(ratio, 2), f'{RATIO_WANTED:g}', 'yes' if met else 'no',
                ]
            )  # fmt: skip
    return made


def markdown(heads: Sequence[str], body: Lines) -> str:
    """Return a table of Markdown."""
    rows = [heads, ['---'] * len(heads), *body]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows) + '\n'
