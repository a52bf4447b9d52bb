"""Build the report of plotted channels, and write a PNG of its page."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import tempfile
from typing import Final

from lta_data.bag.channels import SignalChannel
from lta_report.drawing import create_figure, decimate_line, MOST_POINTS
from lta_report.formatting import format_number, Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TIME, TRUTH
from lta_report.report import Grid, Picture, Report
from lta_report.results_folder import write_file
from lta_report.screenshots import write_picture
import numpy as np
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = (TRUTH, ESTIMATE, GOOD, LAMP, TIME[0], SETPOINT, TIME[2])
LINE: Final = 20  # px per line of the legend
POINTS: Final = 20_000  # of all lines of a page, which keeps it under 2 MB
TILES: Final = 8
NAME: Final = 'channels'
LONGEST: Final = 100  # characters of a headline
Panels = Sequence[tuple[str, list[SignalChannel]]]


def plot_channels(
    unit: str,
    channels: Sequence[SignalChannel],
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
                line={'color': COLOURS[k % len(COLOURS)], 'width': 1.6},
                hovertemplate=f'%{{y:.4g}} {unit}',
            )
        )  # fmt: skip
    figure.update_yaxes(title_text=f'[{unit}]' if unit else '')
    figure.update_xaxes(range=list(span), hoverformat='.3f', unifiedhovertitle_text='%{x} s')
    figure.update_xaxes(title_text='time [s]')
    legend = {'orientation': 'h', 'x': 0, 'y': 1.0, 'yanchor': 'bottom', 'font': {'size': 11}}
    # About three entries per line of the legend, rounded up
    top = LINE * -(-len(channels) // 3) + 12
    return figure.update_layout(showlegend=True, legend=legend, margin={'t': top, 'r': 12})


def build_report(
    title: str, panels: Panels, span: tuple[float, float], facts: Mapping[str, str]
) -> Report:
    """Return the report, with a figure of each unit and a tile of each of the first channels."""
    every = [channel for _, channels in panels for channel in channels]
    most = min(MOST_POINTS, POINTS // max(len(every), 1))
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
        headline=title if len(title) <= LONGEST else f'{len(every)} channels of a recording',
        introduction=(
            'The recorded values. Angles are in degrees and unwrapped (no jumps at 360 degrees).'
        ),
        tiles=[build_tile(channel) for channel in every[:TILES]],
        blocks=[Grid(pictures, columns=1, name=NAME)],
        data={},
        facts=facts,
    )


def format_heading(channels: Sequence[SignalChannel]) -> str:
    """Return the topics of the channels."""
    return ', '.join(dict.fromkeys(channel.topic for channel in channels))


def build_tile(channel: SignalChannel) -> Tile:
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
        write_picture(page, shot, NAME)
        return write_file(shot.read_bytes(), out)
