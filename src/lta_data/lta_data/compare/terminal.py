"""A comparison for the terminal: the verdict, what was applied, and the ranking."""

from typing import Final

from lta_data.compare.apart import Apart
from lta_data.compare.comparison import Comparison, differing
from lta_data.compare.words import (
    amount,
    fault_words,
    frame_words,
    rate,
    signless,
    timing_words,
    verdict,
)
from rich.console import Console
from rich.table import Table

ROWS: Final = 20
DASH: Final = '-'


def show(found: Comparison, console: Console, rows: int = ROWS) -> None:
    """Print a comparison."""
    lines = [verdict(found), f'Time: {timing_words(found.timing)}']
    lines += [f'Frames of {each.topic}: {frame_words(each)}' for each in found.frames]
    for label, only in (('A', found.only_a), ('B', found.only_b)):
        if only:
            lines.append(f'Only in {label}: {", ".join(only)}.')
    if found.identical_topics and not found.identical:
        lines.append(f'Byte for byte the same: {", ".join(found.identical_topics)}.')
    for label, faults in (('A', found.faults_a), ('B', found.faults_b)):
        for topic, each in faults.items():
            if not each.clean:
                lines.append(f'{label}, {topic}: {fault_words(each)}.')
    rates = [f'{name} ({rate(a)} and {rate(b)})' for name, a, b in differing(found)]
    if rates:
        lines.append(f'Different rates in A and B: {", ".join(rates)}.')
    lines += list(found.remarks)
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    if not found.identical:
        console.print(ranking(found, rows))


def ranking(found: Comparison, rows: int) -> Table:
    """Return the channels that part most and earliest."""
    count = len(found.channels)
    more = f', the first {rows} of {count}' if count > rows else ''
    table = Table(
        title=f'Channels by how much and how early they part{more}', title_justify='left',
        box=None, pad_edge=False,
    )  # fmt: skip
    table.add_column('channel', overflow='fold')
    for head in ('parts at', 'bias', 'RMS', 'NRMSE'):
        table.add_column(head, justify='right', no_wrap=True)
    for each in found.channels[:rows]:
        parts, bias, rms, _, nrmse, *_ = cells(each)
        table.add_row(each.name, parts, bias, rms, nrmse)
    return table


def cells(each: Apart) -> list[str]:
    """Return a line of the ranking."""
    found, when = each.measures, each.parting
    if found is None:
        return ['never both', *[DASH] * 7]
    parts = each.verdict if when.at is None else f'{when.at:.2f} s'
    low, high = (amount(value, each.unit) for value in (found.rms_low, found.rms_high))
    return [
        parts,
        amount(found.bias, each.unit),
        amount(found.rms, each.unit),
        f'{low.split(" ")[0]} to {high.split(" ")[0]}',
        DASH if found.nrmse is None else f'{found.nrmse:.2g}',
        amount(found.greatest, each.unit),
        f'{found.greatest_at:.2f} s',
        DASH if each.peak is None else f'{signless(1e3 * each.peak.lag, 0)} ms',
    ]
