"""Which channels of a flight a person means, and how they share axes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
import math
from typing import Final

from lta_config.errors import BadInput
from lta_data.bag.channels import all_channels, Channel, channels
from lta_data.bag.flight import Flight
import numpy as np

MOST: Final = 24  # lines in one look
NEAR: Final = 4  # names offered for one that is not there
DEGREE: Final = math.pi / 180.0


def chosen(flight: Flight, patterns: Sequence[str]) -> list[Channel]:
    """
    Return the channels that some patterns name, in the order of the patterns.

    Parameters
    ----------
    flight : Flight
        The recording of one robot; only topics that a pattern can mean are decoded.
    patterns : sequence of str
        A channel ('odom/pose.pose.position.z'), a topic ('motors'), or either with `*`.

    Raises
    ------
    BadInput
        If a pattern means nothing, or all together mean too much for one picture.

    """
    found: dict[str, Channel] = {}
    for pattern in patterns:
        meant = [
            channel
            for topic in flight.topics
            if may_mean(pattern, topic)
            for channel in channels(flight, topic)
            if means(pattern, channel)
        ]
        if not meant:
            raise nothing(flight, pattern)
        found |= {channel.name: channel for channel in meant}
    if len(found) > MOST:
        raise BadInput(
            f'{len(found)} channels are too many for one picture (at most {MOST}); name fewer, '
            f"such as '{next(iter(found))}'."
        )
    return list(found.values())


def may_mean(pattern: str, topic: str) -> bool:
    """Tell whether a channel of a topic can match a pattern."""
    return fnmatchcase(topic, pattern) or fnmatchcase(topic, pattern.rpartition('/')[0])


def means(pattern: str, channel: Channel) -> bool:
    """Tell whether a pattern names a channel or its topic."""
    # fnmatch reads [0] as a choice of letters; a person means the first element.
    escaped = pattern.replace('[', '[[]')
    return fnmatchcase(channel.topic, pattern) or fnmatchcase(channel.name, escaped)


def nothing(flight: Flight, pattern: str) -> BadInput:
    """Return the error for a pattern that means nothing, with what is near it."""
    known = [*flight.topics, *all_channels(flight).channels]
    near = get_close_matches(pattern, known, NEAR, 0.4) or flight.topics[:NEAR]
    return BadInput(
        f"No channel matches '{pattern}'; near it: {', '.join(near)}. Without a name, all are "
        'listed.'
    )


def readable(channel: Channel) -> Channel:
    """Return an angle in degrees without jumps; anything else as it is."""
    if not channel.angular:
        return channel
    values = channel.values.copy()
    known = np.isfinite(values)
    values[known] = np.unwrap(values[known])
    return replace(channel, unit='deg', values=values / DEGREE)


def between(channel: Channel, begin: float, end: float) -> Channel:
    """Return the part of a channel in a closed stretch of time. [s]"""
    inside = (channel.time >= begin) & (channel.time <= end)
    return replace(channel, time=channel.time[inside], values=channel.values[inside])


def by_unit(shown: Sequence[Channel]) -> Iterator[tuple[str, list[Channel]]]:
    """Yield unit and channels of each axis: what has one unit shares one."""
    for unit in dict.fromkeys(channel.unit for channel in shown):
        yield unit, [channel for channel in shown if channel.unit == unit]
