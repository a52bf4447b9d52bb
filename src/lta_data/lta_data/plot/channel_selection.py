"""Select channels of a flight by pattern, and group them by axis."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
import math
from typing import Final

from lta_config.errors import BadInput
from lta_data.bag.channels import iterate_channels, read_all_channels, SignalChannel
from lta_data.bag.recorded_flight import RecordedFlight
import numpy as np

MOST: Final = 24  # lines in one plot, at most
NEAR: Final = 4  # names suggested for an unknown one
DEGREE: Final = math.pi / 180.0


def select_channels(flight: RecordedFlight, patterns: Sequence[str]) -> list[SignalChannel]:
    """
    Return the channels that match the patterns, in the order of the patterns.

    A pattern is a channel ('odom/pose.pose.position.z'), a topic ('motors'), or either with `*`.
    Only matching topics are decoded.

    Raise `BadInput` if a pattern matches nothing, or all together match too many channels for one
    plot.
    """
    channels: dict[str, SignalChannel] = {}
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
    if len(channels) > MOST:
        raise BadInput(
            f'{len(channels)} channels are too many for one plot (at most {MOST}); name fewer, '
            f"such as '{next(iter(channels))}'."
        )
    return list(channels.values())


def can_match(pattern: str, topic: str) -> bool:
    """Return whether a channel of a topic can match a pattern."""
    return fnmatchcase(topic, pattern) or fnmatchcase(topic, pattern.rpartition('/')[0])


def matches_channel(pattern: str, channel: SignalChannel) -> bool:
    """Return whether a pattern matches a channel or its topic."""
    # fnmatch takes [0] as a character class; here it is an array index.
    escaped = pattern.replace('[', '[[]')
    return fnmatchcase(channel.topic, pattern) or fnmatchcase(channel.name, escaped)


def no_match_error(flight: RecordedFlight, pattern: str) -> BadInput:
    """Return the error for a pattern without a match, with similar names."""
    names = [*flight.topics, *read_all_channels(flight).channels]
    # 0.4: least similarity, low enough for abbreviations
    near = get_close_matches(pattern, names, NEAR, 0.4) or flight.topics[:NEAR]
    return BadInput(
        f"No channel matches '{pattern}'; similar: {', '.join(near)}. To list all channels, give "
        'no channel.'
    )


def unwrap_to_degrees(channel: SignalChannel) -> SignalChannel:
    """Return an angle in degrees and unwrapped; any other channel unchanged."""
    if not channel.angular:
        return channel
    # The flight caches its arrays; do not change them
    values = channel.values.copy()
    finite = np.isfinite(values)
    values[finite] = np.unwrap(values[finite])
    return replace(channel, unit='deg', values=values / DEGREE)


def crop_channel(channel: SignalChannel, begin: float, end: float) -> SignalChannel:
    """Return the part of a channel in a closed time interval. [s]"""
    inside = (channel.time >= begin) & (channel.time <= end)
    return replace(channel, time=channel.time[inside], values=channel.values[inside])


def group_by_unit(channels: Sequence[SignalChannel]) -> Iterator[tuple[str, list[SignalChannel]]]:
    """Yield unit and channels of each axis; channels of one unit share an axis."""
    for unit in dict.fromkeys(channel.unit for channel in channels):
        yield unit, [channel for channel in channels if channel.unit == unit]
