"""Merge pieces of columns to one array per field."""

from dataclasses import dataclass, field
from typing import Any, final, NamedTuple

import numpy as np
from numpy.typing import NDArray

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
