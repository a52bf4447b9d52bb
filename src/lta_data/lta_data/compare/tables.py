"""The tables of a comparison's page: channels, and what is wrong with the data."""

from html import escape
from typing import Final

from lta_data.compare.apart import Apart
from lta_data.compare.comparison import Comparison, differing
from lta_data.compare.terminal import cells
from lta_data.compare.words import fault_words, rate

HEADS: Final = (
    'channel', 'parts at', 'bias', 'RMS', '95 % of RMS', 'NRMSE', 'most', 'at', 'lag',
)  # fmt: skip


def pickable(each: Apart) -> bool:
    """Tell whether a channel is worth a picture."""
    return each.measures is not None and not each.still


def short_row(each: Apart) -> str:
    """Return a line of the short ranking."""
    parts, _, rms, _, nrmse, *_ = cells(each)
    own = ''.join(f'<td>{escape(cell)}</td>' for cell in (parts, rms, nrmse))
    return f'<tr><th scope="row">{pick(each)}</th>{own}</tr>'


def pick(each: Apart) -> str:
    """Return a channel's name as a button that shows it, where it can be shown."""
    name = escape(each.name)
    if not pickable(each):
        return name
    shown = name.replace('/', '/<wbr>').replace('.', '.<wbr>')
    return f'<button type="button" class="pick" data-channel="{name}">{shown}</button>'


def channel_table(found: Comparison) -> str:
    """Return all channels."""
    heads = ''.join(f'<th scope="col">{head}</th>' for head in HEADS)
    rows = ''.join(
        f'<tr><th scope="row">{pick(each)}</th>'
        + ''.join(f'<td>{escape(cell)}</td>' for cell in cells(each))
        + '</tr>'
        for each in found.channels
    )
    return (
        '<table><caption class="hidden">All channels</caption>'
        f'<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>'
    )


def fault_table(found: Comparison) -> str:
    """Return what is wrong with the data, and which topics differ in rate."""
    rows = []
    for label, faults in (('A', found.faults_a), ('B', found.faults_b)):
        for topic, each in faults.items():
            if not each.clean:
                rows.append((label, topic, rate(each), fault_words(each)))
    for topic, each, other in differing(found):
        rows.append(('A, B', topic, f'{rate(each)}, {rate(other)}', 'different rates'))
    if not rows:
        return '<p class="note">No gap, duplicate, lost value or backward step of time.</p>'
    heads = ''.join(f'<th scope="col">{head}</th>' for head in ('flight', 'topic', 'rate', 'what'))
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(cell)}</td>" for cell in row)}</tr>' for row in rows
    )
    return (
        '<table class="faults"><caption class="hidden">Faults of the data</caption>'
        f'<thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>'
    )
