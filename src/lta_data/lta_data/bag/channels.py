"""
Every quantity of a flight as one named channel: what comparing, checking and plotting work on.

A channel is named by its topic and field, `odom/pose.pose.position.x`. What people read otherwise
is turned into that: a quaternion into yaw, pitch and roll (`odom/pose.pose.orientation.yaw`), a
list of joints into one channel a joint (`motors/effort.left`), a point list into one a point
(`light/peaks/snr[3]`), an ADC block into mean, spread and extremes of each diode. A quantity that
its message declares unknown (ROS: the first element of its covariance is -1) is NaN there.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
import re
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.bag.flight import Flight
from lta_data.bag.series import Series
from lta_data.bag.units import unit_of
from lta_model.attitude import angles
import numpy as np
from numpy.typing import NDArray

IMAGE: Final = 'sensor_msgs/msg/Image'
CLOUD: Final = 'sensor_msgs/msg/PointCloud2'
PARTS: Final = ('yaw', 'pitch', 'roll')
BLOCK: Final[dict[str, Callable[..., NDArray[Any]]]] = {
    'mean': np.mean,
    'std': np.std,
    'min': np.min,
    'max': np.max,
}
UNKNOWN: Final = -1.0
HIDDEN: Final = re.compile(r'(^|\.)header\.|covariance(\[|$)|^(clock|stamp)\.')
_ELEMENT: Final = re.compile(r'(.*)\[(\d+)\]')


@final
@dataclass(frozen=True, slots=True)
class Channel:
    """
    One quantity over time.

    Attributes
    ----------
    name : str
        Topic and field, 'odom/pose.pose.position.x'.
    unit : str
        Of the values; '' where nobody says.
    time : ndarray, shape (n,)
        Since the start of the flight, in the order of recording. [s]
    values : ndarray of float64, shape (n,)
        NaN where a message lacks the field.
    angular : bool
        Whether values 2 pi apart mean the same.

    """

    name: str
    unit: str
    time: NDArray[np.float64]
    values: NDArray[np.float64]
    angular: bool = False

    @property
    def topic(self) -> str:
        """The topic, relative to the robot where it is one of the robot's."""
        return self.name.rpartition('/')[0]

    @property
    def field(self) -> str:
        """The field, as the channel names it."""
        return self.name.rpartition('/')[2]


def channels(flight: Flight, topic: str, series: Series | None = None) -> Iterator[Channel]:
    """
    Yield the channels of one topic of a flight.

    Stamps, covariances and texts are left out.

    Parameters
    ----------
    flight : Flight
        The recording of one robot.
    topic : str
        Relative to the robot ('odom') or absolute.
    series : Series, optional
        Its messages, where they have been read with those of other topics.

    Raises
    ------
    BadInput
        If the topic is not there or cannot be decoded.

    """
    kind = flight.type_of(topic)
    if kind == IMAGE:
        yield from _of_blocks(flight, topic)
    elif kind == CLOUD:
        yield from _of_points(flight, topic)
    else:
        yield from _of_series(flight.series(topic) if series is None else series, topic, kind)


def read_together(flight: Flight, topics: Collection[str]) -> dict[str, Series]:
    """
    Return the messages of all topics of numbers from one pass over the bag.

    Images and point clouds are not among them; nothing is where one topic cannot be decoded, which
    `channels` then tells of that topic.
    """
    plain = [topic for topic in topics if flight.type_of(topic) not in (IMAGE, CLOUD)]
    try:
        return flight.read(plain)
    except BadInput:
        return {}


def _of_series(series: Series, topic: str, kind: str) -> Iterator[Channel]:
    """Yield the channels of messages of numbers."""
    turned = {path.removesuffix('.w') for path in series.numbers if path.endswith('.w')}
    for path in sorted(turned):
        found = angles(np.where(_known(series, path)[:, None], series.vector(path), np.nan))
        for part, values in zip(PARTS, found, strict=True):
            yield Channel(f'{topic}/{path}.{part}', 'rad', series.time, values, angular=True)
    for path, values in series.numbers.items():
        if HIDDEN.search(path) or path.rpartition('.')[0] in turned:
            continue
        unit, name = unit_of(kind, path, topic), _named(series, path)
        kept = np.where(_known(series, path), values.astype(np.float64), np.nan)
        yield Channel(f'{topic}/{name}', unit, series.time, kept)


def _known(series: Series, path: str) -> NDArray[np.bool_]:
    """Tell for each message whether it knows the quantity, by the covariance beside it."""
    first = path.split('.')[0]
    known = np.ones(len(series), dtype=np.bool_)
    for beside in (f'{first}_covariance[0]', f'{first}.covariance[0]'):
        if beside in series.numbers:
            known &= series.numbers[beside] != UNKNOWN
    return known


def _named(series: Series, path: str) -> str:
    """Return the path of a joint's element with the joint's name, where it keeps it."""
    element = _ELEMENT.fullmatch(path)
    if element is None:
        return path
    field, index = element.groups()
    names: NDArray[Any] = series.texts.get(f'name[{index}]', np.empty(0))
    return f'{field}.{names[0]}' if len(names) and (names == names[0]).all() else path


def _of_blocks(flight: Flight, topic: str) -> Iterator[Channel]:
    """Yield what each column of blocks comes to, at the time of the block."""
    blocks = flight.blocks(topic)
    if not len(blocks.time):  # announced, and nothing came
        return
    unit = unit_of(IMAGE, 'data', topic)
    for what, reduced in BLOCK.items():
        # Block by block: all of them as float64 would be four times the recording.
        rows = [reduced(block, axis=0) for block in blocks.samples]
        table = np.array(rows, dtype=np.float64).reshape(len(rows), -1)
        for index, column in enumerate(table.T):
            yield Channel(f'{topic}/{what}[{index}]', unit, blocks.time, column)


def _of_points(flight: Flight, topic: str) -> Iterator[Channel]:
    """Yield each field of each point."""
    points = flight.points(topic)
    for field, table in points.fields.items():
        unit = unit_of(CLOUD, field, topic)
        for index, column in enumerate(table.T):
            yield Channel(f'{topic}/{field}[{index}]', unit, points.time, column)


class Found(NamedTuple):
    """Channels by name, and a sentence for each topic that could not be decoded."""

    channels: dict[str, Channel]
    remarks: list[str]


def all_channels(flight: Flight) -> Found:
    """Return every channel of the robot's topics."""
    found = Found({}, [])
    for topic in flight.topics:
        try:
            found.channels.update((item.name, item) for item in channels(flight, topic))
        except BadInput as fault:
            found.remarks.append(f"Topic '{topic}' is left out: {fault}")
    return found
