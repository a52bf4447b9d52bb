# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build the report of plotted channels, and write a PNG of its page.

A list has sparklines, a plot has curves in braille dots by plotext.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from itertools import cycle
from pathlib import Path
import tempfile
from typing import Final

from lta_config.constants import RADIANS_PER_DEGREE
from lta_config.errors import BadInput
from lta_data.bag.channels import iterate_channels, read_flight
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.flight import Channel
from lta_report.drawing import create_figure, decimate_line, MOST_POINTS
from lta_report.formatting import format_number, Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TIME, TRUTH
from lta_report.report import Grid, Picture, Report
from lta_report.results_folder import write_file
from lta_report.screenshots import write_picture
import numpy as np
from numpy.typing import NDArray
import plotext
from plotly.graph_objects import Figure, Scatter
from rich.color import Color
from rich.console import Console
from rich.table import Table
from rich.text import Text

MAX_PLOT_LINES: Final = 24  # lines in one plot, at most
SUGGESTED_NAMES: Final = 4  # names suggested for an unknown one


def select_channels(flight: RecordedFlight, patterns: Sequence[str]) -> list[Channel]:
    """
    Return the channels that match the patterns, in the order of the patterns.

    A pattern is a channel ('odom/pose.pose.position.z'), a topic ('motors'), or either with `*`.
    Only matching topics are decoded.

    Raise `BadInput` if a pattern matches nothing, or all together match too many channels for one
    plot.
    """
    channels: dict[str, Channel] = {}
    for pattern in patterns:
        meant = [
            channel
            for topic in flight.topics
            # Read only topics that can match: a bag may be large
            if can_match(pattern, topic)
            for channel in iterate_channels(flight, topic)
            if matches_channel(pattern, channel)
        ]
        if not meant:
            raise no_match_error(flight, pattern)
        channels |= {channel.name: channel for channel in meant}
    if len(channels) > MAX_PLOT_LINES:
        raise BadInput(
            f'{len(channels)} channels are too many for one plot (at most {MAX_PLOT_LINES}); '
            f"name fewer, such as '{next(iter(channels))}'."
        )
    return list(channels.values())


def can_match(pattern: str, topic: str) -> bool:
    """Return whether a channel of a topic can match a pattern."""
    return fnmatchcase(topic, pattern) or fnmatchcase(topic, pattern.rpartition('/')[0])


def matches_channel(pattern: str, channel: Channel) -> bool:
    """Return whether a pattern matches a channel or its topic."""
    # fnmatch takes [0] as a character class; here it is an array index.
    escaped = pattern.replace('[', '[[]')
    return fnmatchcase(channel.topic, pattern) or fnmatchcase(channel.name, escaped)


def no_match_error(flight: RecordedFlight, pattern: str) -> BadInput:
    """Return the error for a pattern without a match, with similar names."""
    names = [*flight.topics, *read_flight(flight).channels]
    # 0.4: least similarity, low enough for abbreviations
    near = (
        get_close_matches(pattern, names, SUGGESTED_NAMES, 0.4) or flight.topics[:SUGGESTED_NAMES]
    )
    return BadInput(
        f"No channel matches '{pattern}'; similar: {', '.join(near)}. To list all channels, give "
        'no channel.'
    )


def unwrap_to_degrees(channel: Channel) -> Channel:
    """Return an angle in degrees and unwrapped; any other channel unchanged."""
    if not channel.angular:
        return channel
    # The flight caches its arrays; do not change them
    values = channel.values.copy()
    finite = np.isfinite(values)
    values[finite] = np.unwrap(values[finite])
    return replace(channel, unit='deg', values=values / RADIANS_PER_DEGREE)


def crop_channel(channel: Channel, begin: float, end: float) -> Channel:
    """Return the part of a channel in a closed time interval [s]."""
    inside = (channel.time >= begin) & (channel.time <= end)
    return replace(channel, time=channel.time[inside], values=channel.values[inside])


def group_by_unit(channels: Sequence[Channel]) -> Iterator[tuple[str, list[Channel]]]:
    """Yield unit and channels of each axis; channels of one unit share an axis."""
    for unit in dict.fromkeys(channel.unit for channel in channels):
        yield unit, [channel for channel in channels if channel.unit == unit]


