"""Print a comparison on the terminal: the verdict, the alignment and the ranking."""

from typing import Final

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.comparison import ComparisonResult, find_rate_differences
from lta_data.compare.sentences import (
    describe_faults,
    describe_frames,
    describe_timing,
    format_decimal,
    format_quantity,
    format_rate,
    format_verdict,
)
from lta_report.report import TextTable
from lta_report.report_terminal import print_table
from rich.console import Console

ROWS: Final = 20
DASH: Final = '-'


def print_comparison(comparison: ComparisonResult, console: Console, rows: int = ROWS) -> None:
    """Print the summary sentences and, unless the flights are identical, the ranking."""
    lines = [format_verdict(comparison), f'Time: {describe_timing(comparison.timing)}']
    lines += [f'Frames of {each.topic}: {describe_frames(each)}' for each in comparison.frames]
    for label, only in (('A', comparison.only_a), ('B', comparison.only_b)):
        if only:
            lines.append(f'Topics only in {label}: {", ".join(only)}.')
    if comparison.identical_topics and not comparison.is_identical:
        lines.append(f'Topics identical byte for byte: {", ".join(comparison.identical_topics)}.')
    for label, faults in (('A', comparison.faults_a), ('B', comparison.faults_b)):
        for topic, each in faults.items():
            if not each.is_clean:
                lines.append(f'{label}, {topic}: {describe_faults(each)}.')
    rates = [
        f'{name} ({format_rate(a)} and {format_rate(b)})'
        for name, a, b in find_rate_differences(comparison)
    ]
    if rates:
        lines.append(f'Topics with different rates in A and B: {", ".join(rates)}.')
    lines += list(comparison.remarks)
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    if not comparison.is_identical:
        print_table(build_ranking(comparison, rows), console)


def build_ranking(comparison: ComparisonResult, rows: int) -> TextTable:
    """Return the table of channels, those that diverge most and earliest first."""
    count = len(comparison.channels)
    more = f' (first {rows} of {count})' if count > rows else ''
    lines = []
    for each in comparison.channels[:rows]:
        parts, bias, rms, _, nrmse, *_ = format_ranking_row(each)
        lines.append([each.name, parts, bias, rms, nrmse])
    heads = ('channel', 'diverges at', 'bias', 'RMS', 'NRMSE')
    return TextTable(f'Channels, the largest and earliest divergence first{more}', heads, lines)


def format_ranking_row(each: ChannelComparison) -> list[str]:
    """Return the cells of one channel in the ranking."""
    found, when = each.measures, each.parting
    if found is None:
        return ['no common data', *[DASH] * 7]
    parts = each.verdict if when.at is None else f'{when.at:.2f} s'
    low, high = (format_quantity(value, each.unit) for value in (found.rms_low, found.rms_high))
    return [
        parts,
        format_quantity(found.bias, each.unit),
        format_quantity(found.rms, each.unit),
        f'{low.split(" ")[0]} to {high.split(" ")[0]}',
        DASH if found.nrmse is None else f'{found.nrmse:.2g}',
        format_quantity(found.greatest, each.unit),
        f'{found.greatest_at:.2f} s',
        DASH if each.peak is None else f'{format_decimal(1e3 * each.peak.lag, 0)} ms',
    ]
