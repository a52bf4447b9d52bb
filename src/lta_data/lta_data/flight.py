# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Hold a flight in memory: named channels over time, read from a bag or built from a log.

Checks, comparisons, plots, calibration and discovery take this form; `lta_data.bag.channels` reads
it from the recording of a robot.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SIMULATED_KEYS: Final = ('seed', 'scenario')  # of provenance, which only a simulator writes


@final
@dataclass(frozen=True, slots=True)
class Channel:
    """One quantity over time."""

    name: str  # topic and field, 'odom/pose.pose.position.x'
    unit: str  # unit of the values; '' if unknown
    # Since the start of the flight, in the order of recording, shape (n,) [s]
    time: Array
    values: Array  # NaN where a message lacks the field, shape (n,)
    angular: bool = False  # whether values 2 pi apart are equal
    frame: str = ''  # `frame_id` of the first message; '' if it has none

    @property
    def topic(self) -> str:
        """Return the topic; relative to the robot for the robot's topics."""
        return self.name.rpartition('/')[0]

    @property
    def field(self) -> str:
        """Return the field, as in the channel's name."""
        return self.name.rpartition('/')[2]


@final
@dataclass(frozen=True, slots=True)
class Flight:
    """The flight of one robot; any subset of topics will do."""

    channels: Mapping[str, Channel]  # by name
    provenance: Mapping[str, str] = field(default_factory=dict)  # as stored in the recording
    # Log time of each message by topic, since the topic's first [s]
    arrivals: Mapping[str, Array] = field(default_factory=dict)
    path: str = ''  # of its bag; '' if it comes from none
    robot: str = ''
    start: int = 0  # time 0 of its channels, on the clock of the stamps [ns]
    # Message type of each topic of the bag that was to be read, also where that failed
    types: Mapping[str, str] = field(default_factory=dict)
    losses: tuple[str, ...] = ()  # missing or unreadable parts, one sentence each

    @property
    def topics(self) -> dict[str, list[Channel]]:
        """Return the channels of each topic; none of one that could not be decoded."""
        topics: dict[str, list[Channel]] = {topic: [] for topic in self.types}
        for channel in self.channels.values():
            topics.setdefault(channel.topic, []).append(channel)
        return topics

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of any channel [s]."""
        times = [channel.time for channel in self.channels.values() if len(channel.time)]
        if not times:
            return 0.0, 0.0
        return min(float(time.min()) for time in times), max(float(time.max()) for time in times)

    @property
    def is_simulated(self) -> bool:
        """Whether the recording declares itself simulated."""
        declared = self.provenance.get('data')  # set by an import
        return declared == 'simulated' or (
            declared is None and all(key in self.provenance for key in SIMULATED_KEYS)
        )
