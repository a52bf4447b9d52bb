# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Convert the messages of a topic to columns without an object per message.

Messages are read in batches. Those of one length with the same layout become columns together;
others are decoded as objects. The result is the same either way.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, Final, final, NamedTuple

from lta_data.bag.cdr_layout import CdrLayout, CdrLeaf, derive_layout, Fields, LayoutMismatch, TEXT
from lta_data.bag.columns import (
    add_objects,
    Columns,
    extract_stamp,
    find_stamp_path,
    merge_columns,
    PiecewiseColumn,
    Rows,
    SECOND_NS,
)
import numpy as np
from numpy.typing import NDArray

BATCH_MESSAGES: Final = 4096
BATCH_BYTES: Final = 1 << 24  # a batch ends at either limit
NUMBER_TYPES: Final = {
    'i': np.int64,
    'u': np.int64,
    'f': np.float64,
}  # types of single numbers, as from Python numbers


class MessageColumns(NamedTuple):
    """Messages as columns."""

    # As `columns.build_columns` returns them, shape (n,)
    numbers: Columns
    texts: Columns
    stamps: NDArray[np.int64]  # 0 for a message without a stamp, shape (n,) [ns]
    logged: list[int]  # log times [ns]


class MessageType(NamedTuple):
    """A message type: its name, the fields of any type, and the decoder."""

    name: str
    fields: Fields
    decode: Callable[[bytes], object]


@final
class ColumnBuilder:
    """Builds columns: call `add_message` for each message, then `flush_columns`."""

    def __init__(self, typed: MessageType) -> None:
        self._typed = typed
        self._layouts: dict[tuple[int, bytes], CdrLayout] = {}
        self._waiting: list[bytes] = []
        self._bytes = 0
        self._columns: dict[str, PiecewiseColumn] = {}
        self._logged: list[int] = []
        self._stamps: list[NDArray[np.int64]] = []

    def add_message(self, log_time: int, data: bytes) -> None:
        """Add a message; raise `BadInput` if a pending one cannot be decoded."""
        if not self._logged:
            self._typed.decode(data)  # decode the first message to detect invalid CDR early
        self._logged.append(log_time)
        self._waiting.append(data)
        self._bytes += len(data)
        if len(self._waiting) >= BATCH_MESSAGES or self._bytes >= BATCH_BYTES:
            self._convert_pending()

    def flush_columns(self) -> MessageColumns:
        """Return the columns of all messages and reset; errors as `add_message`."""
        self._convert_pending()
        numbers, texts = merge_columns(self._columns, len(self._logged))
        stamps = np.concatenate([np.empty(0, np.int64), *self._stamps])
        columns = MessageColumns(numbers, texts, stamps, self._logged)
        self._logged, self._stamps = [], []
        return columns

    def _convert_pending(self) -> None:
        """Convert the pending messages to pieces of columns."""
        batch, self._waiting, self._bytes = self._waiting, [], 0
        begin = len(self._logged) - len(batch)
        stamps = np.zeros(len(batch), np.int64)
        alike: defaultdict[tuple[int, bytes], list[int]] = defaultdict(list)
        for index, data in enumerate(batch):
            # Bytes 0 and 1 are the CDR representation identifier, which sets the byte order
            alike[len(data), data[:2]].append(index)
        odd: list[int] = []
        for key, indices in alike.items():
            part = EqualLengthMessages(
                begin, stamps, np.array(indices), stack_messages(batch, indices)
            )
            odd += self._read_alike(key, part).tolist()
        self._read_objects(begin, stamps, batch, sorted(odd))
        self._stamps.append(stamps)

    def _read_alike(self, key: tuple[int, bytes], part: 'EqualLengthMessages') -> NDArray[np.intp]:
        """
        Read the messages of one length and byte order that have one layout.

        Return the positions of the others, which are decoded one by one.
        """
        # A layout for one message only is not worth deriving
        if key not in self._layouts and len(part.indices) > 1:
            with suppress(LayoutMismatch):
                self._layouts[key] = derive_layout(
                    self._typed.name, part.table[0].tobytes(), self._typed.fields
                )
        layout = self._layouts.get(key)
        if layout is None:
            return part.indices
        fits = layout.find_matching_messages(part.table)
        read = part if fits.all() else part.select_messages(fits)
        if len(read.indices):
            try:
                self._add_columns(layout, read)
            except UnicodeDecodeError:
                return part.indices  # decoding as objects finds the invalid text
        return part.indices[~fits]

    def _add_columns(self, layout: CdrLayout, part: 'EqualLengthMessages') -> None:
        values = [normalize_leaf(layout, part.table, leaf) for leaf in layout.leaves]
        rows, first = part.rows, part.begin + int(part.indices[0])
        for place, (leaf, column) in enumerate(zip(layout.leaves, values, strict=True)):
            self._ensure_column(leaf.path, (first, place)).add_piece((first, place), rows, column)
        part.stamps[part.indices] = extract_stamps(layout, values)

    def _read_objects(
        self, begin: int, stamps: NDArray[np.int64], batch: Sequence[bytes], odd: Sequence[int]
    ) -> None:
        """Decode messages one by one."""
        messages = {index: self._typed.decode(batch[index]) for index in odd}
        for index, message in messages.items():
            stamps[index] = extract_stamp(message) or 0
        add_objects(self._columns, [(begin + index, one) for index, one in messages.items()])

    def _ensure_column(self, path: str, first: tuple[int, int]) -> PiecewiseColumn:
        return self._columns.setdefault(path, PiecewiseColumn(first))


