# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Open the recorded flight of one robot: numpy arrays and pandas tables on one clock.

    import lta_analysis
    flight = lta_analysis.open()                # the newest in runs/, or a bag by its path
    odom = flight['odom']                       # read on first access, then cached
    odom['pose.pose.position.z'], odom.attrs['units']
    flight.align_topics('odom', 'ground_truth/odom', rate=50.0, method='linear')

Time 0 is the stamp of the robot's first stamped message. Messages without a stamp are placed by
their log time, relative to the log time of that first message.
"""

from collections.abc import Collection, Iterator, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, Final, final, NamedTuple

from lta_bag.bag_folder import find_bag, find_newest_bag
from lta_bag.provenance import extract_robot_origin
from lta_bag.reader import Bag, read_bag
from lta_bag.version_1 import refuse_old_bag
from lta_config.errors import BadInput, format_count, unknown_name_error
from lta_data.bag.column_builder import ColumnBuilder, MessageColumns, MessageType
from lta_data.bag.columns import (
    extract_stamp,
    LAMP_PEAKS,
    LIGHT_BLOCK,
    stack_blocks,
    stack_points,
)
from lta_data.bag.flight_views import build_dataset, draw_columns
from lta_data.bag.table import (
    align_tables,
    build_even_clock,
    build_table,
    name_columns,
    name_point_columns,
    sort_stamps,
    Table,
)
import numpy as np
from numpy.typing import NDArray

# Topics that only draw a robot: every viewer reads them, and no analysis does
URDF = 'robot_description'
MARKERS = 'visualization_msgs/msg/MarkerArray'
LATEST_STAMP: Final = int(
    np.iinfo(np.int64).max
)  # ns; MCAP log times are unsigned, ROS stamps are not


class FlightOrigin(NamedTuple):
    """The start of a flight on the clocks of the stamps and of the log [ns]."""

    stamp: int
    log: int


class SampleBlocks(NamedTuple):
    """ADC blocks: stamp of the first sample in s, shape (n,); samples (n, rows, columns)."""

    time: NDArray[np.float64]
    samples: NDArray[Any]


@final
class RecordedFlight:
    """
    The data of one robot in a bag; see `open_flight`.

    Attributes
    ----------
    robot : str
        The robot's namespace without slash; '' if the bag has none.
    start : int
        Time 0 of all series, as a stamp. [ns]
    provenance : dict of str to str
        Origin of the robot's data.

    """

    def __init__(self, bag: Bag, robot: str) -> None:
        refuse_old_bag(bag.path, bag.types, bag.provenance)
        self.bag = bag
        self.robot = robot
        self.provenance = extract_robot_origin(bag.provenance, robot)
        self._origin = find_flight_origin(bag, [self.absolute_name(name) for name in self.topics])
        self.start = self._origin.stamp
        self._tables: dict[str, Table] = {}

    @property
    def topics(self) -> list[str]:
        """Return the robot's topics, below its namespace, without those that only draw it."""
        prefix = self.absolute_name('')
        return [
            name.removeprefix(prefix)
            for name, topic in self.bag.topics.items()
            if name.startswith(prefix)
            and name != self.absolute_name(URDF)
            and topic.type_name != MARKERS
        ]

    @property
    def losses(self) -> list[str]:
        """Damage found so far, one sentence each."""
        return list(self.bag.losses)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the topics."""
        return iter(self.topics)

    def _ipython_key_completions_(self) -> list[str]:
        """Return what a notebook completes after `flight[`."""
        return self.topics

    def __getitem__(self, topic: str) -> Table:
        """Return a topic as a `pandas.DataFrame`, read once; see `lta_data.bag.table`."""
        self.message_type(topic)  # refuses what is no topic
        if topic not in self._tables:
            self._tables |= self.read_tables([topic])
        return self._tables[topic]

    def read_tables(self, topics: Collection[str]) -> dict[str, Table]:
        """
        Return several topics as tables, read in one pass over the bag and not kept.

        A topic is relative to the robot ('odom'), or absolute ('/clock'). Raise `BadInput` if one
        is not in the bag or cannot be decoded.
        """
        kinds = {topic: self.message_type(topic) for topic in topics}
        makers = {
            self.absolute_name(topic): self._create_column_builder(topic)
            for topic, kind in kinds.items()
            if kind != LAMP_PEAKS
        }
        for name, log_time, data in self.bag.iterate_messages(list(makers)):
            makers[name].add_message(log_time, data)
        columns = {name: maker.flush_columns() for name, maker in makers.items()}
        return {
            topic: self._build_point_table(topic)
            if kind == LAMP_PEAKS
            else self._build_table(topic, kind, columns[self.absolute_name(topic)])
            for topic, kind in kinds.items()
        }

    def align_topics(
        self,
        *topics: str,
        rate: float | None = None,
        on: str | None = None,
        method: str = 'previous',
        gap: float | None = None,
    ) -> Table:
        """
        Return several topics as one `pandas.DataFrame` on one clock.

        Parameters
        ----------
        *topics : str
            The topics; a column is named 'odom/pose.pose.position.x'.
        rate : float, optional
            Rate of an even clock from the first to the last message of all. [Hz]
        on : str, optional
            Topic whose stamps are the clock; without a rate the first topic by default.
        method : str
            'previous' (latest value) or 'linear' (interpolation; the shorter way for quaternions).
        gap : float, optional
            Maximum gap of a topic; longer gaps are NaN. Three of its periods by default. [s]

        Raises
        ------
        BadInput
            If a topic or the method is unknown, or both `rate` and `on` are given.

        """
        if rate is not None and on is not None:
            raise BadInput(
                f"Both rate={rate} Hz and on='{on}' were given to align the topics; give only one."
            )
        if not topics:
            raise BadInput(
                f'No topics to align were given; choose from: {", ".join(sorted(self.topics))}.'
            )
        tables = [self[topic] for topic in topics]
        clock = (
            sort_stamps(self[on or topics[0]])[0]
            if rate is None
            else build_even_clock(tables, rate)
        )
        return align_tables(tables, clock, method, gap)

    def to_xarray(self, *topics: str, **clock: Any) -> Any:
        """
        Return topics as one `xarray.Dataset` over `time`; arguments as `align_topics`.

        A variable is named 'odom.pose.pose.position.x'; its `attrs` are `units` and `frame`, the
        frame of the message. Raise `BadInput` as `align_topics`, and without xarray.
        """
        aligned = self.align_topics(*topics, **clock)
        return build_dataset(aligned, {topic: self[topic] for topic in topics})

    def plot(self, topic: str, *columns: str, axes: Any = None) -> Any:
        """
        Plot columns of a topic over time in s, and return the axes of matplotlib.

        `columns` have one unit; 'pose.pose.position' stands for its x, y and z. `axes`: those of
        another plot to draw in. Raise `BadInput` for an unknown name, for several units, and
        without matplotlib.
        """
        return draw_columns(self[topic], columns, axes)

    def __repr__(self) -> str:
        """Return a summary with one line per topic."""
        bag = self.bag
        names = {topic: self.absolute_name(topic) for topic in self.topics}
        width = max(map(len, names), default=0)
        of = f' of {self.robot}' if self.robot else ''
        lines = [f'{bag.path}: {format_count(len(names), "topic")}{of}, {bag.duration:.1f} s']
        for topic, name in names.items():
            entry = bag.topics[name]
            lines.append(f'  {topic:{width}}  {entry.count:8}  {entry.type_name}')
        return '\n'.join([*lines, *self.losses])

    def read_blocks(self, topic: str, chosen: Collection[int] | None = None) -> SampleBlocks:
        """
        Return the samples of a topic of ADC blocks; errors as `read_tables`.

        `chosen` are the message numbers to read, counted from 0; the result is in the order of
        recording.
        """
        stamps: list[int] = []
        self._require_type(topic, LIGHT_BLOCK)
        messages = self._iterate_messages(
            topic, stamps, None if chosen is None else frozenset(chosen)
        )
        samples = stack_blocks(messages)
        return SampleBlocks(self._compute_times(stamps), samples)

    def iterate_blocks(self, topic: str, rows: int) -> Iterator[SampleBlocks]:
        """Yield the samples of such a topic, `rows` messages at a time."""
        self._require_type(topic, LIGHT_BLOCK)
        stamps: list[int] = []
        messages = self._iterate_messages(topic, stamps)
        while batch := list(islice(messages, rows)):
            # The iterator appends the stamps while islice reads the messages
            yield SampleBlocks(self._compute_times(stamps), stack_blocks(batch))
            stamps.clear()

    def read_log_times(self, topics: Collection[str]) -> dict[str, NDArray[np.int64]]:
        """Return the log times of the messages of topics, each of shape (n,) [ns]."""
        times: dict[str, list[int]] = {self.absolute_name(topic): [] for topic in topics}
        for name, log_time, _ in self.bag.iterate_messages([*times]):
            # One that no stamp can have is the latest
            times[name].append(min(log_time, LATEST_STAMP))
        return {
            topic: np.array(times[self.absolute_name(topic)], dtype=np.int64) for topic in topics
        }

    def absolute_name(self, topic: str) -> str:
        """Return the absolute name of a topic; raise `BadInput` if it is no text."""
        if not isinstance(topic, str):
            raise BadInput(
                f'The topic is {topic!r}, but must be a text; give each topic as an argument of '
                'its own.'
            )
        if topic.startswith('/'):
            return topic
        return f'/{self.robot}/{topic}' if self.robot else f'/{topic}'

    def message_type(self, topic: str) -> str:
        """Return a topic's message type; raise `BadInput` if the topic is not in the bag."""
        name = self.absolute_name(topic)
        if name not in self.bag.topics:
            raise unknown_name_error('topic', topic, self.topics)
        return self.bag.topics[name].type_name

    def _require_type(self, topic: str, expected: str) -> None:
        """Raise `BadInput` unless a topic has messages of one type."""
        actual = self.message_type(topic)
        if actual != expected:
            raise BadInput(
                f"Topic '{topic}' has type '{actual}', not '{expected}'; choose a topic of this "
                'type.'
            )

    def _create_column_builder(self, topic: str) -> ColumnBuilder:
        """Return a builder of the topic's columns."""
        kind, name = self.message_type(topic), self.absolute_name(topic)
        return ColumnBuilder(
            MessageType(kind, self.bag.list_fields, partial(self.bag.decode, name))
        )

    def _build_table(self, topic: str, kind: str, columns: MessageColumns) -> Table:
        """Return the collected messages of a topic as a table."""
        stamps = columns.stamps
        for index in np.flatnonzero(stamps == 0):
            stamps[index] = self._place_log_time(int(columns.logged[index]))
        named = name_columns(columns.numbers, columns.texts, kind, topic)
        return build_table(topic, self.start, stamps, *named)

    def _build_point_table(self, topic: str) -> Table:
        """Return the readings of a topic of lamp peaks as a table."""
        stamps: list[int] = []
        fields = stack_points(self._iterate_messages(topic, stamps))
        named = name_point_columns(fields, topic)
        return build_table(topic, self.start, np.array(stamps, np.int64), *named)

    def _iterate_messages(
        self, topic: str, stamps: list[int], chosen: Collection[int] | None = None
    ) -> Iterator[object]:
        """Yield messages of a topic and append their stamps to `stamps` [ns]."""
        name = self.absolute_name(topic)
        if name not in self.bag.topics:
            raise unknown_name_error('topic', topic, self.topics)
        for index, (_, log_time, data) in enumerate(self.bag.iterate_messages([name])):
            if chosen is not None and index not in chosen:
                continue
            message = self.bag.decode(name, data)
            stamp = extract_stamp(message)
            stamps.append(self._place_log_time(log_time) if stamp is None else stamp)
            yield message

    def _place_log_time(self, log_time: int) -> int:
        """Return a log time on the clock of the stamps, for a message without a stamp [ns]."""
        return min(self.start + log_time - self._origin.log, LATEST_STAMP)

    def _compute_times(self, stamps: Sequence[int]) -> NDArray[np.float64]:
        """Return stamps as times since the start [s]."""
        # Subtract as integers first: float64 does not resolve 1 ns in times since 1970
        return (np.array(stamps, np.int64) - self.start).astype(np.float64) * 1e-9


