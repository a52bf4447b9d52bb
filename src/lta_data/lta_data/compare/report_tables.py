"""Build the tables of a comparison: ranking, channels, alignment and faults of the data."""

from typing import Final

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.comparison import ComparisonResult, find_rate_differences
from lta_data.compare.sentences import (
    BASIS,
    describe_faults,
    describe_frames,
    describe_timing,
    format_decimal,
    format_offset,
    format_quantity,
    format_rate,
)
from lta_report.report import TextTable

ROWS: Final = 20  # channels in the ranking
DASH: Final = '-'
HEADS: Final = (
    'channel', 'diverges at', 'bias', 'RMS', '95 % of RMS', 'NRMSE', 'maximum', 'at', 'lag',
)  # fmt: skip
LEGEND: Final = (
    "Times are on A's clock. NRMSE is the RMS difference divided by the standard deviation of A "
    'at the same times.'
)
NO_FAULTS: Final = 'No gaps, duplicates, missing values or backward steps of time.'


def build_ranking(comparison: ComparisonResult) -> TextTable:
    """Return the table of channels, those that diverge most and earliest first."""
    count = len(comparison.channels)
    more = f' (first {ROWS} of {count})' if count > ROWS else ''
    rows = []
    for each in comparison.channels[:ROWS]:
        parts, bias, rms, _, nrmse, *_ = format_ranking_row(each)
        rows.append([each.name, parts, bias, rms, nrmse])
    heads = ('channel', 'diverges at', 'bias', 'RMS', 'NRMSE')
    heading = f'Channels, the largest and earliest divergence first{more}'
    differs = not comparison.is_identical
    return TextTable(heading, heads, rows, LEGEND, printed=differs)


def format_ranking_row(each: ChannelComparison) -> list[str]:
    """Return the cells of one channel in the ranking."""
    measures, when = each.measures, each.parting
    if measures is None:
        return ['no common data', *[DASH] * 7]
    parts = each.verdict if when.at is None else f'{when.at:.2f} s'
    low, high = (
        format_quantity(value, each.unit) for value in (measures.rms_low, measures.rms_high)
    )
    return [
        parts,
        format_quantity(measures.bias, each.unit),
        format_quantity(measures.rms, each.unit),
        f'{low.split(" ")[0]} to {high.split(" ")[0]}',
        DASH if measures.nrmse is None else f'{measures.nrmse:.2g}',
        format_quantity(measures.greatest, each.unit),
        f'{measures.greatest_at:.2f} s',
        DASH if each.peak is None else f'{format_decimal(1e3 * each.peak.lag, 0)} ms',
    ]


def build_channel_table(comparison: ComparisonResult) -> TextTable:
    """Return the table of all channels."""
    rows = [[each.name, *format_ranking_row(each)] for each in comparison.channels]
    return TextTable('All channels', HEADS, rows, printed=False)


def list_faults(comparison: ComparisonResult) -> list[tuple[str, str, str, str]]:
    """Return flight, topic, rate and fault of all topics with faults."""
    return [
        (label, topic, format_rate(each), describe_faults(each))
        for label, faults in (('A', comparison.faults_a), ('B', comparison.faults_b))
        for topic, each in faults.items()
        if not each.is_clean
    ]


def build_fault_table(comparison: ComparisonResult) -> TextTable:
    """Return the table of data faults and of topics with different rates."""
    rows = list_faults(comparison)
    for topic, each, other in find_rate_differences(comparison):
        rates = f'{format_rate(each)}, {format_rate(other)}'
        rows.append(('A, B', topic, rates, 'different rates'))
    note = '' if rows else NO_FAULTS
    heads = ('flight', 'topic', 'rate', 'fault')
    return TextTable('Faults of the data', heads, rows, note, printed=False)


def list_alignment_lines(comparison: ComparisonResult) -> list[str]:
    """Return what the terminal says about the alignment, and about topics that need a look."""
    lines = [f'Time: {describe_timing(comparison.timing)}']
    lines += [f'Frames of {each.topic}: {describe_frames(each)}' for each in comparison.frames]
    for label, only in (('A', comparison.only_a), ('B', comparison.only_b)):
        if only:
            lines.append(f'Topics only in {label}: {", ".join(only)}.')
    if comparison.identical_topics and not comparison.is_identical:
        lines.append(f'Topics identical in every value: {", ".join(comparison.identical_topics)}.')
    lines += [f'{label}, {topic}: {fault}.' for label, topic, _, fault in list_faults(comparison)]
    rates = [
        f'{name} ({format_rate(a)} and {format_rate(b)})'
        for name, a, b in find_rate_differences(comparison)
    ]
    if rates:
        lines.append(f'Topics with different rates in A and B: {", ".join(rates)}.')
    return [*lines, *comparison.remarks]


def build_alignment_table(comparison: ComparisonResult) -> TextTable:
    """Return how time and frames were aligned."""
    timing = comparison.timing
    terms = {'time': timing.reason}
    if timing.how != 'none':
        terms['offset'] = f"B's time {format_offset(timing)}"
        terms['estimated from'] = ', '.join(timing.used) or 'the given value'
    # An infinite deviation means that the drift was not estimated
    if timing.estimated_offset is not None and timing.estimated_offset.drift_sigma < 1.0:
        low, high = (
            # 1.96 standard deviations: 95 % of a normal distribution
            BASIS
            * (timing.estimated_offset.drift + s * 1.96 * timing.estimated_offset.drift_sigma)
            for s in (-1, 1)
        )
        what = 'applied' if timing.drift else 'not applied'
        terms["drift of B's clock"] = f'{low:+.0f} to {high:+.0f} ppm (95 % confidence); {what}'
    terms['reference of offsets'] = (
        'the time stamps of both flights'
        if timing.on_stamps
        else 'time since the start of each flight, because the time stamps do not overlap'
    )
    for each in comparison.frames:
        terms[f'{each.topic}'] = describe_frames(each)
    return TextTable(
        'Alignment of time and frames', ('quantity', 'value'), list(terms.items()),
        ' '.join(comparison.remarks), printed=False,
    )  # fmt: skip
