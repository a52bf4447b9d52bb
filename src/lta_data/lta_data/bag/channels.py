# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read the flight of a robot from its recording: every quantity as a named channel.

A channel is named by topic and field, `odom/pose.pose.position.x`. Some fields are converted:
quaternions to yaw, pitch and roll (`odom/pose.pose.orientation.yaw`), joint lists to one channel
per joint (`motors/effort.left`), point lists to one per point (`light/peaks/snr[3]`), ADC blocks
to mean, standard deviation, minimum and maximum of each diode. A quantity that its message
declares unknown (see `lta_config.covariances`) is NaN.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
import re
from typing import Any, Final

from lta_config.covariances import select_estimates
from lta_config.errors import BadInput
from lta_data.bag.columns import LIGHT_BLOCK
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import EULER_PARTS, find_unit, QUATERNION_AXES, Table
from lta_data.flight import Channel, Flight
import numpy as np
from numpy.typing import NDArray

BLOCK_STATISTICS: Final[dict[str, Callable[..., NDArray[Any]]]] = {
    'mean': np.mean,
    'std': np.std,
    'min': np.min,
    'max': np.max,
}
ANGULAR_FIELDS: Final = re.compile(r'\.(orientation|angular)\.')
HIDDEN_FIELDS: Final = re.compile(r'^stamp_ns$|(^|\.)header\.|covariance(\[|$)|^(clock|stamp)\.')


def iterate_channels(
    flight: RecordedFlight, topic: str, table: Table = None, *, quaternions: bool = False
) -> Iterator[Channel]:
    """
    Yield the channels of one topic, without stamps, covariances and texts.

    `table` is the topic, if it has been read together with others. `quaternions`: with x, y, z
    and w of each attitude beside its angles.

    Raise `BadInput` if the topic is missing or cannot be decoded.
    """
    if flight.message_type(topic) == LIGHT_BLOCK:
        yield from _iterate_block_channels(flight, topic)
        return
    table = flight[topic] if table is None else table
    frames = table.get('header.frame_id', ())
    frame = str(frames.iloc[0]).removeprefix(f'{flight.robot}/') if len(frames) else ''
    for channel in _iterate_table_channels(table, quaternions):
        yield replace(channel, frame=frame)


def _iterate_table_channels(table: Table, quaternions: bool) -> Iterator[Channel]:
    """Yield the channels of numeric messages."""
    topic, units, time = table.attrs['topic'], table.attrs['units'], table.index.to_numpy()
    numbers = [*table.select_dtypes(['number', 'bool'])]

    def read(name: str) -> NDArray[np.float64]:
        valid = _find_valid_messages(table, name)
        return np.where(valid, table[name].to_numpy().astype(np.float64), np.nan)

    turned = {path for name in numbers if f'{(path := name.removesuffix(".w"))}.yaw' in table}
    for path in sorted(turned):
        # Angles instead of components: they have a unit, and q and -q give the same values
        angles = [read(f'{path}.{part}') for part in EULER_PARTS]
        for part, values in zip(EULER_PARTS, angles, strict=True):
            yield Channel(f'{topic}/{path}.{part}', 'rad', time, values, angular=True)
        # Not of an attitude that was declared unknown, or never filled in
        if quaternions and (is_there := np.isfinite(angles[0])).any():
            for part in QUATERNION_AXES:
                values = np.where(is_there, read(f'{path}.{part}'), np.nan)
                yield Channel(f'{topic}/{path}.{part}', '1', time, values)
    for name in numbers:
        # Quaternion components are replaced by angles.
        if not HIDDEN_FIELDS.search(name) and name.rpartition('.')[0] not in turned:
            yield Channel(f'{topic}/{name}', units.get(name, ''), time, read(name))


def _find_valid_messages(table: Table, name: str) -> NDArray[np.bool_]:
    """Return for each message whether the quantity is known, by its covariance."""
    first = name.split('.')[0]
    # Of a pose and of a twist, three linear components come before three angular ones
    element = 21 if ANGULAR_FIELDS.search(name) else 0
    is_valid = np.ones(len(table), dtype=np.bool_)
    for beside in (f'{first}_covariance[0]', f'{first}.covariance[{element}]'):
        if beside in table:
            is_valid &= select_estimates(table[beside].to_numpy())
    return is_valid


def _iterate_block_channels(flight: RecordedFlight, topic: str) -> Iterator[Channel]:
    """Yield the statistics of each column of the blocks, at the time of the block."""
    blocks = flight.read_blocks(topic)
    if not len(blocks.time):  # topic without messages
        return
    unit = find_unit(LIGHT_BLOCK, 'counts')
    for what, reduced in BLOCK_STATISTICS.items():
        # Block by block, to save memory: float64 is four times as large as the ADC samples.
        rows = [reduced(block, axis=0) for block in blocks.samples]
        table = np.array(rows, dtype=np.float64).reshape(len(rows), -1)
        for index, column in enumerate(table.T):
            yield Channel(f'{topic}/{what}[{index}]', unit, blocks.time, column)


def read_flight(
    recorded: RecordedFlight,
    topics: Collection[str] | None = None,
    *,
    raw: bool = False,
    tick: Callable[[], None] = lambda: None,
) -> Flight:
    """
    Return the flight of a robot from its recording.

    `topics`: relative to the robot; None for all. `raw`: with the log times, and the quaternions
    beside their angles. `tick`: called once for each topic.
    """
    names = [topic for topic in recorded.topics if topics is None or topic in topics]
    types = {topic: recorded.message_type(topic) for topic in names}
    channels: dict[str, Channel] = {}
    remarks: list[str] = []
    try:
        # In one pass over the bag; if a topic cannot be decoded, one by one
        read = recorded.read_tables([one for one in names if types[one] != LIGHT_BLOCK])
    except BadInput:
        read = {}
    for topic in names:
        try:
            own = [*iterate_channels(recorded, topic, read.pop(topic, None), quaternions=raw)]
        except BadInput as fault:
            remarks.append(f"Topic '{topic}' is left out: {fault}")
            own = []
        channels |= {channel.name: channel for channel in own}
        tick()
    logged = recorded.read_log_times(names) if raw else {}
    arrivals = {
        topic: np.asarray((times - times[:1]) * 1e-9, dtype=np.float64)
        for topic, times in logged.items()
    }
    return Flight(
        channels, recorded.provenance, arrivals, str(recorded.bag.path), recorded.robot,
        recorded.start, types,
        # After reading, since some damage is detected only then
        (*recorded.losses, *remarks),
    )  # fmt: skip
