"""
A recorded flight of one robot as numpy arrays, all on one clock.

Time runs in seconds from the stamp of the first stamped message of the robot. Messages without
a stamp are placed by their log time, relative to the log time of that first message.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast, final, NamedTuple

from lta_analysis.bag.blocks import Image, PointCloud, stacked_blocks, stacked_clouds
from lta_analysis.bag.columns import columns
from lta_analysis.bag.reader import Bag, read_bag
from lta_analysis.bag.series import Series
from lta_analysis.bag.stamps import stamp_of
from lta_bridge.provenance import part
from lta_config.errors import BadInput, unknown
import numpy as np
from numpy.typing import NDArray


class Origin(NamedTuple):
    """The start of a flight on both clocks. [ns]"""

    stamp: int
    log: int


class Blocks(NamedTuple):
    """ADC blocks: stamp of the first sample in s, shape (n,); samples (n, rows, columns)."""

    time: NDArray[np.float64]
    samples: NDArray[Any]


class Points(NamedTuple):
    """Point lists: stamps in s, shape (n,); values by field, each of shape (n, points)."""

    time: NDArray[np.float64]
    fields: dict[str, NDArray[np.float64]]


@final
class Flight:
    """
    One robot's part of a bag; see `open_flight`.

    Attributes
    ----------
    bag : Bag
        The recording.
    robot : str
        The robot's namespace without slash; '' if the bag has none.
    start : int
        Time 0 of all series, as a stamp. [ns]
    provenance : dict of str to str
        Where the robot's data come from.

    """

    def __init__(self, bag: Bag, robot: str) -> None:
        self.bag = bag
        self.robot = robot
        self.provenance = part(bag.provenance, robot)
        self._origin = origin(bag, [self._absolute(name) for name in self.topics])
        self.start = self._origin.stamp

    @property
    def topics(self) -> list[str]:
        """The robot's topics, relative to its namespace."""
        prefix = self._absolute('')
        return [name.removeprefix(prefix) for name in self.bag.topics if name.startswith(prefix)]

    def series(self, topic: str) -> Series:
        """
        Return the fields of a topic over time.

        Parameters
        ----------
        topic : str
            Relative to the robot ('odom'), or absolute ('/clock').

        Raises
        ------
        BadInput
            If the topic is not in the bag or cannot be decoded.

        """
        times: list[float] = []
        numbers, texts = columns(self._timed(topic, times))
        return Series(np.array(times, dtype=np.float64), numbers, texts)

    def blocks(self, topic: str) -> Blocks:
        """Return the samples of a topic of sensor_msgs/Image; errors as `series`."""
        times: list[float] = []
        self._require(topic, 'sensor_msgs/msg/Image')
        samples = stacked_blocks(cast('list[Image]', list(self._timed(topic, times))))
        return Blocks(np.array(times, dtype=np.float64), samples)

    def points(self, topic: str) -> Points:
        """Return the values of a topic of sensor_msgs/PointCloud2; errors as `series`."""
        times: list[float] = []
        self._require(topic, 'sensor_msgs/msg/PointCloud2')
        fields = stacked_clouds(cast('list[PointCloud]', list(self._timed(topic, times))))
        return Points(np.array(times, dtype=np.float64), fields)

    def _absolute(self, topic: str) -> str:
        """Return the name of a topic in the bag."""
        if topic.startswith('/'):
            return topic
        return f'/{self.robot}/{topic}' if self.robot else f'/{topic}'

    def type_of(self, topic: str) -> str:
        """Return a topic's message type; `BadInput` if the topic is not in the bag."""
        name = self._absolute(topic)
        if name not in self.bag.topics:
            raise unknown('topic', topic, self.topics)
        return self.bag.topics[name].type_name

    def _require(self, topic: str, type_name: str) -> None:
        """Raise BadInput unless the topic is in the bag and of the type."""
        found = self.type_of(topic)
        if found != type_name:
            raise BadInput(f"Topic '{topic}' is of type '{found}', not '{type_name}'.")

    def _timed(self, topic: str, times: list[float]) -> Iterator[object]:
        """Yield the messages of a topic and add their times to `times`. [s]"""
        name = self._absolute(topic)
        if name not in self.bag.topics:
            raise unknown('topic', topic, self.topics)
        for _, log_time, data in self.bag.messages([name]):
            message = self.bag.decode(name, data)
            stamp = stamp_of(message)
            elapsed = log_time - self._origin.log if stamp is None else stamp - self.start
            times.append(elapsed * 1e-9)
            yield message


def origin(bag: Bag, topics: list[str]) -> Origin:
    """Return the start of a flight: its first stamped message, or else its first message."""
    stampless = set()
    for topic, log_time, data in bag.messages(topics):
        if topic in stampless:
            continue
        stamp = stamp_of(bag.decode(topic, data))
        if stamp is not None:
            return Origin(stamp, log_time)
        stampless.add(topic)
    first = bag.start or 0
    return Origin(first, first)


def namespaces(bag: Bag) -> list[str]:
    """Return the robots in a bag: the first parts of names such as /lta1/odom."""
    return sorted({name.split('/')[1] for name in bag.topics if name.count('/') > 1})


def open_flight(source: Bag | Path | str, robot: str | None = None) -> Flight:
    """
    Open a recorded flight.

    Parameters
    ----------
    source : Bag, Path or str
        An opened bag, or where it is.
    robot : str, optional
        Namespace of the robot; needed only where the bag holds several.

    Raises
    ------
    BadInput
        If there is no recording, or the robot is unknown or not the only one.

    """
    bag = source if isinstance(source, Bag) else read_bag(source)
    return Flight(bag, chosen(bag, robot))


def chosen(bag: Bag, robot: str | None) -> str:
    """Return the robot to look at: the one that is named, or the only one; see `open_flight`."""
    found = namespaces(bag)
    if robot is not None and robot not in found:
        raise unknown('robot', robot, found)
    if robot is None and len(found) > 1:
        raise BadInput(
            f"'{bag.path}' holds several robots ({', '.join(found)}); name the one to look at, as "
            f'in --robot {found[-1]}.'
        )
    return robot or (found[0] if found else '')
