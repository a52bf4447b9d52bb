# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read the columns of MATLAB, NumPy and Parquet files; nothing in them is executed."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
import zipfile

from lta_config.errors import BadInput
from lta_config.limits import (
    check_column_count,
    check_log_size,
    INFLATED_FREELY,
    INFLATION,
    limit_memory,
)
from lta_data.importers.readers.column_log import Column
from lta_data.importers.readers.mat_process import read_mat_arrays
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

MAX_MATRIX_COLUMNS = 64  # columns of a matrix; wider ones are images or maps


def arrange_tables(leaves: Mapping[str, Any]) -> tuple[dict[str, dict[str, Column]], list[str]]:
    """
    Return the tables of named arrays, and a remark on what is left out.

    The arrays of one struct ('imu.acc', 'imu.t') with one length form a table of its name; others
    are collected by length. Arrays of one length, some of them outside of structs, are rows of one
    table, as their time may be there. A single table is named ''.
    """
    tables: dict[str, dict[str, Column]] = {}
    left_out = []
    groups = {name: _split_columns(name, np.asarray(value)) for name, value in leaves.items()}
    lengths = {len(c) for columns in groups.values() for c in columns.values()}
    are_rows = len(lengths) == 1 and any(
        '.' not in column for columns in groups.values() for column in columns
    )
    for name, columns in groups.items():
        if not columns:
            left_out.append(name)
        for column, cells in columns.items():
            struct, _, short = ('', '', column) if are_rows else column.rpartition('.')
            table = struct or (f'rows_{len(cells)}' if len(lengths) > 1 else '')
            tables.setdefault(table, {})[short] = cells
    named = dict(_iterate_even_tables(tables))
    if len(named) == 1:
        named = {'': next(iter(named.values()))}
    notes = []
    if left_out:
        notes.append(f'Not a vector of numbers, and left out: {", ".join(left_out)}.')
    return named, notes


def _iterate_even_tables(
    tables: Mapping[str, dict[str, Column]],
) -> Iterator[tuple[str, dict[str, Column]]]:
    """Yield the tables, split where a struct has arrays of several lengths."""
    for name, columns in tables.items():
        lengths = dict.fromkeys(len(cells) for cells in columns.values())
        for length in lengths:
            yield (
                name if len(lengths) == 1 else f'{name}_{length}',
                {column: cells for column, cells in columns.items() if len(cells) == length},
            )


def _split_columns(name: str, array: Column) -> dict[str, Column]:
    """Return the columns of an array; none if it is a scalar, a text or of more dimensions."""
    if array.dtype.names:
        parts: dict[str, Column] = {}
        for part in array.dtype.names:
            cells, label = array[part], f'{name}.{part}'
            # Texts of one dimension may be dates
            parts |= {label: cells} if _are_texts(cells) else _split_columns(label, cells)
        return parts
    if array.dtype.kind not in 'fiub' or array.size < 2:
        return {}
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    if array.ndim == 1:
        return {name: array}
    if array.ndim != 2 or min(array.shape) > MAX_MATRIX_COLUMNS:
        return {}
    # Time along the longer side
    rows = array if array.shape[0] >= array.shape[1] else array.T
    return {f'{name}[{index}]': rows[:, index] for index in range(rows.shape[1])}


def _are_texts(cells: Column) -> bool:
    return cells.ndim == 1 and cells.dtype.kind in 'USM'


HDF5 = b'\x89HDF\r\n\x1a\n'
READ = tuple[dict[str, dict[str, Column]], list[str]]  # tables, remarks


def detect_arrays(head: bytes, suffix: str) -> str | None:
    """Return the format of a file of arrays by its first bytes; None if it is another."""
    if head.startswith(b'MATLAB 5.0') or HDF5 in head[:1024]:
        return 'mat'
    if head.startswith(b'\x93NUMPY') or (head.startswith(b'PK') and suffix == '.npz'):
        return 'numpy'
    return 'parquet' if head.startswith(b'PAR1') else None


def read_mat_file(path: Path) -> READ:
    """
    Read a MATLAB file of version 5 or older.

    Raise `BadInput` if it is damaged, or has version 7.3.
    """
    check_log_size(path)
    with path.open('rb') as stream:
        head = stream.read(1024)
    if HDF5 in head or head[:19] == b'MATLAB 7.3 MAT-file':
        raise BadInput(
            f"'{path}' is a MATLAB file of version 7.3 or another HDF5 file, which LTA does not "
            "read; save it with save(FILE, '-v7') in MATLAB, or with np.savez in Python."
        )
    return _require_tables(path, read_mat_arrays(path))


