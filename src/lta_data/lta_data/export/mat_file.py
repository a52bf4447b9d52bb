"""
Write a topic as a MATLAB file (version 5): one struct with the fields of the message.

`odom.pose.pose.position.x` is a column, `odom.pose.covariance` a matrix with a row per message,
and `units.pose.pose.position.x` is 'm'. A MATLAB variable is written at once, so the topic must
fit into memory and into 2 GB.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
import re
from typing import Any, Final, TYPE_CHECKING

from lta_config.errors import BadInput
import numpy as np
import pyarrow as arrow
from scipy.io import savemat

if TYPE_CHECKING:
    from lta_data.export.run import ExportSource

LARGEST: Final = 2**31 - 1  # bytes of a variable in version 5
LONGEST: Final = 63  # characters of a name, namelengthmax of MATLAB
UNITS: Final = 'units'
_INDEX: Final = re.compile(r'\[(\d+)\]')
_LAST: Final = re.compile(r'(.*)\[(\d+)\]')

Struct = dict[str, Any]


def write_mat(source: 'ExportSource', path: Path) -> Iterator[arrow.Table]:
    """
    Write a file and yield its table.

    Raise `BadInput` if the topic is too large for the format.
    """
    parts, size = [], 0
    for part in source.iterate_arrow():
        size += part.nbytes
        if size > LARGEST:
            raise BadInput(
                f"'{source.name}' is larger than the 2 GB that a MATLAB file can hold; leave it "
                'out with --topics, or export it with --format parquet.'
            )
        parts.append(part)
    whole = arrow.concat_tables(parts)
    columns = {name: whole.column(name).to_numpy() for name in whole.column_names}
    values: Struct = {}
    units: Struct = {}
    # Units are those of the first element of an array.
    for name, column in join_array_columns(columns).items():
        # savemat writes object arrays, as texts are, as cell arrays
        cells = column
        unit = source.units.get(name, source.units.get(f'{name}[0]', ''))
        # MATLAB has no one-dimensional arrays: make it a column.
        set_nested_value(values, name, cells if cells.ndim == 2 else cells[:, None])
        set_nested_value(units, name, unit)
    content = {format_matlab_name(source.name): values, UNITS: units}
    savemat(path, content, long_field_names=True, do_compression=True, oned_as='column')
    yield whole


def join_array_columns(
    columns: Mapping[str, np.ndarray[Any, Any]],
) -> dict[str, np.ndarray[Any, Any]]:
    """Join the elements of each numeric array into one matrix, shape (n, elements)."""
    joined: dict[str, Any] = {}
    for name, values in columns.items():
        element = _LAST.fullmatch(name)
        if element is None or values.dtype.kind == 'O':
            joined[name] = values
        else:
            joined.setdefault(element.group(1), []).append(values)
    return {
        name: np.stack(values, axis=1) if isinstance(values, list) else values
        for name, values in joined.items()
    }


def set_nested_value(struct: Struct, path: str, value: object) -> None:
    """Set a value in a struct of structs."""
    *outer, last = [format_matlab_name(part) for part in re.split('[./]', path)]
    for name in outer:
        inside = struct.setdefault(name, {})
        if not isinstance(inside, dict):  # the name already holds a value
            inside = struct.setdefault(f'{name}_'[:LONGEST], {})
        struct = inside
    while last in struct:
        last = f'{last}_'
    struct[last] = value


def format_matlab_name(name: str) -> str:
    """Return a valid MATLAB name: letters, digits and underscores, starting with a letter."""
    plain = re.sub(r'\W', '_', _INDEX.sub(r'_\1', name), flags=re.ASCII).strip('_')
    return (plain if plain[:1].isalpha() else f'x{plain}')[:LONGEST]
