"""Plot channels on a terminal: sparklines, or curves in braille dots."""

from collections.abc import Iterable, Sequence
from typing import Final

from lta_data.bag.channels import SignalChannel
from lta_report.braille_canvas import BrailleCanvas
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from rich.text import Text

BLOCKS: Final = '▁▂▃▄▅▆▇█'
SPARK: Final = 32  # characters of a sparkline
FIGURES: Final = 36  # characters of unit, minimum and maximum with spaces
FEW: Final = 8  # least width of a sparkline if names are long
HEIGHT: Final = 10  # characters of a panel
MARGIN: Final = 12  # characters left of it
STYLES: Final = ('cyan', 'yellow', 'magenta', 'green', 'red', 'blue', 'white')


def format_number(value: float) -> str:
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
    found = []
    for part in np.array_split(values, min(width, len(values))):
        inside = part[np.isfinite(part)]
        share = (inside.mean() - low) / (high - low) if len(inside) else 0.0
        # share is 1.0 at the maximum, which would be a ninth block.
        # Eight heights of block characters
        found.append(BLOCKS[min(7, int(8 * share))] if len(inside) else ' ')
    return ''.join(found)


def build_channel_listing(channels: Iterable[SignalChannel], width: int) -> Table:
    """Return a table of all channels with range and sparkline, in `width` characters."""
    channels = list(channels)
    longest = max((len(channel.name) for channel in channels), default=0)
    # Keep names whole, so that users can copy them.
    spark = max(FEW, min(SPARK, width - longest - FIGURES))
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
            else (format_number(finite.min()), format_number(finite.max()))
        )
        table.add_row(channel.name, channel.unit, *ends, draw_sparkline(channel.values, spark))
    return table


def draw_curves(
    unit: str, channels: Sequence[SignalChannel], span: tuple[float, float], width: int
) -> Text:
    """Draw channels of one unit as curves over time, in `width` characters."""
    canvas = BrailleCanvas(max(8, width - MARGIN), HEIGHT)
    every = np.concatenate([channel.values for channel in channels])
    every = every[np.isfinite(every)]
    low, high = (float(every.min()), float(every.max())) if len(every) else (0.0, 1.0)
    for k, channel in enumerate(channels):
        draw_curve(canvas, channel, span, (low, high), STYLES[k % len(STYLES)])
    labels = {
        0: format_number(high),
        HEIGHT - 1: format_number(low),
        HEIGHT // 2: f'[{unit}]' if unit else '',
    }
    found = Text()
    for row, line in enumerate(canvas.render_lines()):
        found.append(f'{labels.get(row, ""):>{MARGIN - 2}} ', 'dim').append('│', 'dim')
        found.append_text(line).append('\n')
    ends = [f'{format_number(time)} s' for time in span]
    gap = canvas.width - sum(map(len, ends))
    found.append(f'{"":{MARGIN - 1}}└{ends[0]}{"─" * max(1, gap)}{ends[1]}\n', 'dim')
    for k, channel in enumerate(channels):
        found.append(f'{"":{MARGIN}}━━ ', STYLES[k % len(STYLES)]).append(f'{channel.name}\n')
    return found


def draw_curve(
    canvas: BrailleCanvas,
    channel: SignalChannel,
    span: tuple[float, float],
    ends: tuple[float, float],
    style: str,
) -> None:
    """Draw a curve: in each column of dots the whole range of its values."""
    known = np.isfinite(channel.values)
    time, values = channel.time[known], channel.values[known]
    length, height = span[1] - span[0], ends[1] - ends[0]
    # A braille character has two columns and four rows of dots.
    columns, rows = 2 * canvas.width, 4 * canvas.height
    across = np.floor((time - span[0]) / (length or 1.0) * (columns - 1)).astype(int)
    # A constant channel is drawn in the middle
    share = (values - ends[0]) / height if height else np.full(len(values), 0.5)
    # Rows count from the top
    down = np.round((1.0 - share) * (rows - 1)).astype(int)
    for column in np.unique(across):
        inside = down[across == column]
        for row in range(int(inside.min()), int(inside.max()) + 1):
            canvas.draw_dot(float(column), float(row), style)


def print_channels(
    panels: Iterable[tuple[str, list[SignalChannel]]], span: tuple[float, float], console: Console
) -> None:
    """Print each axis with its channels."""
    for unit, shown in panels:
        console.print(draw_curves(unit, shown, span, console.width), soft_wrap=True)
