"""
Topics of a bag as tables: one row a message, one column a number in it, named by its path.

`/tf#drone` is a table of its own: the transforms of one child frame among those of a topic.
"""

from collections.abc import (
    Callable,
    Collection,
    Container,
    Iterable,
    Iterator,
    Mapping,
    Sequence,
)
from typing import Any, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.import_file import Entry, Orientation, Scalar, Vector
from lta_config.schema.import_file import Mapping as MappingFile
from lta_data.bag.columns import columns
from lta_data.bag.stamps import stamp_of
from lta_data.foreign.protocol import Reached
from lta_data.foreign.shapes import Part, SHAPES
from lta_data.foreign.table import Numbers, Table
import numpy as np

TRANSFORMS = 'tf2_msgs/msg/TFMessage'
PIECE = 10_000  # decoded messages kept before they become numbers
CHILD = '#'  # between a topic of transforms and a child frame
Decode = Callable[[], object]


def _pose(position: str, orientation: str) -> Mapping[str, Part]:
    return {
        'position': Part(position, 'm', 'vector', 'world'),
        'orientation': Part(orientation, '', 'attitude'),
    }


# What types beside those that we import into tell, by the names of our parts.
FURTHER: Mapping[str, Mapping[str, Part]] = {
    'geometry_msgs/msg/PoseWithCovarianceStamped': _pose(
        'pose.pose.position', 'pose.pose.orientation'
    ),
    'geometry_msgs/msg/TransformStamped': _pose('transform.translation', 'transform.rotation'),
    TRANSFORMS: _pose('transform.translation', 'transform.rotation'),
    'geometry_msgs/msg/TwistWithCovarianceStamped': {
        'velocity': Part('twist.twist.linear', 'm/s', 'vector', 'body'),
        'rates': Part('twist.twist.angular', 'rad/s', 'axial', 'body'),
    },
}


@final
class Met(NamedTuple):
    """A decoded message: its place in the bag, its log time in ns, and itself."""

    order: int
    log_time: int
    message: object


def table_of(met: Iterable[Met]) -> Table:
    """Return messages of one type as a table; without a stamp of its own, one has its log time."""
    listed = list(met)
    numbers, _ = columns(one.message for one in listed)
    stamps = [stamp_of(one.message) for one in listed]
    times = np.array([one.log_time for one in listed], dtype=np.int64)
    own = [
        one.log_time if stamp is None else stamp for one, stamp in zip(listed, stamps, strict=True)
    ]
    return Table(
        np.array(own, dtype=np.int64),
        times,
        np.array([one.order for one in listed], dtype=np.int64),
        {path: np.asarray(values, dtype=np.float64) for path, values in numbers.items()},
    )


@final
class Rows:
    """Collects the messages of a table; decoded ones are kept only until there are some."""

    def __init__(self) -> None:
        self._met: list[Met] = []
        self._parts: list[Table] = []

    def add(self, more: Iterable[Met]) -> None:
        """Take the next messages."""
        self._met += more
        if len(self._met) >= PIECE:
            self._pack()

    def table(self) -> Table | None:
        """Return all of them as a table; None if there were none."""
        if self._met:
            self._pack()
        if not self._parts:
            return None
        names = dict.fromkeys(name for part in self._parts for name in part.columns)
        return Table(
            np.concatenate([part.stamps for part in self._parts]),
            np.concatenate([part.log_times for part in self._parts]),
            np.concatenate([part.order for part in self._parts]),
            {name: self._column(name) for name in names},
        )

    def _pack(self) -> None:
        self._parts.append(table_of(self._met))
        self._met = []

    def _column(self, name: str) -> Numbers:
        """Return a column of all parts; NaN in those that do not have it."""
        return np.concatenate(
            [part.columns.get(name, np.full(len(part), np.nan)) for part in self._parts]
        )


def of_child(met: Met, child: str) -> list[Met]:
    """Return the transforms of one child frame in a message."""
    transforms = getattr(met.message, 'transforms', [])
    return [Met(met.order, met.log_time, one) for one in transforms if one.child_frame_id == child]


def tables_of(
    wanted: Collection[str], known: Container[str], messages: Iterable[tuple[str, int, Decode]]
) -> dict[str, Table]:
    """
    Return the tables that are asked for and there.

    Parameters
    ----------
    wanted : collection of str
        Topics, or TOPIC#CHILD of one of transforms.
    known : container of str
        The bag's topics.
    messages : iterable of (topic, log time in ns, function that decodes it)
        All of the bag's, in its order; gone through only where something is there.

    """
    topics = {name: name.split(CHILD)[0] for name in wanted}
    there = {name: topic for name, topic in topics.items() if topic in known}
    met = {name: Rows() for name in there}
    for order, (topic, log_time, decode) in enumerate(messages if there else ()):
        takers = [name for name, told in there.items() if told == topic]
        if not takers:
            continue
        one = Met(order, log_time, decode())
        for name in takers:
            _, sign, child = name.partition(CHILD)
            met[name].add(of_child(one, child) if sign else [one])
    tables = {name: rows.table() for name, rows in met.items()}
    return {name: table for name, table in tables.items() if table is not None}


def wanted_tables(mapping: MappingFile | None) -> set[str]:
    """Return the tables that a mapping names and that must be decoded."""
    if mapping is None:
        return set()
    told = {entry.table for entry in mapping.topics if entry.table is not None}
    return told.union(*(entry.join for entry in mapping.topics))


def completed(entry: Entry, type_name: str, target: str) -> Entry:
    """
    Return an entry that says which numbers of a message are meant, where it says nothing.

    Parameters
    ----------
    entry : Entry
        As the mapping has it.
    type_name : str
        Type of the messages in the bag.
    target : str
        Type of our topic.

    Raises
    ------
    BadInput
        If nothing is known of how one becomes the other.

    """
    if entry.parts or entry.actuators:
        return entry
    theirs = FURTHER.get(type_name) or SHAPES.get(type_name, {})
    shared = {name: part for name, part in theirs.items() if name in SHAPES[target]}
    if not shared:
        raise BadInput(
            f"Topic '{entry.table}' is of type '{type_name}', of which nothing is known to belong "
            f'into {entry.topic}; name the fields in the mapping.'
        )
    return entry.model_copy(update={name: _given(part) for name, part in shared.items()})


def _given(part: Part) -> Any:  # noqa: ANN401 - one of three records
    """Return a part as a mapping would name it."""
    if part.kind == 'attitude':
        return Orientation(quaternion=[f'{part.place}.{axis}' for axis in 'xyzw'])
    if part.kind == 'number':
        return Scalar(column=part.place, unit=part.dimension, over=part.share * 1.0)
    return Vector(columns=[f'{part.place}.{axis}' for axis in 'xyz'], unit=part.dimension)


def fits_unchanged(entry: Entry, mapping: MappingFile, theirs: str, ours: str) -> bool:
    """Tell whether a topic's messages can be taken as they are, under our name."""
    told = entry.parts or entry.actuators or entry.where or entry.world or entry.body
    return theirs == ours and not told and mapping.world is None and mapping.body is None


class BagTables:
    """What a log of bags tells of its tables, which are made when it is opened."""

    _tables: Mapping[str, Table]

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """The columns of the tables that the mapping names."""
        return {name: list(table.columns) for name, table in self._tables.items()}

    def tables(
        self, wanted: Mapping[str, Collection[str]], reached: Reached
    ) -> Iterator[Mapping[str, Table]]:
        """Yield the tables that the mapping names."""
        yield {name: self._tables[name] for name in wanted}