SPARK_BLOCKS: Final = '▁▂▃▄▅▆▇█'
SPARK: Final = 32  # characters of a sparkline
FIGURE_CHARACTERS: Final = 36  # characters of unit, minimum and maximum with spaces
NARROWEST_SPARK: Final = 8  # least width of a sparkline if names are long
PANEL_CHARACTERS: Final = 14  # characters of a panel with its axes
LARGEST_PLOTTED: Final = 1e37  # of a value; larger ones overflow 32 bits
LINE_STYLES: Final = ('cyan', 'yellow', 'magenta', 'green', 'red', 'blue', 'white')

Array = NDArray[np.float64]


def format_extreme(value: float) -> str:
    """Format a number in few characters."""
    return f'{value:.4g}' if np.isfinite(value) else ''


def draw_sparkline(values: NDArray[np.float64], width: int = SPARK) -> str:
    """
    Draw means of even stretches as blocks of eight heights, or a word for a constant signal.

    Stretches without finite values are blank.
    """
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 'no value'
    low, high = float(finite.min()), float(finite.max())
    if low == high:
        return 'constant'
    levels = []
    for part in np.array_split(values, min(width, len(values))):
        inside = part[np.isfinite(part)]
        share = (inside.mean() - low) / (high - low) if len(inside) else 0.0
        # share is 1.0 at the maximum, which would be a ninth block.
        # Eight heights of block characters
        levels.append(SPARK_BLOCKS[min(7, int(8 * share))] if len(inside) else ' ')
    return ''.join(levels)


def build_channel_listing(channels: Iterable[Channel], width: int) -> Table:
    """Return a table of all channels with range and sparkline, in `width` characters."""
    channels = list(channels)
    longest = max((len(channel.name) for channel in channels), default=0)
    # Keep names whole, so that users can copy them.
    spark = max(NARROWEST_SPARK, min(SPARK, width - longest - FIGURE_CHARACTERS))
    table = Table(box=None, pad_edge=False)
    table.add_column('channel', overflow='fold')
    for name in ('unit', 'min', 'max'):
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('over time', no_wrap=True)
    for channel in channels:
        finite = channel.values[np.isfinite(channel.values)]
        ends = (
            ('', '')
            if not len(finite)
            else (format_extreme(finite.min()), format_extreme(finite.max()))
        )
        table.add_row(channel.name, channel.unit, *ends, draw_sparkline(channel.values, spark))
    return table


def draw_curves(
    unit: str, channels: Sequence[Channel], span: tuple[float, float], width: int
) -> Text:
    """Draw channels of one unit as curves over time, in `width` characters."""
    plotext.terminal.limit(False, False)  # `width` holds, also in a pipe
    figure = plotext.figure.clear()
    figure.theme('colorless')
    figure.plot_size(width, PANEL_CHARACTERS)
    if span[0] < span[1]:
        figure.ruler('x').lim(*span)
    legend = Text()
    for channel, style in zip(channels, cycle(LINE_STYLES)):
        for time, values in split_at_gaps(channel):
            marker = plotext.marker('braille', Color.parse(style).number)
            signal = figure.signal(time.tolist(), values.tolist(), marker=marker)
            signal.lines()
            figure.draw(signal)
        legend.append('━━ ', style).append(f'{channel.name}\n')
    figure.label('time [s]', axis='x').label(f'[{unit}]' if unit else '', axis='y')
    return Text.from_ansi(str(figure.build())).append_text(legend)


def split_at_gaps(channel: Channel) -> Iterator[tuple[Array, Array]]:
    """Yield time and values of each stretch without a gap, as few points that look the same."""
    # NaN or infinity would end the process in plotext
    finite = np.flatnonzero(np.abs(channel.values) < LARGEST_PLOTTED)
    for part in np.split(finite, np.flatnonzero(np.diff(finite) > 1) + 1):
        yield decimate_line(channel.time[part], channel.values[part])


def print_channels(
    panels: Iterable[tuple[str, list[Channel]]], span: tuple[float, float], console: Console
) -> None:
    """Print each axis with its channels."""
    for unit, channels in panels:
        console.print(draw_curves(unit, channels, span, console.width), soft_wrap=True)


