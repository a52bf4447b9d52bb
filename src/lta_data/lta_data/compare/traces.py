"""Reduce lines to what a screen can show, keeping extremes and gaps."""

from base64 import b64encode
import math
from typing import Final, NamedTuple

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.sampling import break_at_gaps, SampledSignal
import numpy as np
from numpy.typing import NDArray

POINTS: Final = 1200  # per line; a plot is at most about that wide in pixels
DEGREES: Final = 180.0 / math.pi


def thin_signal(line: SampledSignal, points: int = POINTS) -> SampledSignal:
    """Thin a signal to about `points` samples: minimum, maximum and gaps of each stretch."""
    count = len(line.time)
    if count <= points:
        return line
    # Each stretch keeps two points: minimum and maximum.
    length = -(-count // max(points // 2, 1))
    rows = -(-count // length)
    # Repeats the last value to fill the last stretch
    padded = np.pad(line.values, (0, rows * length - count), mode='edge')
    table = padded.reshape(rows, length)
    hidden = np.isnan(table)
    starts = np.arange(rows) * length
    keep = [
        starts + np.where(hidden, np.inf, table).argmin(axis=1),
        starts + np.where(hidden, -np.inf, table).argmax(axis=1),
        # The first NaN of each stretch with a gap
        (starts + hidden.argmax(axis=1))[hidden.any(axis=1)],
        # Both ends of the line
        np.array([0, count - 1]),
    ]
    # In order of time; indices into the padding become the last sample
    index = np.unique(np.minimum(np.concatenate(keep), count - 1))
    return SampledSignal(line.time[index], line.values[index])


class ChannelTrace(NamedTuple):
    """A channel as drawn: its unit, A, B, the difference, and the band."""

    unit: str
    a: SampledSignal
    b: SampledSignal
    difference: SampledSignal
    band: float


def build_channel_trace(each: ChannelComparison, points: int = POINTS) -> ChannelTrace:
    """Return a channel as drawn: angles in degrees and unwrapped."""
    unit, factor = each.unit, 1.0
    if unit in ('rad', 'rad/s'):
        unit, factor = unit.replace('rad', '°'), DEGREES
    if each.angular:
        a, b = unwrap_pair(each)
    else:
        a, b = break_at_gaps(each.a), break_at_gaps(each.b)
    lines = [a, b, break_at_gaps(SampledSignal(each.both.time, each.both.difference))]
    one, other, apart = (
        thin_signal(SampledSignal(line.time, factor * line.values), points) for line in lines
    )
    return ChannelTrace(unit, one, other, apart, factor * each.parting.band)


def unwrap_pair(each: ChannelComparison) -> tuple[SampledSignal, SampledSignal]:
    """Unwrap both angles at their common times, B near A."""
    time, difference = each.both.time, each.both.difference
    finite = np.isfinite(each.both.a)
    a = np.full(len(time), np.nan)
    a[finite] = np.unwrap(each.both.a[finite])
    return break_at_gaps(SampledSignal(time, a)), break_at_gaps(
        SampledSignal(time, a + difference)
    )


def encode_floats(values: NDArray[np.float64]) -> dict[str, str]:
    """Return numbers in plotly's binary form: single precision, base 64."""
    return {'dtype': 'f4', 'bdata': b64encode(values.astype('<f4').tobytes()).decode()}


def encode_channel(each: ChannelComparison, points: int) -> dict[str, object]:
    """Return the data that the page needs to draw a picked channel."""
    trace = build_channel_trace(each, points)
    content: dict[str, object] = {
        'unit': trace.unit,
        'band': trace.band,
        'at': each.parting.at,
        'lines': [
            {'x': encode_floats(line.time), 'y': encode_floats(line.values)}
            for line in (trace.a, trace.b, trace.difference)
        ],
    }
    return content
