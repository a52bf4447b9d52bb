# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Represent the messages of a topic as one array per field, and their stamps.

`column_builder` gives the same result for whole topics, without an object for each message.
"""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cache
from typing import Any, Final, final, NamedTuple, Protocol

from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

SECOND_NS: Final = 1_000_000_000  # ns
# Paths of the stamp: first transform, header, or clock.
STAMP_PATHS: Final = ('transforms[0].header.stamp', 'header.stamp', 'clock')


def extract_stamp(message: object) -> int | None:
    """
    Return the stamp of a decoded message, from its header, first transform or clock [ns].

    None if there is no stamp or it is zero, that is, unfilled.
    """
    transforms = getattr(message, 'transforms', None)
    stamped = transforms[0] if transforms else message
    header = getattr(stamped, 'header', None)
    time = getattr(stamped, 'clock', None) if header is None else getattr(header, 'stamp', None)
    seconds, rest = getattr(time, 'sec', None), getattr(time, 'nanosec', None)
    if seconds is None or rest is None:
        return None
    return int(seconds) * SECOND_NS + int(rest) or None


def find_stamp_path(paths: Collection[str]) -> str | None:
    """Return the path of the stamp among the paths of a message's fields; None without a stamp."""
    for place in STAMP_PATHS:
        if f'{place}.sec' in paths and f'{place}.nanosec' in paths:
            return place
    return None


Columns = dict[str, NDArray[Any]]
Rows = slice | NDArray[np.intp]


class ColumnPiece(NamedTuple):
    """A field of some messages: their rows, and values of shape (n,) or (n, elements)."""

    rows: Rows
    values: NDArray[Any]


@final
@dataclass(slots=True)
class PiecewiseColumn:
    """
    A field in pieces.

    `first` is its first occurrence: number of the message, and position in the message.
    """

    first: tuple[int, int]
    pieces: list[ColumnPiece] = field(default_factory=list)
    count: int = 0  # of messages that have it

    def add_piece(self, first: tuple[int, int], rows: Rows, values: NDArray[Any]) -> None:
        """Add the values of some messages."""
        self.first = min(self.first, first)
        self.pieces.append(ColumnPiece(rows, values))
        self.count += len(values)


def merge_columns(columns: dict[str, PiecewiseColumn], count: int) -> tuple[Columns, Columns]:
    """
    Return numbers and texts by path, in the order of first occurrence, for `count` messages.

    Removes the merged columns from `columns`, which frees their memory.
    """
    numbers: Columns = {}
    texts: Columns = {}
    for path in sorted(columns, key=lambda path: columns[path].first):
        # Remove each column once merged, so that the pieces do not double the memory
        column = columns.pop(path)
        values = column.pieces[0].values
        if values.ndim == 2:
            table = merge_arrays(column, count)
            numbers |= {f'{path}[{index}]': table[:, index] for index in range(table.shape[1])}
        elif values.dtype.kind == 'U':
            texts[path] = merge_texts(column, count)
        else:
            numbers[path] = merge_numbers(column, count)
    return numbers, texts


def merge_arrays(column: PiecewiseColumn, count: int) -> NDArray[Any]:
    """Return an array field, shape (n, longest); short arrays end in NaN."""
    lengths = {piece.values.shape[1] for piece in column.pieces}
    if len(lengths) == 1 and column.count == count:
        (length,) = lengths
        table = np.empty((count, length), column.pieces[0].values.dtype)
    else:
        table = np.full((count, max(lengths)), np.nan)
    for rows, values in column.pieces:
        table[rows, : values.shape[1]] = values
    return table


def merge_texts(column: PiecewiseColumn, count: int) -> NDArray[Any]:
    """Return a text field, shape (n,); '' if a message lacks it."""
    longest = max(piece.values.dtype.itemsize for piece in column.pieces)
    # numpy stores four bytes per character
    result = np.full(count, '', f'U{longest // np.dtype("U1").itemsize}')
    for rows, values in column.pieces:
        result[rows] = values
    return result


