# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a comparison, with its tables."""

from pathlib import Path
from typing import Final

from lta_analysis.comparison import figures
from lta_analysis.comparison.figures import READOUT, render_comparison_scene
from lta_analysis.comparison.sentences import (
    BASIS,
    comparison_to_dict,
    describe_comparison,
    describe_frames,
    describe_timing,
    find_earliest_divergence,
    format_channel_name,
    format_decimal,
    format_offset,
    format_offset_and_interval,
    format_quantity,
    format_verdict,
    MISSING_DASH,
)
from lta_config.command_line import format_lta_command, relative_path
from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import (
    RoleChannel,
    select_headline_channels,
    select_panel_channels,
)
from lta_data.compare.comparison import ComparisonResult
from lta_report.flight_scene import render_time_bar
from lta_report.formatting import Tile
from lta_report.report import Grid, Picture, Report, TextTable
import numpy as np

RANKING_ROWS: Final = 20  # channels in the ranking
DASH: Final = '-'
HEADS: Final = (
    'channel', 'diverges at', 'bias', 'RMS', '95 % of RMS', 'NRMSE', 'maximum', 'at', 'lag',
)  # fmt: skip
LEGEND: Final = (
    "Times are on A's clock. NRMSE is the RMS difference divided by the standard deviation of A "
    'at the same times.'
)


def build_ranking(comparison: ComparisonResult) -> TextTable:
    """Return the table of channels, those that diverge most and earliest first."""
    count = len(comparison.channels)
    more = f' (first {RANKING_ROWS} of {count})' if count > RANKING_ROWS else ''
    rows = []
    for each in comparison.channels[:RANKING_ROWS]:
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
        DASH if each.lag is None else f'{format_decimal(1e3 * each.lag.lag, 0)} ms',
    ]


def build_channel_table(comparison: ComparisonResult) -> TextTable:
    """Return the table of all channels."""
    rows = [[each.name, *format_ranking_row(each)] for each in comparison.channels]
    return TextTable('All channels', HEADS, rows, printed=False)


def list_alignment_lines(comparison: ComparisonResult) -> list[str]:
    """Return what the terminal says about the alignment, and about topics of one flight."""
    lines = [f'Time: {describe_timing(comparison.timing)}']
    lines += [f'Frames of {each.topic}: {describe_frames(each)}' for each in comparison.frames]
    for label, only in (('A', comparison.only_a), ('B', comparison.only_b)):
        if only:
            lines.append(f'Topics only in {label}: {", ".join(only)}.')
    if comparison.identical_topics and not comparison.is_identical:
        lines.append(f'Topics identical in every value: {", ".join(comparison.identical_topics)}.')
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


FIGURE_HEIGHT: Final = 330  # of a figure [px]
COMPARED_COLOURS: Final = (
    'Blue: A, orange: B, grey: B - A. Shaded: the noise band or the tolerance. Gaps are not '
    'bridged.'
)
ABOVE: Final = "Both paths from above, in A's frame. Open circle: start. Filled circle: end."


def build_report(comparison: ComparisonResult) -> Report:
    """Return the report of a comparison."""
    time = find_total_span(comparison)
    scene, track = render_comparison_scene(comparison, time)
    return Report(
        command='compare',
        subject=f'A {shorten_path(comparison.a.path)} · B {shorten_path(comparison.b.path)}',
        headline=format_verdict(comparison),
        introduction=f'{describe_comparison(comparison)} {COMPARED_COLOURS}',
        tiles=build_tiles(comparison),
        blocks=[
            build_ranking(comparison),
            Grid(
                [
                    *build_path_picture(comparison),
                    *(
                        build_panel(each, time)
                        for each in select_panel_channels(comparison.channels)
                    ),
                ]
            ),
            build_channel_table(comparison),
            build_alignment_table(comparison),
        ],
        data=comparison_to_dict(comparison),
        facts=describe_sources(comparison),
        commands=suggest_commands(comparison),
        closing=list_alignment_lines(comparison),
        scene=scene,
        time_bar=render_time_bar(READOUT, 'flights') if scene else '',
        track=track,
    )


def find_total_span(comparison: ComparisonResult) -> tuple[float, float]:
    """Return the time that either flight covers, on A's clock [s]."""
    ends = np.array(
        [*comparison.a.span, *comparison.timing.convert_to_a_time(np.array(comparison.b.span))]
    )
    return float(ends.min()), float(ends.max())


def shorten_path(path: str) -> str:
    """Return a short name of a bag: its folder's name, or that of the folder above `bag`."""
    bag_path = Path(path)
    return (
        bag_path.parent.name if bag_path.name == 'bag' and bag_path.parent.name else bag_path.stem
    )


