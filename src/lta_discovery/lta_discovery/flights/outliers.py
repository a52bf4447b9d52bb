# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Remove single wrong readings and commands, since one of them can outweigh a whole flight.

A reading is in doubt if it is off the cubic through its neighbours by many times the noise. A
second cubic through undoubted readings nearby decides. This runs on the grid; tracker outliers
were removed before (`noise`). Seconds in which a sensor is noisier than usual are excluded, and
commands beyond what the actuators can do are clipped.
"""

from dataclasses import dataclass, replace
from typing import Final, final

from lta_data.even_grid import find_runs
from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, Stream
from lta_discovery.flights.noise import NOISE_MEDIAN
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WILD: Final = 12.0  # standard deviations of the noise, off the cubic
AROUND: Final = 5  # readings on either side for the second cubic
CUBIC_ERROR_SHARE: Final = 0.3  # of the worst; less is the error of the cubic
LONGEST_OUTLIER: Final = 9  # readings in doubt; more are not single outliers
TOP_DUTY: Final = 1.0  # duty; more is impossible
LONGEST_SPIKE: Final = 2  # successive readings of a spike; a longer one is a command
BEYOND: Final = 3.0  # times all but a hundredth of the commands of an axis
USUAL_COMMAND_PERCENT: Final = 99.0  # percent of the commands of an axis that are usual
LOUD: Final = 3.0  # times the usual noise
POINTS_PER_SECOND: Final = 25  # points of the grid
FEW: Final = 6  # readings; fewest for a noise estimate
THIRD: Final = 20.0**0.5  # noise of third differences by that of the values
COLUMN_CHANNELS: Final = {6: 12, 7: 13}  # of ALL_CHANNELS by column of the readings


def find_outliers(values: Array, noise: float) -> Flags:
    """
    Return a mask of the outliers of an evenly sampled series.

    `values`, shape (n,): NaN where there is none.
    """
    out = np.zeros(len(values), dtype=np.bool_)
    if not np.isfinite(noise) or len(values) < 5:
        return out
    doubt = np.zeros(len(values), dtype=np.bool_)
    # Cubic through the two neighbours on either side, at the centre: weights -1, 4, 4, -1 by 6.
    through = (4.0 * (values[1:-3] + values[3:-1]) - values[:-4] - values[4:]) / 6.0
    doubt[2:-2] = np.abs(values[2:-2] - through) > WILD * noise
    for begin, end in find_runs(doubt):
        around = np.r_[max(0, begin - AROUND) : begin, end : min(len(values), end + AROUND)]
        # Doubtful readings must not shape the second cubic
        around = around[np.isfinite(values[around]) & ~doubt[around]]
        if end - begin <= LONGEST_OUTLIER and len(around) > AROUND:
            inside = np.arange(begin, end)
            cubic = np.polynomial.Polynomial.fit(around, values[around], 3)
            off = np.abs(values[inside] - cubic(inside))
            out[inside] = off > max(WILD * noise, CUBIC_ERROR_SHARE * off.max())
    return out


def remove_outliers(flight: MeasuredFlight) -> tuple[MeasuredFlight, int]:
    """
    Remove outliers from a flight; return it and their number.

    A pose is one reading: its position and attitude are removed together.
    """
    # A quaternion changes by half the rotation angle.
    noise = np.concatenate([flight.noise[:3], np.full(4, 0.5 * flight.noise[3:6].max())])
    poses = np.column_stack([flight.position, flight.quaternion])
    lost = np.any([find_outliers(*each) for each in zip(poses.T, noise, strict=True)], axis=0)
    position, quaternion = flight.position.copy(), flight.quaternion.copy()
    # Position and attitude come from one solution of the tracker
    position[lost] = quaternion[lost] = np.nan
    readings, count = flight.readings.copy(), int(lost.sum())
    for k, level in enumerate(flight.noise[6:]):
        gone = find_outliers(readings[:, k], level)
        readings[gone, k] = np.nan
        count += int(gone.sum())
    out = replace(flight, position=position, quaternion=quaternion, readings=readings)
    return (out if count else flight), count


def clip_command_spikes(streams: FlightStreams) -> tuple[FlightStreams, int]:
    """Return the streams without impossible commands, and the number of clipped samples."""
    commands, count = _clip_duties(streams.commands)
    if streams.wrench is None:
        return replace(streams, commands=commands), count
    wrench, more = _clip_wrench(streams.wrench)
    return replace(streams, commands=commands, wrench=wrench), count + more


def _clip_duties(commands: Stream) -> tuple[Stream, int]:
    """Clip duties beyond full duty, unless many are: then they have another unit."""
    beyond = np.abs(commands.values) > TOP_DUTY + 1e-6
    short = _mark_short_runs(beyond)
    if not short.any():
        return commands, 0
    values = np.where(short, np.clip(commands.values, -TOP_DUTY, TOP_DUTY), commands.values)
    return Stream(commands.time, values), int(short.any(axis=1).sum())


def _clip_wrench(wrench: Stream) -> tuple[Stream, int]:
    """Clip commands far beyond the usual ones of their axis."""
    if not len(wrench.time):
        return wrench, 0
    size = np.abs(wrench.values)
    usual = BEYOND * np.percentile(size, USUAL_COMMAND_PERCENT, axis=0)
    short = _mark_short_runs((size > usual) & (usual > 0.0))
    if not short.any():
        return wrench, 0
    # The largest command that is no spike is what the actuators can do
    most = np.where(short, 0.0, size).max(axis=0)
    values = np.where(short, np.clip(wrench.values, -most, most), wrench.values)
    return Stream(wrench.time, values), int(short.any(axis=1).sum())


def _mark_short_runs(beyond: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the marked samples of each column that are in runs of at most `LONGEST_SPIKE`."""
    out = beyond.copy()
    for column, marks in zip(beyond.T, out.T, strict=True):
        for begin, end in find_runs(column):
            if end - begin > LONGEST_SPIKE:
                marks[begin:end] = False
    return out


