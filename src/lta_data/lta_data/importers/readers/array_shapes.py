"""Arrange named arrays as tables: vectors become columns, and equal lengths share a table."""

from collections.abc import Iterator, Mapping
from typing import Any

from lta_data.importers.readers.column_log import Column
import numpy as np

WIDEST = 64  # columns of a matrix; wider ones are images or maps


def arrange_tables(leaves: Mapping[str, Any]) -> tuple[dict[str, dict[str, Column]], list[str]]:
    """
    Return the tables of named arrays, and a remark on what is left out.

    The arrays of one struct ('imu.acc', 'imu.t') with one length form a table of its name; others
    are collected by length. A single table is named ''.
    """
    tables: dict[str, dict[str, Column]] = {}
    left_out = []
    groups = {name: _split_columns(name, np.asarray(value)) for name, value in leaves.items()}
    lengths = {len(c) for columns in groups.values() for c in columns.values()}
    for name, columns in groups.items():
        if not columns:
            left_out.append(name)
        for column, cells in columns.items():
            struct, _, short = column.rpartition('.')
            table = struct or (f'rows_{len(cells)}' if len(lengths) > 1 else '')
            tables.setdefault(table, {})[short if struct else column] = cells
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
        return {f'{name}.{part}': array[part] for part in array.dtype.names}
    if array.dtype.kind not in 'fiub' or array.size < 2:
        return {}
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    if array.ndim == 1:
        return {name: array}
    if array.ndim != 2 or min(array.shape) > WIDEST:
        return {}
    # Time along the longer side
    rows = array if array.shape[0] >= array.shape[1] else array.T
    return {f'{name}[{index}]': rows[:, index] for index in range(rows.shape[1])}
