# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One corrupted recording, and what corruptions are made of."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

from lta_data.flight import Channel, Flight
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
TRUTH: Final = 'ground_truth/odom'
PLACE: Final = f'{TRUTH}/pose.pose.position'
TURN: Final = f'{TRUTH}/pose.pose.orientation'
SPEED: Final = f'{TRUTH}/twist.twist.linear'
SPIN: Final = f'{TRUTH}/twist.twist.angular'
GYRO: Final = 'imu/angular_velocity'
FORCE: Final = 'imu/linear_acceleration'


@dataclass(frozen=True, slots=True)
class Corrupted:
    """A corrupted recording, and what should be found: any of these names, in this interval."""

    recording: Flight
    names: tuple[str, ...]
    from_s: float
    to_s: float
    how: str


Corruption = Callable[[Flight, Generator], Corrupted | None]


def changed(flight: Flight, new: Mapping[str, Array]) -> Flight:
    """Return a recording with other values in some channels."""
    channels = dict(flight.channels)
    for name, values in new.items():
        channels[name] = replace(channels[name], values=values)
    return replace(flight, channels=channels)


def scaled(flight: Flight, names: list[str], factor: float) -> Flight:
    """Return a recording with some channels multiplied."""
    return changed(flight, {name: flight.channels[name].values * factor for name in names})


def span(rng: Generator, channel: Channel, least: float, most: float) -> tuple[int, int]:
    """Draw an interval inside a channel, not at its ends, as indices."""
    time = channel.time
    total = float(time[-1] - time[0])
    size = min(float(np.exp(rng.uniform(np.log(least), np.log(most)))), 0.4 * total)
    begin = float(time[0]) + float(rng.uniform(0.15, 0.85)) * (total - size)
    low, high = np.searchsorted(time, [begin, begin + size])
    return int(low), int(max(high, low + 2))


def over(channel: Channel, low: int, high: int) -> tuple[float, float]:
    """Return an interval of indices as times."""
    return float(channel.time[low]), float(channel.time[min(high, len(channel.time)) - 1])


def whole(channel: Channel) -> tuple[float, float]:
    """Return all of a channel's time."""
    return float(channel.time[0]), float(channel.time[-1])