@final
class EqualLengthMessages(NamedTuple):
    """
    Some messages of one length in a batch.

    `begin` is the number of the batch's first message, `stamps` those of the whole batch,
    `indices` the positions of these messages in it, and `table` their bytes, shape (n, size).
    """

    begin: int
    stamps: NDArray[np.int64]
    indices: NDArray[np.intp]
    table: NDArray[np.uint8]

    @property
    def rows(self) -> Rows:
        """Return the row numbers of these messages in the topic."""
        first, last = int(self.indices[0]), int(self.indices[-1])
        if last - first + 1 == len(self.indices):
            # A slice assigns faster than an index array
            return slice(self.begin + first, self.begin + last + 1)
        return self.begin + self.indices

    def select_messages(self, chosen: NDArray[np.bool_]) -> 'EqualLengthMessages':
        """Return some of them."""
        return self._replace(indices=self.indices[chosen], table=self.table[chosen])


def stack_messages(batch: Sequence[bytes], indices: Sequence[int]) -> NDArray[np.uint8]:
    """Stack messages of one length, shape (n, length)."""
    whole = np.frombuffer(b''.join([batch[index] for index in indices]), np.uint8)
    return whole.reshape(len(indices), -1 if len(whole) else 0)


def normalize_leaf(layout: CdrLayout, table: NDArray[np.uint8], leaf: CdrLeaf) -> NDArray[Any]:
    """Return a copy of a leaf in native byte order, with the types of `build_columns`."""
    if leaf.code == TEXT:
        return decode_texts(table[:, leaf.offset : leaf.offset + (leaf.length or 0)])
    if leaf.code == '?':
        # Read as uint8: a byte other than 0 or 1 is no valid numpy bool
        flags: NDArray[np.bool_] = layout.extract_values(table, leaf._replace(code='u1')) != 0
        return flags
    values = layout.extract_values(table, leaf)
    if leaf.length is not None:
        return values.astype(values.dtype.newbyteorder('='))
    return values.astype(np.uint64 if leaf.code == 'u8' else NUMBER_TYPES[values.dtype.kind])


def decode_texts(letters: NDArray[np.uint8]) -> NDArray[Any]:
    """Decode texts of equal byte length, shape (n, length), to an array of texts."""
    if not letters.shape[1] or (letters == letters[0]).all():
        return np.full(len(letters), letters[0].tobytes().decode())
    kind = f'S{letters.shape[1]}'
    # Decode each distinct text only once.
    unique, which = np.unique(np.ascontiguousarray(letters).view(kind)[:, 0], return_inverse=True)
    return np.array([each.decode() for each in unique.tolist()])[which]


def extract_stamps(layout: CdrLayout, values: Sequence[NDArray[Any]]) -> NDArray[np.int64] | int:
    """Return the stamps of messages with one layout, 0 without a stamp [ns]."""
    by_path = {leaf.path: column for leaf, column in zip(layout.leaves, values, strict=True)}
    place = find_stamp_path(by_path)
    if place is None:
        return 0
    seconds, rest = (by_path[f'{place}.{part}'].astype(np.int64) for part in ('sec', 'nanosec'))
    stamps: NDArray[np.int64] = seconds * SECOND_NS + rest
    return stamps
