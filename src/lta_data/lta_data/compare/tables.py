"""Render the tables of the comparison page: channels and data faults."""

from html import escape
from typing import Final

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.comparison import ComparisonResult, find_rate_differences
from lta_data.compare.sentences import describe_faults, format_rate
from lta_data.compare.terminal import format_ranking_row

HEADS: Final = (
    'channel', 'diverges at', 'bias', 'RMS', '95 % of RMS', 'NRMSE', 'maximum', 'at', 'lag',
)  # fmt: skip


def is_worth_plotting(each: ChannelComparison) -> bool:
    """Return whether a channel is worth plotting."""
    return each.measures is not None and not each.both_constant


def format_short_row(each: ChannelComparison) -> str:
    """Return one row of the short ranking."""
    parts, _, rms, _, nrmse, *_ = format_ranking_row(each)
    own = ''.join(f'<td>{escape(cell)}</td>' for cell in (parts, rms, nrmse))
    return f'<tr><th scope="row">{format_pick_button(each)}</th>{own}</tr>'


def format_pick_button(each: ChannelComparison) -> str:
    """Return a channel's name, as a button if the channel can be plotted."""
    name = escape(each.name)
    if not is_worth_plotting(each):
        return name
    # <wbr> lets a long name break after a slash or dot
    shown = name.replace('/', '/<wbr>').replace('.', '.<wbr>')
    return f'<button type="button" class="pick" data-channel="{name}">{shown}</button>'


def format_channel_table(comparison: ComparisonResult) -> str:
    """Return the table of all channels."""
    heads = ''.join(f'<th scope="col">{head}</th>' for head in HEADS)
    rows = ''.join(
        f'<tr><th scope="row">{format_pick_button(each)}</th>'
        + ''.join(f'<td>{escape(cell)}</td>' for cell in format_ranking_row(each))
        + '</tr>'
        for each in comparison.channels
    )
    return (
        '<table><caption class="hidden">All channels</caption>'
        f'<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>'
    )


def format_fault_table(comparison: ComparisonResult) -> str:
    """Return the table of data faults and of topics with different rates."""
    rows = []
    for label, faults in (('A', comparison.faults_a), ('B', comparison.faults_b)):
        for topic, each in faults.items():
            if not each.is_clean:
                rows.append((label, topic, format_rate(each), describe_faults(each)))
    for topic, each, other in find_rate_differences(comparison):
        rows.append(
            ('A, B', topic, f'{format_rate(each)}, {format_rate(other)}', 'different rates')
        )
    if not rows:
        return '<p class="note">No gaps, duplicates, missing values or backward steps of time.</p>'
    heads = ''.join(
        f'<th scope="col">{head}</th>' for head in ('flight', 'topic', 'rate', 'fault')
    )
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(cell)}</td>" for cell in row)}</tr>' for row in rows
    )
    return (
        '<table class="faults"><caption class="hidden">Faults of the data</caption>'
        f'<thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>'
    )