def read_numpy_file(path: Path) -> READ:
    """
    Read an array (npy) or several (npz), without pickles.

    Raise `BadInput` if it is damaged, or contains Python objects.
    """
    check_log_size(path)
    try:
        if zipfile.is_zipfile(path):
            _refuse_bomb(path)
        with limit_memory(), path.open('rb') as stream:
            content = np.load(stream, allow_pickle=False)
            if isinstance(content, np.lib.npyio.NpzFile):
                check_column_count(path, len(content.files))
                leaves = {name: content[name] for name in content.files}
            else:
                leaves = _name_array(content)
    except BadInput:
        raise
    # numpy raises many types for damaged files
    except Exception as error:
        # numpy advises pickles also for a header of thousands of fields
        if 'allow_pickle' in str(error) and 'max_header_size' not in str(error):
            raise BadInput(
                f"'{path}' contains pickled Python objects, and LTA does not unpickle files, "
                'since a pickle can run any program; save its arrays of numbers with np.savez.'
            ) from None
        raise _damaged(path, 'NumPy', error) from None
    return _require_tables(path, leaves)


def read_parquet_file(path: Path) -> READ:
    """Read a Parquet table; raise `BadInput` if it is damaged."""
    check_log_size(path)
    try:
        with limit_memory():
            check_column_count(path, pq.read_metadata(path).num_columns)
            table = pq.read_table(path)
    except BadInput:
        raise
    except (pa.ArrowException, OSError, ValueError, MemoryError) as error:
        raise _damaged(path, 'Parquet', error) from None
    while any(pa.types.is_struct(field.type) for field in table.schema):
        table = table.flatten()
    columns: dict[str, Column] = {}
    left_out = []
    for name in table.column_names:
        column = table.column(name)
        if pa.types.is_timestamp(column.type):
            columns[name] = column.cast(pa.timestamp('ns')).cast(pa.int64()).to_numpy()
        elif pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
            columns[name] = column.to_numpy()
        elif parts := _split_columns(name, _stack_lists(column)):
            columns |= parts
        else:
            left_out.append(name)
    notes = [f'Not numbers, and left out: {", ".join(left_out)}.'] if left_out else []
    if not columns or not table.num_rows:
        raise _empty(path)
    return {'': columns}, notes


def _stack_lists(column: pa.ChunkedArray) -> Column:
    """Return lists of equally many numbers as a matrix; empty for other cells."""
    if isinstance(column.type, (pa.ListType, pa.LargeListType, pa.FixedSizeListType)):
        lists = column.combine_chunks()
        if not lists.null_count and len(pc.unique(pc.list_value_length(lists))) == 1:
            return np.asarray(lists.flatten()).reshape(len(lists), -1)
    return np.empty(0)


def _name_array(array: Column) -> dict[str, Column]:
    """Return a single array by column: its field names, or column_1 and so on."""
    if array.dtype.names:
        return {name: array[name] for name in array.dtype.names}
    if array.ndim != 2:
        return {'column_1': array}
    rows = array if array.shape[0] >= array.shape[1] else array.T
    return {f'column_{index + 1}': rows[:, index] for index in range(rows.shape[1])}


def _require_tables(path: Path, content: dict[str, Any]) -> READ:
    """Return the tables of arrays; raise `BadInput` if there are none, or too many arrays."""
    check_column_count(path, len(content))
    tables, notes = arrange_tables(content)
    if not tables:
        raise _empty(path)
    return tables, notes


def _refuse_bomb(path: Path) -> None:
    """Raise BadInput for an archive that unpacks to far more than its size."""
    with zipfile.ZipFile(path) as archive:
        size = sum(member.file_size for member in archive.infolist())
    if size > INFLATED_FREELY + INFLATION * path.stat().st_size:
        raise BadInput(
            f"'{path}' unpacks to more than {INFLATION} times its size, which no log does."
        )


def _damaged(path: Path, what: str, error: Exception) -> BadInput:
    reason = ' '.join(str(error).split()).rstrip('.')[:200] or type(error).__name__
    return BadInput(
        f"'{path}' cannot be read as a {what} file ({reason}); it is probably damaged, so copy "
        'it again.'
    )


def _empty(path: Path) -> BadInput:
    return BadInput(f"'{path}' contains no vector of numbers; give a log with data.")
