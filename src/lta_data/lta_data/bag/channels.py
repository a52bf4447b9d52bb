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
from lta_data.bag.columns import LAMP_PEAKS, LIGHT_BLOCK, TopicSeries
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import EULER_PARTS, find_unit, name_joints
from lta_data.flight import Channel, Flight
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.typing import NDArray

BLOCK_STATISTICS: Final[dict[str, Callable[..., NDArray[Any]]]] = {
    'mean': np.mean,
    'std': np.std,
    'min': np.min,
    'max': np.max,
}
HIDDEN_FIELDS: Final = re.compile(r'(^|\.)header\.|covariance(\[|$)|^(clock|stamp)\.')


def iterate_channels(
    flight: RecordedFlight,
    topic: str,
    series: TopicSeries | None = None,
    *,
    quaternions: bool = False,
) -> Iterator[Channel]:
    """
    Yield the channels of one topic, without stamps, covariances and texts.

    `series` are its messages, if they have been read together with other topics. `quaternions`:
    with x, y, z and w of each attitude beside its angles.

    Raise `BadInput` if the topic is missing or cannot be decoded.
    """
    kind = flight.message_type(topic)
    if kind == LIGHT_BLOCK:
        yield from _iterate_block_channels(flight, topic)
    elif kind == LAMP_PEAKS:
        yield from _iterate_point_channels(flight, topic)
    else:
        series = flight.read_series(topic) if series is None else series
        frames = series.texts.get('header.frame_id', np.empty(0))
        frame = str(frames[0]).removeprefix(f'{flight.robot}/') if len(frames) else ''
        for channel in _iterate_series_channels(series, topic, kind, quaternions):
            yield replace(channel, frame=frame)


def _iterate_series_channels(
    series: TopicSeries, topic: str, kind: str, quaternions: bool
) -> Iterator[Channel]:
    """Yield the channels of numeric messages."""
    turned = {path.removesuffix('.w') for path in series.numbers if path.endswith('.w')}
    for path in sorted(turned):
        # Angles instead of components: they have a unit, and q and -q give the same values
        rows = np.where(_find_valid_messages(series, path)[:, None], series.vector(path), np.nan)
        angles = to_euler_angles(rows)
        for part, values in zip(EULER_PARTS, angles, strict=True):
            yield Channel(f'{topic}/{path}.{part}', 'rad', series.time, values, angular=True)
        # Not of an attitude that was declared unknown, or never filled in
        if quaternions and (is_there := np.isfinite(angles[0])).any():
            for part, values in zip('xyzw', rows.T, strict=True):
                masked = np.where(is_there, values, np.nan)
                yield Channel(f'{topic}/{path}.{part}', '1', series.time, masked)
    joints = name_joints(series)
    for path, values in series.numbers.items():
        # Quaternion components are replaced by angles.
        if HIDDEN_FIELDS.search(path) or path.rpartition('.')[0] in turned:
            continue
        unit, name = find_unit(kind, path, topic), joints.get(path, path)
        valid = np.where(_find_valid_messages(series, path), values.astype(np.float64), np.nan)
        yield Channel(f'{topic}/{name}', unit, series.time, valid)


def _find_valid_messages(series: TopicSeries, path: str) -> NDArray[np.bool_]:
    """Return for each message whether the quantity is known, by its covariance."""
    first = path.split('.')[0]
    is_valid = np.ones(len(series), dtype=np.bool_)
    for beside in (f'{first}_covariance[0]', f'{first}.covariance[0]'):
        if beside in series.numbers:
            is_valid &= select_estimates(series.numbers[beside])
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


def _iterate_point_channels(flight: RecordedFlight, topic: str) -> Iterator[Channel]:
    """Yield each field of each point."""
    points = flight.read_points(topic)
    for field, table in points.fields.items():
        unit = find_unit(LAMP_PEAKS, field, topic)
        for index, column in enumerate(table.T):
            yield Channel(f'{topic}/{field}[{index}]', unit, points.time, column)


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
    plain = [topic for topic in names if types[topic] not in (LAMP_PEAKS, LIGHT_BLOCK)]
    channels: dict[str, Channel] = {}
    arrivals: dict[str, NDArray[np.float64]] = {}
    remarks: list[str] = []
    try:
        # In one pass over the bag; if a topic cannot be decoded, one by one
        read = recorded.read_topics(plain)
    except BadInput:
        read = {}
    for topic in names:
        series = read.pop(topic, None)
        try:
            own = [*iterate_channels(recorded, topic, series, quaternions=raw)]
        except BadInput as fault:
            remarks.append(f"Topic '{topic}' is left out: {fault}")
            own = []
        channels |= {channel.name: channel for channel in own}
        if raw:
            logged = recorded.read_log_times(topic) if series is None else series.logged
            arrivals[topic] = np.asarray((logged - logged[:1]) * 1e-9, dtype=np.float64)
        tick()
    return Flight(
        channels, recorded.provenance, arrivals, str(recorded.bag.path), recorded.robot,
        recorded.start, types,
        # After reading, since some damage is detected only then
        (*recorded.losses, *remarks),
    )  # fmt: skip


def find_airspeed_topic(topics: Collection[str]) -> str:
    """
    Return the topic whose twist is the estimated velocity through the air.

    In version 1.0 there was no topic `airspeed`: `odom` had the velocity through the air, and
    its x and y were dead reckoning through the air.
    """
    return 'airspeed' if 'airspeed' in topics else 'odom'