def find_flight_origin(bag: Bag, topics: list[str]) -> FlightOrigin:
    """Return the start of a flight: its first stamped message, or its first message."""
    stampless = set()
    for topic, log_time, data in bag.iterate_messages(topics):
        if topic in stampless:
            continue
        try:
            stamp = extract_stamp(bag.decode(topic, data))
        except BadInput:  # other topics may still be readable
            stamp = None
        if stamp is not None:
            return FlightOrigin(stamp, log_time)
        # Decode one message per topic only: either all have a stamp or none
        stampless.add(topic)
    first = bag.start or 0
    return FlightOrigin(first, first)


# Topics that only a robot has
ROBOT_TOPICS: Final = ('ground_truth/odom', 'odom', 'motors', 'wrench_command')


def list_robots(bag: Bag) -> list[str]:
    """Return the robots in a bag: the first parts of names such as /lta1/odom."""
    return sorted({name.split('/')[1] for name in bag.topics if name.count('/') > 1})


def open_flight(
    source: Bag | Path | str | None = None, robot: str | None = None
) -> RecordedFlight:
    """
    Open the recorded flight of a robot; `lta_analysis.open` is this function.

    `source` is a rosbag2 folder, an .mcap file, or a flight's results folder; without it, the
    newest recording in runs/ of the current folder. `robot` is its namespace; it is required only
    if the bag has several robots.

    Raise `BadInput` if there is no recording, or the robot is unknown or ambiguous.
    """
    if not isinstance(source, Bag | Path | str | None):
        raise BadInput(f'source is {source!r}, but must be the path of a recording.')
    if not isinstance(source, Bag):
        source = read_bag(find_newest_bag() if source is None else find_bag(Path(source)))
    return RecordedFlight(source, select_robot(source, robot))


def select_robot(bag: Bag, robot: str | None) -> str:
    """Return the named robot, or the only one; see `open_flight`."""
    robots = list_robots(bag)
    robot = None if robot is None else robot.strip('/')
    if robot is not None and robot not in robots:
        raise unknown_name_error('robot', robot, robots)
    if robot is None and len(robots) > 1:
        # An imported bag keeps the topics of others: /joy/set_feedback is of no robot
        flying = [
            one for one in robots if any(f'/{one}/{topic}' in bag.topics for topic in ROBOT_TOPICS)
        ]
        robots = flying or robots
    if robot is None and len(robots) > 1:
        raise BadInput(
            f"'{bag.path}' contains several robots ({', '.join(robots)}); choose one, as in "
            f'--robot {robots[-1]}.'
        )
    return robot or (robots[0] if robots else '')
