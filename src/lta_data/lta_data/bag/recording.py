"""
Open a recording in a notebook.

    import lta_analysis
    flight = lta_analysis.open()                # the newest in runs/, or a bag by its path
    odom = flight['odom']                       # read on first access, then cached
    odom.time, odom['pose.pose.position.z'], odom.units
    both = flight.align_topics('odom', 'ground_truth/odom', rate=50.0, method='linear')
    both.to_pandas()

Each topic is read on first access. See `docs/analysis.md`.
"""

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
import re
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_data.bag.align import align_tables, build_even_clock, sort_rows
from lta_data.bag.bag_folder import find_bag, find_newest_bag
from lta_data.bag.packed_samples import LAMP_PEAKS, LIGHT_BLOCK
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_data.bag.series import TopicSeries
from lta_data.bag.table import RecordingTable
from lta_data.bag.units import find_unit
from lta_report.formatting import format_count
import numpy as np
from numpy.typing import NDArray

ELEMENT: Final = re.compile(r'(\w+)\[(\d+)\]')


def open_recording(bag: Path | str | None = None, robot: str | None = None) -> 'RobotRecording':
    """
    Open a recording; `lta_analysis.open` is this function.

    `bag` is a rosbag2 folder, an .mcap file, or a flight's results folder; without it, the newest
    recording in runs/ of the current folder. `robot` is the namespace of the robot, required only
    if the bag has several.

    Raise `BadInput` if there is no recording, or the robot is unknown or ambiguous.
    """
    folder = find_newest_bag() if bag is None else find_bag(Path(bag))
    return RobotRecording(open_flight(folder, robot))


@final
class RobotRecording:
    """
    The data of one robot in a recording, its topics as tables.

    Attributes
    ----------
    flight : RecordedFlight
        The underlying flight.

    """

    def __init__(self, flight: RecordedFlight) -> None:
        self.flight = flight
        self._tables: dict[str, RecordingTable] = {}

    @property
    def topics(self) -> list[str]:
        """The robot's topics, relative to its namespace."""
        return self.flight.topics

    @property
    def robot(self) -> str:
        """The robot's namespace; '' if the bag has none."""
        return self.flight.robot

    @property
    def provenance(self) -> dict[str, str]:
        """The origin of the recording."""
        return self.flight.provenance

    @property
    def losses(self) -> list[str]:
        """Damage found so far, one sentence each."""
        return list(self.flight.bag.losses)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the topics."""
        return iter(self.topics)

    def __len__(self) -> int:
        """Return the number of topics."""
        return len(self.topics)

    def __contains__(self, topic: object) -> bool:
        """Return whether the robot has a topic."""
        return topic in self.topics

    def __getitem__(self, topic: str) -> RecordingTable:
        """
        Return a topic as a table.

        `topic` is relative to the robot ('odom'), or absolute ('/clock').

        Raise `BadInput` if the topic is not in the bag or cannot be decoded.
        """
        if topic not in self._tables:
            self._tables[topic] = read_table(self.flight, topic)
        return self._tables[topic]

    def clear_cache(self) -> None:
        """Discard the tables that were read."""
        self._tables.clear()

    def align_topics(
        self,
        *topics: str,
        rate: float | None = None,
        on: str | None = None,
        method: str = 'previous',
        gap: float | None = None,
    ) -> RecordingTable:
        """
        Return several topics as one table on one clock.

        Parameters
        ----------
        *topics : str
            The topics; a column is named 'odom/pose.pose.position.x'.
        rate : float, optional
            Rate of an even clock from the first to the last message of all. [Hz]
        on : str, optional
            Topic whose stamps are the clock; without a rate the first topic by default.
        method : str
            'previous' (latest value) or 'linear' (interpolation; slerp for quaternions).
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
        tables = [self[topic] for topic in topics]
        if not tables:
            raise BadInput(
                f'No topics to align were given; choose from: {", ".join(sorted(self.topics))}.'
            )
        if rate is not None:
            clock = build_even_clock(tables, rate)
        else:
            clock = sort_rows(self[on or topics[0]].stamp_ns).stamps
        return align_tables(tables, clock, method, gap)

    def __repr__(self) -> str:
        """Return a summary with one line per topic."""
        bag = self.flight.bag
        names = {topic: self.flight.absolute_name(topic) for topic in self.topics}
        width = max(map(len, names), default=0)
        seconds = 0.0 if bag.start is None or bag.end is None else (bag.end - bag.start) * 1e-9
        of = f' of {self.robot}' if self.robot else ''
        lines = [f'{bag.path}: {format_count(len(names), "topic")}{of}, {seconds:.1f} s']
        for topic, name in names.items():
            entry = bag.topics[name]
            lines.append(f'  {topic:{width}}  {entry.count:8}  {entry.type_name}')
        return '\n'.join([*lines, *self.losses])


def read_table(flight: RecordedFlight, topic: str) -> RecordingTable:
    """Return a topic of a flight as a table; errors as `RobotRecording.__getitem__`."""
    kind = flight.message_type(topic)
    unit = partial(find_unit, kind, topic=topic)
    if kind == LAMP_PEAKS:
        points = flight.read_points(topic)
        stamps = flight.start + np.rint(points.time * 1e9).astype(np.int64)
        data = {
            f'{field}[{index}]': column
            for field, table in points.fields.items()
            for index, column in enumerate(table.T)
        }
        units = {name: unit(name.partition('[')[0]) for name in data}
        return RecordingTable(topic, stamps, flight.start, data, units, kind)
    return build_topic_table(flight, topic, flight.read_series(topic))


def build_topic_table(
    flight: RecordedFlight,
    topic: str,
    series: TopicSeries,
    joints: Mapping[str, str] | None = None,
) -> RecordingTable:
    """
    Return all or some messages of a topic as a table.

    `joints` maps column paths to new names; `map_joint_names` by default.
    """
    kind = flight.message_type(topic)
    joints = map_joint_names(series) if joints is None else joints
    data = {joints.get(path, path): values for path, values in series.numbers.items()}
    units = {joints.get(path, path): find_unit(kind, path, topic) for path in series.numbers}
    data |= series.texts
    samples = partial(read_samples, flight, topic) if kind == LIGHT_BLOCK else None
    return RecordingTable(
        topic, series.stamps, flight.start, data, units, kind, samples=samples, also=joints
    )


def map_joint_names(series: TopicSeries) -> dict[str, str]:
    """Return 'effort.left' for 'effort[0]' if all messages name their element 0 'left'."""
    names_by_path = {}
    for path in series.numbers:
        element = ELEMENT.fullmatch(path)
        names = series.texts.get(f'name[{element.group(2)}]') if element else None
        if element and names is not None and len(names) and names[0] and (names == names[0]).all():
            names_by_path[path] = f'{element.group(1)}.{names[0]}'
    return names_by_path if len(set(names_by_path.values())) == len(names_by_path) else {}


def read_samples(flight: RecordedFlight, topic: str, messages: NDArray[np.intp]) -> NDArray[Any]:
    """Return the samples of some messages of a topic of blocks, shape (n, rows, columns)."""
    return flight.read_blocks(topic, messages.tolist()).samples
