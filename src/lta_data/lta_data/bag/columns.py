"""
Convert a list of messages to one array per field.

`column_builder` gives the same result for whole topics, without an object for each message.
"""

from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, Final

from lta_data.bag.merge import Columns, merge_columns, PiecewiseColumn
import numpy as np
from numpy.typing import NDArray

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