LINE_COLOURS: Final = (TRUTH, ESTIMATE, GOOD, LAMP, TIME[0], SETPOINT, TIME[2])
LEGEND_LINE: Final = 20  # px per line of the legend
PAGE_POINTS: Final = 20_000  # of all lines of a page, which keeps it under 2 MB
MAX_TILES: Final = 8
PICTURE_NAME: Final = 'channels'
HEADLINE_CHARACTERS: Final = 100  # characters of a headline
Panels = Sequence[tuple[str, list[Channel]]]


def plot_channels(
    unit: str,
    channels: Sequence[Channel],
    span: tuple[float, float],
    most: int = MOST_POINTS,
) -> Figure:
    """Plot channels of one unit over time, with at most so many points each."""
    figure = create_figure()
    for k, channel in enumerate(channels):
        time, values = decimate_line(channel.time, channel.values, most)
        figure.add_trace(
            Scatter(
                x=time, y=values, name=channel.name, mode='lines',
                line={'color': LINE_COLOURS[k % len(LINE_COLOURS)], 'width': 1.6},
                hovertemplate=f'%{{y:.4g}} {unit}',
            )
        )  # fmt: skip
    figure.update_yaxes(title_text=f'[{unit}]' if unit else '')
    figure.update_xaxes(range=list(span), hoverformat='.3f', unifiedhovertitle_text='%{x} s')
    figure.update_xaxes(title_text='time [s]')
    legend = {'orientation': 'h', 'x': 0, 'y': 1.0, 'yanchor': 'bottom', 'font': {'size': 11}}
    # About three entries per line of the legend, rounded up
    top = LEGEND_LINE * -(-len(channels) // 3) + 12
    return figure.update_layout(showlegend=True, legend=legend, margin={'t': top, 'r': 12})


def build_report(
    title: str, panels: Panels, span: tuple[float, float], facts: Mapping[str, str]
) -> Report:
    """Return the report, with a figure of each unit and a tile of each of the first channels."""
    every = [channel for _, channels in panels for channel in channels]
    most = min(MOST_POINTS, PAGE_POINTS // max(len(every), 1))
    pictures = [
        Picture(
            f'unit-{k}', format_heading(channels), '', plot_channels(unit, channels, span, most),
            height=300, timed=True,
        )
        for k, (unit, channels) in enumerate(panels)
    ]  # fmt: skip
    ends = f'{format_number(span[0], 1)} to {format_number(span[1], 1)} s'
    return Report(
        command='bag plot',
        subject=f'{len(every)} channels, {ends}',
        headline=title
        if len(title) <= HEADLINE_CHARACTERS
        else f'{len(every)} channels of a recording',
        introduction=(
            'The recorded values. Angles are in degrees and unwrapped (no jumps at 360 degrees).'
        ),
        tiles=[build_tile(channel) for channel in every[:MAX_TILES]],
        blocks=[Grid(pictures, columns=1, name=PICTURE_NAME)],
        data={},
        facts=facts,
    )


def format_heading(channels: Sequence[Channel]) -> str:
    """Return the topics of the channels."""
    return ', '.join(dict.fromkeys(channel.topic for channel in channels))


def build_tile(channel: Channel) -> Tile:
    """Return a tile with the mean and range of a channel."""
    finite = channel.values[np.isfinite(channel.values)]
    if not len(finite):
        return Tile(channel.name, format_number(None), channel.unit, 'no value')
    ends = f'{finite.min():.4g} to {finite.max():.4g}'
    return Tile(channel.name, f'{finite.mean():.4g}', channel.unit, f'mean; {ends}')


def write_png(text: str, out: Path) -> Path:
    """Write the page's plot as PNG; raise `BadInput` without a browser or a writable path."""
    # The picture is a screenshot of the page, which must be a file first
    with tempfile.TemporaryDirectory() as folder:
        page = write_file(text, Path(folder) / 'plot.html')
        shot = Path(folder) / 'plot.png'
        write_picture(page, shot, PICTURE_NAME)
        return write_file(shot.read_bytes(), out)
