"""Represent a topic as columns with units on one clock, for use in a notebook."""

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from importlib import import_module
from itertools import count, takewhile
import re
from typing import Any, Final, final, overload

from lta_config.errors import BadInput, unknown_name_error
from lta_data.bag.merge import Columns
from lta_data.bag.table_text import DIM, format_column_lines, format_heading
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.typing import NDArray
import pyarrow as arrow

TIME: Final = 'time'
STAMP: Final = 'stamp_ns'
PARTS: Final = ('yaw', 'pitch', 'roll')
AXES: Final = ('x', 'y', 'z', 'w')
POLARS: Final = 'polars'  # whoever wants it installs it

Samples = Callable[[NDArray[np.intp]], NDArray[Any]]


@final
class RecordingTable:
    """
    Columns over time, `table['pose.pose.position.x']`.

    Yaw, pitch and roll of a quaternion are columns, too ('pose.pose.orientation.yaw'), computed on
    access.

    Parameters
    ----------
    name : str
        The topic, or several.
    stamp_ns : ndarray of int64, shape (n,)
        Stamp of each row. [ns]
    start : int
        Stamp at time 0. [ns]
    data : dict of str to ndarray, shape (n,)
        Numbers, flags and texts by column.
    units : mapping of str to str
        Unit of the columns that have one.
    kind : str
        Message type; '' if none.
    samples : callable, optional
        Returns the ADC blocks of messages of the topic, numbered from 0.
    messages : ndarray of int, shape (n,), optional
        Message number of each row; needed with `samples` only.
    also : mapping of str to str, optional
        Alias -> column, such as 'effort[0]' -> 'effort.left'.

    Attributes
    ----------
    units : dict of str to str
        Unit of each numeric column in REP-103 notation; '1' for a dimensionless number; without
        an entry if unknown.

    """

    def __init__(
        self,
        name: str,
        stamp_ns: NDArray[np.int64],
        start: int,
        data: Columns,
        units: Mapping[str, str],
        kind: str = '',
        samples: Samples | None = None,
        messages: NDArray[np.intp] | None = None,
        also: Mapping[str, str] | None = None,
    ) -> None:
        self.name = name
        self.stamp_ns = stamp_ns
        self.start = start
        self._data = data
        self.kind = kind
        self._samples = samples
        # Numbers of the rows in the topic, to load the samples of selected rows only
        self._messages = np.arange(len(stamp_ns)) if messages is None else messages
        self._also = also or {}
        self.units = {column: units[column] for column in data if units.get(column)}
        self.units |= {f'{turn}.{part}': 'rad' for turn in self.quaternions for part in PARTS}

    @cached_property
    def time(self) -> NDArray[np.float64]:
        """Time of each row since the start of the flight. [s]"""
        return (self.stamp_ns - self.start).astype(np.float64) * 1e-9

    @cached_property
    def quaternions(self) -> list[str]:
        """The paths of quaternions: columns with x, y, z and w."""
        stems = (column.removesuffix('.w') for column in self._data if column.endswith('.w'))
        return [turn for turn in stems if all(f'{turn}.{axis}' in self._data for axis in AXES)]

    @property
    def stored_columns(self) -> list[str]:
        """The names of the columns of the messages, without computed ones."""
        return list(self._data)

    @property
    def columns(self) -> list[str]:
        """The names of all columns; a quaternion's angles follow it."""
        names = []
        for column in self._data:
            names.append(column)
            if column.removesuffix('.w') in self.quaternions:
                names += [f'{column.removesuffix(".w")}.{part}' for part in PARTS]
        return names

    @cached_property
    def samples(self) -> NDArray[Any]:
        """ADC blocks of a topic or pixels of an image topic, shape (n, rows, columns)."""
        if self._samples is None:
            raise BadInput(f"Topic '{self.name}' has no image samples; choose an image topic.")
        return self._samples(self._messages)

    @property
    def array_names(self) -> list[str]:
        """The names of array columns without index: 'effort', 'snr'."""
        names = [*self._data, *self._also]
        return [column.removesuffix('[0]') for column in names if column.endswith('[0]')]

    def array(self, path: str) -> NDArray[Any]:
        """Return an array field or a field of points, shape (n, elements)."""
        if path not in self.array_names:
            raise unknown_name_error(
                'array', path, [each for each in self.array_names if not DIM.search(each)]
            )
        names = {*self._data, *self._also}
        # Elements are numbered without gaps
        elements = takewhile(names.__contains__, (f'{path}[{k}]' for k in count()))
        return np.stack([self[element] for element in elements], axis=1)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.stamp_ns)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the columns."""
        return iter(self.columns)

    def __contains__(self, column: object) -> bool:
        """Return whether there is a column."""
        return column in self.columns or column in self._also

    @overload
    def __getitem__(self, column: str) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, column: slice | NDArray[Any]) -> 'RecordingTable': ...

    def __getitem__(self, column: str | slice | NDArray[Any]) -> 'NDArray[Any] | RecordingTable':
        """
        Return a column, shape (n,), or some rows: `table[10:20]`, `table[table['z'] > 1.0]`.

        Raise `BadInput` if the column is unknown, with those that are known, or the rows are not
        there.
        """
        if not isinstance(column, str):
            return self.select_rows(resolve_rows(column, len(self)))
        column = self._also.get(column, column)
        if column in self._data:
            return self._data[column]
        turn, _, part = column.rpartition('.')
        if turn in self.quaternions and part in PARTS:
            angles: NDArray[np.float64] = getattr(to_euler_angles(self.vector(turn)), part)
            return angles
        raise unknown_name_error(
            'column', column, [each for each in self.columns if not DIM.search(each)]
        )

    def vector(self, path: str) -> NDArray[np.float64]:
        """Return x, y, z and, if present, w of a path, shape (n, 3) or (n, 4)."""
        axes = AXES if f'{path}.w' in self._data else AXES[:3]
        return np.stack([self[f'{path}.{axis}'] for axis in axes], axis=1).astype(np.float64)

    def between(self, begin: float, end: float) -> 'RecordingTable':
        """Return the rows of a closed time interval. [s]"""
        elapsed = self.stamp_ns - self.start
        # In whole nanoseconds, so that the ends are included despite rounding
        first, last = np.rint(begin * 1e9), np.rint(end * 1e9)
        return self.select_rows(np.flatnonzero((elapsed >= first) & (elapsed <= last)))

    def select_rows(self, chosen: NDArray[np.intp]) -> 'RecordingTable':
        """Return some rows; contiguous rows are views."""
        which: slice | NDArray[np.intp] = chosen
        if len(chosen) and chosen[0] >= 0 and (np.diff(chosen) == 1).all():
            # A slice gives views instead of copies.
            which = slice(int(chosen[0]), int(chosen[-1]) + 1)
        data = {column: values[which] for column, values in self._data.items()}
        return self._with_columns(data, which)

    def select(self, *patterns: str) -> 'RecordingTable':
        """
        Return the columns that match the patterns, with `*` as wildcard: 'pose.pose.position.*'.

        A quaternion includes its angles.

        Raise `BadInput` if a pattern matches no column.
        """
        chosen = []
        for pattern in patterns:
            # Not fnmatch: the brackets of 'effort[0]' would be a character class
            fits = re.compile('.*'.join(map(re.escape, pattern.split('*'))))
            names = [column for column in self._data if fits.fullmatch(column)]
            if not names:
                self[pattern]  # raises the error with the known columns
            chosen += names
        data = {column: self._data[column] for column in self._data if column in chosen}
        return self._with_columns(data, slice(None))

    def to_arrow(self) -> Any:  # noqa: ANN401 - pyarrow has no types
        """Return a `pyarrow.Table`: stamp_ns, time, all columns; units in the fields' metadata."""
        columns = {STAMP: self.stamp_ns, TIME: self.time} | {each: self[each] for each in self}
        units = {STAMP: 'ns', TIME: 's'} | self.units
        fields = [build_arrow_field(name, values.dtype, units) for name, values in columns.items()]
        arrays = [arrow.array(values) for values in columns.values()]
        about = {'topic': self.name, 'type': self.kind}
        return arrow.table(arrays, schema=arrow.schema(fields, metadata=about))

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas has no types
        """Return a `pandas.DataFrame` over time [s]; `df.attrs['units']` has the units."""
        import pandas  # half a second, which most commands do not need

        index = pandas.Index(self.time, name=TIME)
        frame = pandas.DataFrame({column: self[column] for column in self}, index=index)
        frame.attrs = {'topic': self.name, 'units': {TIME: 's'} | self.units}
        return frame

    def to_polars(self) -> Any:  # noqa: ANN401 - optional
        """Return a `polars.DataFrame` with the time [s] first; polars has no units."""
        try:
            polars = import_module(POLARS)
        except ImportError:
            raise BadInput(
                'A polars table needs polars, which is not installed; install it with '
                '".venv/bin/pip install polars".'
            ) from None
        return polars.DataFrame({TIME: self.time} | {column: self[column] for column in self})

    def _with_columns(self, data: Columns, rows: slice | NDArray[np.intp]) -> 'RecordingTable':
        """Return a table with other columns for some of the rows."""
        return RecordingTable(
            self.name,
            self.stamp_ns[rows],
            self.start,
            data,
            self.units,
            self.kind,
            self._samples,
            self._messages[rows],
            {other: column for other, column in self._also.items() if column in data},
        )

    def __repr__(self) -> str:
        """Return a summary with one line per column."""
        return '\n'.join([format_heading(self), *format_column_lines(self)])


def resolve_rows(chosen: slice | NDArray[Any], count: int) -> NDArray[np.intp]:
    """Return the row numbers chosen by a slice, mask or index array, shape (n,)."""
    try:
        return np.atleast_1d(np.arange(count)[chosen])
    except (IndexError, TypeError, ValueError):
        raise BadInput(
            f"'{chosen}' does not select rows of this table, which has {count}; give a column "
            'name, a slice, a mask, or row numbers.'
        ) from None


def build_arrow_field(name: str, kind: np.dtype[Any], units: Mapping[str, str]) -> Any:  # noqa: ANN401
    """Return the arrow field of a column with its unit."""
    stored = arrow.string() if kind.kind == 'U' else arrow.from_numpy_dtype(kind)
    return arrow.field(name, stored, metadata={'unit': units[name]} if name in units else None)