def merge_numbers(column: PiecewiseColumn, count: int) -> NDArray[Any]:
    """Return a field of single numbers, shape (n,); NaN if a message lacks it."""
    kinds = {piece.values.dtype for piece in column.pieces}
    large = np.dtype(np.uint64)
    kind = large if large in kinds else next(iter(kinds))
    result = np.full(count, np.nan) if column.count < count else np.empty(count, kind)
    for rows, values in column.pieces:
        result[rows] = values
    if result.dtype == large and result.max() <= np.iinfo(np.int64).max:
        return result.astype(np.int64)  # numpy's default type for integers that fit
    return result


# Fields of lta_msgs by type: the name of their columns, '' for none.
COLUMN_NAMES: Final = {
    'lta_msgs/msg/ActuatorDuty': {'duty': 'effort'},  # as an import, which may know a force
    'lta_msgs/msg/LampPeaks': {'axis': '', 'beacon': ''},  # as points, see packed_samples.py
    'lta_msgs/msg/LightBlock': {'counts': ''},  # as blocks
}


def extract_field_columns(messages: Iterable[object]) -> tuple[Columns, Columns]:
    """
    Return the numbers and texts of messages of one type by field path.

    Returns
    -------
    numbers : dict of str to ndarray, shape (n,)
        'pose.pose.position.x', 'effort[0]'; NaN if a message lacks the element. Byte arrays
        (data of images and point clouds) are left out.
    texts : dict of str to ndarray of str, shape (n,)
        'header.frame_id', 'name[0]'; '' if a message lacks the element.

    """
    rows = list(enumerate(messages))
    columns: dict[str, PiecewiseColumn] = {}
    add_objects(columns, rows)
    return merge_columns(columns, len(rows))


def add_objects(columns: dict[str, PiecewiseColumn], rows: Iterable[tuple[int, object]]) -> None:
    """Add the fields of messages, with their rows, to columns."""
    alike: dict[tuple[str, int], tuple[list[int], list[Any], tuple[int, int]]] = {}
    for row, message in rows:
        for place, (path, value) in enumerate(iterate_leaves(message, '')):
            length = len(value) if isinstance(value, np.ndarray) else -1
            numbers, values, _ = alike.setdefault((path, length), ([], [], (row, place)))
            numbers.append(row)
            values.append(value)
    for (path, _), (numbers, values, first) in alike.items():
        column = columns.setdefault(path, PiecewiseColumn(first))
        column.add_piece(first, np.array(numbers), collect_scalars(values))


def collect_scalars(values: list[Any]) -> NDArray[Any]:
    """Return single values of one field, shape (n,); integers stay integers."""
    array = np.array(values)
    if array.dtype == np.float64 and all(type(value) is int for value in values):
        return np.array(values, np.uint64)  # numpy makes mixed int64 and uint64 values floats
    return array


def iterate_leaves(value: object, path: str) -> Iterator[tuple[str, object]]:
    """Yield path and value of all fields of a message; numeric arrays stay whole."""
    if isinstance(value, np.ndarray):
        # uint8 arrays are packed, such as pixels
        if value.dtype != np.uint8:
            yield path, value
    elif is_dataclass(value) and not isinstance(value, type):
        for name, column in list_field_names(type(value)):
            inside = f'{path}.{column}' if path else column
            yield from iterate_leaves(getattr(value, name), inside)
    elif isinstance(value, list):
        for index, element in enumerate(value):
            yield from iterate_leaves(element, f'{path}[{index}]')
    else:
        yield path, value


@cache
def list_field_names(message_type: type) -> tuple[tuple[str, str], ...]:
    """Return the fields of a message that become columns, with the names of the columns."""
    kind = getattr(message_type, '__msgtype__', '')
    named = ((field.name, name_column(kind, field.name)) for field in fields(message_type))
    return tuple((name, column) for name, column in named if column)