@final
@dataclass(frozen=True, slots=True)
class ExcludedInterval:
    """An excluded part of a flight."""

    # The flight, and the checked channel. The flight itself is excluded there if the channel is
    # the pose, the commands or the whole; otherwise only that sensor.
    flight: str
    channel: str
    # Since its start [s]
    from_s: float
    to_s: float
    reason: str
    # Whether the whole vehicle is disturbed, whatever the channel: it is in a hand
    disturbs_all: bool = False


def remove_noisy_intervals(
    name: str, flight: MeasuredFlight
) -> tuple[MeasuredFlight, list[ExcludedInterval]]:
    """Exclude seconds with a noisy sensor, such as a range finder near the end of its range."""
    readings, cuts = flight.readings.copy(), []
    for column, channel in ((6, 'range'), (7, 'pressure')):
        rough = np.full(len(readings), np.nan)
        # Third differences remove smooth motion and leave the noise
        rough[:-3] = np.abs(np.diff(readings[:, column], 3)) / THIRD
        for begin in range(0, len(rough), POINTS_PER_SECOND):
            here = slice(begin, begin + POINTS_PER_SECOND)
            finite = rough[here][np.isfinite(rough[here])]
            level = flight.noise[COLUMN_CHANNELS[column]]
            # The median of absolute values of white noise is NOISE_MEDIAN of its deviation
            if len(finite) >= FEW and np.median(finite) < LOUD * NOISE_MEDIAN * level:
                continue
            # Nothing to exclude, and nothing to report
            if not np.isfinite(readings[here, column]).any():
                continue
            readings[here, column] = np.nan
            first, last = (float(flight.time[min(k, len(rough) - 1)]) for k in (begin, here.stop))
            reason = f'The sensor has gaps, or is more than {LOUD:g} times as noisy as usual.'
            cuts.append(ExcludedInterval(name, channel, first, last, reason))
    return replace(flight, readings=readings), cuts
