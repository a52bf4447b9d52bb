"""Clip single commands that are beyond what the actuators can do."""

from dataclasses import replace
from typing import Final

from lta_discovery.flights.measured_flight import FlightStreams, Stream
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FULL: Final = 1.0  # duty; more is impossible
LONGEST: Final = 2  # successive readings of a spike; a longer one is a command
BEYOND: Final = 3.0  # times all but a hundredth of the commands of an axis
PART: Final = 99.0  # percent of the commands of an axis that are usual


def clip_command_spikes(streams: FlightStreams) -> tuple[FlightStreams, int]:
    """Return the streams without impossible commands, and the number of clipped samples."""
    commands, count = _clip_duties(streams.commands)
    if streams.wrench is None:
        return replace(streams, commands=commands), count
    wrench, more = _clip_wrench(streams.wrench)
    return replace(streams, commands=commands, wrench=wrench), count + more


def _clip_duties(commands: Stream) -> tuple[Stream, int]:
    """Clip duties beyond full duty, unless many are: then they have another unit."""
    beyond = np.abs(commands.values) > FULL + 1e-6
    short = _mark_short_runs(beyond)
    if not short.any():
        return commands, 0
    values = np.where(short, np.clip(commands.values, -FULL, FULL), commands.values)
    return Stream(commands.time, values), int(short.any(axis=1).sum())


def _clip_wrench(wrench: Stream) -> tuple[Stream, int]:
    """Clip commands far beyond the usual ones of their axis."""
    if not len(wrench.time):
        return wrench, 0
    size = np.abs(wrench.values)
    usual = BEYOND * np.percentile(size, PART, axis=0)
    short = _mark_short_runs((size > usual) & (usual > 0.0))
    if not short.any():
        return wrench, 0
    # The largest command that is no spike is what the actuators can do
    most = np.where(short, 0.0, size).max(axis=0)
    values = np.where(short, np.clip(wrench.values, -most, most), wrench.values)
    return Stream(wrench.time, values), int(short.any(axis=1).sum())


def _mark_short_runs(beyond: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the marked samples of each column that are in runs of at most `LONGEST`."""
    out = beyond.copy()
    for column, marks in zip(beyond.T, out.T, strict=True):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(np.int8), [0]])))
        for begin, end in edges.reshape(-1, 2):
            if end - begin > LONGEST:
                marks[begin:end] = False
    return out
