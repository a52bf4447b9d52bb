"""
Convert every quantity of a flight to a named channel, for comparison, checks and plots.

A channel is named by topic and field, `odom/pose.pose.position.x`. Some fields are converted:
quaternions to yaw, pitch and roll (`odom/pose.pose.orientation.yaw`), joint lists to one channel
per joint (`motors/effort.left`), point lists to one per point (`light/peaks/snr[3]`), ADC blocks
to mean, standard deviation, minimum and maximum of each diode. A quantity that its message
declares unknown (see `lta_config.covariances`) is NaN.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
import re
from typing import Any, Final, final, NamedTuple

from lta_config.covariances import select_estimates
from lta_config.errors import BadInput
from lta_data.bag.columns import LAMP_PEAKS, LIGHT_BLOCK, TopicSeries
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import ANGLES, find_unit, name_joints
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.typing import NDArray

BLOCK: Final[dict[str, Callable[..., NDArray[Any]]]] = {
    'mean': np.mean,
    'std': np.std,
    'min': np.min,
    'max': np.max,
}
HIDDEN: Final = re.compile(r'(^|\.)header\.|covariance(\[|$)|^(clock|stamp)\.')


@final
@dataclass(frozen=True, slots=True)
class SignalChannel:
    """One quantity over time."""

    name: str  # topic and field, 'odom/pose.pose.position.x'
    unit: str  # unit of the values; '' if unknown
    # Since the start of the flight, in the order of recording, shape (n,) [s]
    time: NDArray[np.float64]
    values: NDArray[np.float64]  # NaN where a message lacks the field, shape (n,)
    angular: bool = False  # whether values 2 pi apart are equal

    @property
    def topic(self) -> str:
        """The topic; relative to the robot for the robot's topics."""
        return self.name.rpartition('/')[0]

    @property
    def field(self) -> str:
        """The field, as in the channel's name."""
        return self.name.rpartition('/')[2]


def iterate_channels(
    flight: RecordedFlight, topic: str, series: TopicSeries | None = None
) -> Iterator[SignalChannel]:
    """
    Yield the channels of one topic, without stamps, covariances and texts.

    `series` are its messages, if they have been read together with other topics.

    Raise `BadInput` if the topic is missing or cannot be decoded.
    """
    kind = flight.message_type(topic)
    if kind == LIGHT_BLOCK:
        yield from _iterate_block_channels(flight, topic)
    elif kind == LAMP_PEAKS:
        yield from _iterate_point_channels(flight, topic)
    else:
        yield from _iterate_series_channels(
            flight.read_series(topic) if series is None else series, topic, kind
        )


def read_topics(flight: RecordedFlight, topics: Collection[str]) -> dict[str, TopicSeries]:
    """
    Read all numeric topics in one pass over the bag.

    Light blocks and lamp peaks are excluded. The result is empty if one topic cannot be decoded;
    then `iterate_channels` raises the error for that topic.
    """
    # They have readers of their own
    packed = {LAMP_PEAKS, LIGHT_BLOCK}
    plain = [topic for topic in topics if flight.message_type(topic) not in packed]
    try:
        return flight.read_topics(plain)
    except BadInput:
        return {}


def _iterate_series_channels(
    series: TopicSeries, topic: str, kind: str
) -> Iterator[SignalChannel]:
    """Yield the channels of numeric messages."""
    turned = {path.removesuffix('.w') for path in series.numbers if path.endswith('.w')}
    for path in sorted(turned):
        # Angles instead of components: they have a unit, and q and -q give the same values
        angles = to_euler_angles(
            np.where(_find_valid_messages(series, path)[:, None], series.vector(path), np.nan)
        )
        for part, values in zip(ANGLES, angles, strict=True):
            yield SignalChannel(f'{topic}/{path}.{part}', 'rad', series.time, values, angular=True)
    joints = name_joints(series)
    for path, values in series.numbers.items():
        # Quaternion components are replaced by angles.
        if HIDDEN.search(path) or path.rpartition('.')[0] in turned:
            continue
        unit, name = find_unit(kind, path, topic), joints.get(path, path)
        valid = np.where(_find_valid_messages(series, path), values.astype(np.float64), np.nan)
        yield SignalChannel(f'{topic}/{name}', unit, series.time, valid)


def _find_valid_messages(series: TopicSeries, path: str) -> NDArray[np.bool_]:
    """Return for each message whether the quantity is known, by its covariance."""
    first = path.split('.')[0]
    is_valid = np.ones(len(series), dtype=np.bool_)
    for beside in (f'{first}_covariance[0]', f'{first}.covariance[0]'):
        if beside in series.numbers:
            is_valid &= select_estimates(series.numbers[beside])
    return is_valid


def _iterate_block_channels(flight: RecordedFlight, topic: str) -> Iterator[SignalChannel]:
    """Yield the statistics of each column of the blocks, at the time of the block."""
    blocks = flight.read_blocks(topic)
    if not len(blocks.time):  # topic without messages
        return
    unit = find_unit(LIGHT_BLOCK, 'counts')
    for what, reduced in BLOCK.items():
        # Block by block, to save memory: float64 is four times as large as the ADC samples.
        rows = [reduced(block, axis=0) for block in blocks.samples]
        table = np.array(rows, dtype=np.float64).reshape(len(rows), -1)
        for index, column in enumerate(table.T):
            yield SignalChannel(f'{topic}/{what}[{index}]', unit, blocks.time, column)


def _iterate_point_channels(flight: RecordedFlight, topic: str) -> Iterator[SignalChannel]:
    """Yield each field of each point."""
    points = flight.read_points(topic)
    for field, table in points.fields.items():
        unit = find_unit(LAMP_PEAKS, field, topic)
        for index, column in enumerate(table.T):
            yield SignalChannel(f'{topic}/{field}[{index}]', unit, points.time, column)


class DecodedChannels(NamedTuple):
    """Channels by name, and a remark for each topic that could not be decoded."""

    channels: dict[str, SignalChannel]
    remarks: list[str]


def read_all_channels(flight: RecordedFlight) -> DecodedChannels:
    """Return every channel of the robot's topics."""
    decoded = DecodedChannels({}, [])
    for topic in flight.topics:
        try:
            decoded.channels.update((item.name, item) for item in iterate_channels(flight, topic))
        except BadInput as fault:
            decoded.remarks.append(f"Topic '{topic}' is left out: {fault}")
    return decoded


def find_airspeed_topic(topics: Collection[str]) -> str:
    """
    Return the topic whose twist is the estimated velocity through the air.

    In version 1.0 there was no topic `airspeed`: `odom` had the velocity through the air, and
    its x and y were dead reckoning through the air.
    """
    return 'airspeed' if 'airspeed' in topics else 'odom'