def format_title(entry: RoleChannel) -> str:
    """Return the heading of a panel."""
    if entry.among == 1:
        return entry.role.title
    field = entry.channel.name.rpartition('/')[2]
    return f'{entry.role.title}: {field}, which diverges most of {entry.among} channels'


def summarize_channel(each: ChannelComparison) -> str:
    """Return one sentence on a channel's difference."""
    measures, when = each.measures, each.parting
    if each.verdict == 'identical':
        return 'Identical.'
    if measures is None:
        return 'No common data.'
    rms = f'RMS difference {format_quantity(measures.rms, each.unit)}'
    share = '' if measures.nrmse is None else f", {measures.nrmse:.2g} of A's standard deviation"
    parts = 'No divergence' if when.at is None else f'A and B diverge at {when.at:.2f} s'
    if when.at is None and each.verdict == 'apart at times':
        parts = f'A and B differ at times ({100.0 * when.outside:.0f} % of the samples)'
    return f'{parts}; {rms}{share}.'


def build_tiles(comparison: ComparisonResult) -> list[Tile]:
    """Return the tiles with the main results."""
    timing, (begin, end) = comparison.timing, comparison.span
    parted = [each for each in comparison.channels if each.verdict == 'parted']
    moving = [
        each
        for each in select_headline_channels(comparison.channels)
        if each.parting.at is not None
    ] or parted
    offset, doubt, unit = format_offset_and_interval(timing)
    doubt = f'± {doubt} {unit}; ' if doubt else ''
    how = {
        'clock': 'estimated from channels of both flights',
        'motion': 'estimated from the start of the motion',
        'given': 'set by hand',
        'none': 'time stamps unchanged' if timing.on_stamps else 'both flights start at 0 s',
    }[timing.how]  # fmt: skip
    tiles = [
        Tile("Offset of B's clock", offset, unit, f'{doubt}{how}'),
        Tile('Common time', f'{end - begin:.1f}', 's', f"{begin:.1f} to {end:.1f} s on A's clock"),
        Tile(
            'Diverging channels', str(len(parted)), f'of {len(comparison.channels)}',
            f'{sum(each.verdict == "identical" for each in comparison.channels)} identical',
        ),
    ]  # fmt: skip
    if moving:
        # The channels are sorted by score, so the first is the worst.
        first, worst = find_earliest_divergence(moving), moving[0]
        tiles.append(
            Tile('First divergence', f'{first.parting.at:.2f}', 's', format_channel_name(first))
        )
        rms = worst.measures
        share = MISSING_DASH if rms is None or rms.nrmse is None else f'{rms.nrmse:.2g}'
        tiles.append(
            Tile('NRMSE of the largest divergence', share, '', format_channel_name(worst))
        )
    else:
        tiles.append(Tile('First divergence', MISSING_DASH, '', 'no channel diverges'))
    return tiles


def build_path_picture(comparison: ComparisonResult) -> list[Picture]:
    """Return the path seen from above, if there is one."""
    above = figures.plot_path(comparison.channels)
    return [] if above is None else [Picture('path', 'From above', ABOVE, above, FIGURE_HEIGHT)]


def build_panel(entry: RoleChannel, time: tuple[float, float]) -> Picture:
    """Return the overlay of a channel of both flights."""
    about = f'{entry.channel.name}. {summarize_channel(entry.channel)}'
    figure = figures.plot_overlay(entry.channel, time)
    return Picture(entry.role.name, format_title(entry), about, figure, FIGURE_HEIGHT, timed=True)


def describe_sources(comparison: ComparisonResult) -> dict[str, str]:
    """Return the origin of both flights."""
    terms = {}
    for label, side, only in (
        ('A', comparison.a, comparison.only_a),
        ('B', comparison.b, comparison.only_b),
    ):
        begin, end = side.span
        terms[label] = str(relative_path(Path(side.path)))
        terms[f'{label}, length'] = f'{end - begin:.2f} s'
        if side.robot:
            terms[f'{label}, robot'] = side.robot
        if only:
            terms[f'only in {label}'] = ', '.join(only)
    terms['identical in every value'] = ', '.join(comparison.identical_topics) or 'no topic'
    return terms


def suggest_commands(comparison: ComparisonResult) -> dict[str, str]:
    """Return commands for further analysis."""
    a, b = relative_path(Path(comparison.a.path)), relative_path(Path(comparison.b.path))
    return {
        'Compare in a script: exit status 1 if they differ': format_lta_command(
            'compare', a, b, '--same'
        ),
        'Look at A': format_lta_command('report', a),
        'Look for gaps and other faults': format_lta_command('bag check', a, b),
    }