def name_column(type_name: str, field: str) -> str:
    """Return the column of a field; '' for none, as of a constant or a Python attribute."""
    # Constants are upper-case in ROS
    if not field.islower() or field.startswith('__'):
        return ''
    return COLUMN_NAMES.get(type_name, {}).get(field, field)


LIGHT_BLOCK: Final = 'lta_msgs/msg/LightBlock'
LAMP_PEAKS: Final = 'lta_msgs/msg/LampPeaks'


class LightBlockMessage(Protocol):
    """lta_msgs/LightBlock, decoded."""

    diodes: int
    counts: NDArray[np.uint16]


class Axis(Protocol):
    """geometry_msgs/Vector3, decoded."""

    x: float
    y: float
    z: float


class BeaconPeaks(Protocol):
    """lta_msgs/BeaconPeaks, decoded."""

    amplitude: NDArray[np.float32]
    snr: NDArray[np.float32]
    frequency: NDArray[np.float32]


class LampPeaks(Protocol):
    """lta_msgs/LampPeaks, decoded."""

    axis: list[Axis]
    beacon: list[BeaconPeaks]


def decode_light_block(block: LightBlockMessage) -> NDArray[Any]:
    """
    Return the samples of a lta_msgs/LightBlock.

    The result has shape (samples, diodes). Raise `BadInput` if the counts are no multiple of the
    diodes.
    """
    if not block.diodes or len(block.counts) % block.diodes:
        raise BadInput(
            f'A light block is inconsistent: {len(block.counts)} counts are no multiple of '
            f'{block.diodes} diodes; record it again.'
        )
    return block.counts.reshape(-1, block.diodes)


def stack_blocks(blocks: Iterable[Any]) -> NDArray[Any]:
    """
    Return the samples of light blocks of one shape.

    The result has shape (n, samples, diodes): (0, 0, 0) without messages.
    """
    arrays = [decode_light_block(block) for block in blocks]
    shapes = {array.shape for array in arrays}
    if len(shapes) > 1:
        raise BadInput(
            f'Light blocks of different shapes ({", ".join(map(str, sorted(shapes)))}) cannot be '
            'combined into one array; read them one by one.'
        )
    return np.stack(arrays) if arrays else np.empty((0, 0, 0), np.uint16)


def decode_lamp_peaks(peaks: LampPeaks) -> dict[str, NDArray[np.float64]]:
    """
    Return a lta_msgs/LampPeaks by field.

    Returns
    -------
    dict of str to ndarray, shape (beacons * diodes,)
        Axis x, y, z, amplitude, snr and frequency, beacon by beacon.

    Raises
    ------
    BadInput
        If a beacon has not one value for each diode.

    """
    count = len(peaks.axis)
    columns = {
        name: np.tile([getattr(axis, name) for axis in peaks.axis], len(peaks.beacon))
        for name in ('x', 'y', 'z')
    }
    for name in ('amplitude', 'snr', 'frequency'):
        rows: list[NDArray[np.float32]] = [getattr(beacon, name) for beacon in peaks.beacon]
        if any(len(row) != count for row in rows):
            raise BadInput(
                f'A message of lamp peaks is inconsistent: it has {count} diodes, but '
                f'{", ".join(str(len(row)) for row in rows)} values of {name}; record it again.'
            )
        columns[name] = np.concatenate([np.empty(0), *rows])
    return columns


def stack_points(messages: Iterable[Any]) -> dict[str, NDArray[np.float64]]:
    """
    Return the readings of several lamp peaks by field.

    Returns
    -------
    dict of str to ndarray, shape (n, points)
        NaN if a message has fewer points than the largest.

    """
    decoded = [decode_lamp_peaks(message) for message in messages]
    names = dict.fromkeys(name for one in decoded for name in one)
    most = max((len(column) for one in decoded for column in one.values()), default=0)
    result = {name: np.full((len(decoded), most), np.nan) for name in names}
    for row, one in enumerate(decoded):
        for name, column in one.items():
            result[name][row, : len(column)] = column
    return result
