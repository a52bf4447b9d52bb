# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read a recorded wind: a time series of air velocities.

A CSV file with the header `t,u,v,w`: time in s, and air velocity along map x, y, z in m/s (the
direction that the air moves to); lines that begin with `#` are comments. The flight begins at the
first row. The wind is interpolated linearly in time and uniform in space, so that its change

    DU/Dt = (U_{i+1} - U_i) / (t_{i+1} - t_i)

is a pressure gradient, which accelerates a neutral hull with the air.
"""

from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import final, Self, TextIO

from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

WIND_HEADER = ['t', 'u', 'v', 'w']
MOST_ROWS = 5_000_000  # half a day at 100 Hz
STRONGEST = 60.0  # m/s; bound of the wind effects
LONGEST_INTERVAL = 3.0  # of the usual interval; a longer one is a gap

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True, eq=False)
class WindRecord:
    """A recorded wind; create it with `WindRecord.read`."""

    time: Array  # since the flight's start, shape (N,) [s]
    wind: Array  # in `map`, shape (N, 3) [m/s]

    @classmethod
    def read(cls, path: Path, needed: float) -> Self:
        """
        Read a wind file that must last `needed` seconds.

        Raise `BadInput` if the file cannot be read, has another format, is not in order, has a gap
        of more than three times the usual interval, or ends too early.
        """
        try:
            with path.open(encoding='utf-8') as stream:
                rows = _read_rows(path, stream)
        except (OSError, UnicodeDecodeError) as error:
            raise BadInput(
                f'The wind file {path} cannot be read ({error}); check that it is a readable '
                'CSV file.'
            ) from None
        if len(rows) < 2:
            raise BadInput(
                f'The wind file {path} has {len(rows)} rows below its header; at least two '
                'are needed.'
            )
        _check_order(path, rows[:, 0])
        # The flight may take up to its time limit
        lasts = float(rows[-1, 0] - rows[0, 0])
        if lasts < needed:
            raise BadInput(
                f'The wind file {path} lasts {lasts:g} s, but the flight may take {needed:g} s; '
                'give a longer record or lower goal.time_limit.'
            )
        return cls(rows[:, 0] - rows[0, 0], np.ascontiguousarray(rows[:, 1:]))

    def average_wind_over_span(
        self, begin: float | Array, end: float | Array
    ) -> tuple[Array, Array]:
        """Return the mean wind [m/s] and its mean rate [m/s2] over time spans [s], by axis."""
        middle, first, last = (
            self._interpolate_wind(t) for t in (0.5 * (begin + end), begin, end)
        )
        return middle, (last - first) / (end - begin)

    def _interpolate_wind(self, time: float | Array) -> Array:
        return np.array([np.interp(time, self.time, column) for column in self.wind.T])


def _read_rows(path: Path, stream: TextIO) -> Array:
    """Return the numbers of a file, shape (N, 4)."""
    # An array of doubles, because lists of millions of Python floats need several times the memory
    numbers = array('d')
    header: list[str] | None = None
    for count, line in enumerate(stream, start=1):
        text = line.strip()
        if not text or text.startswith('#'):
            continue
        cells = [cell.strip() for cell in text.split(',')]
        if header is None:
            header = cells
            if header != WIND_HEADER:
                raise BadInput(
                    f'The wind file {path} begins with "{text[:40]}" instead of the header '
                    f'"{",".join(WIND_HEADER)}"; make this header its first line.'
                )
            continue
        numbers.extend(_parse_numbers(path, count, cells))
        if len(numbers) > len(WIND_HEADER) * MOST_ROWS:
            raise BadInput(f'The wind file {path} has more than {MOST_ROWS} rows; shorten it.')
    return np.array(numbers).reshape(-1, len(WIND_HEADER))


def _parse_numbers(path: Path, count: int, cells: list[str]) -> list[float]:
    """Return the numbers of one line."""
    try:
        row = [float(cell) for cell in cells]
    except ValueError:
        row = []
    # 'nan' and 'inf' are valid for float()
    if len(row) != len(WIND_HEADER) or not np.isfinite(row).all():
        raise BadInput(
            f'The wind file {path} has "{",".join(cells)[:60]}" in line {count}; the line '
            'must have four finite numbers (t,u,v,w).'
        )
    if max(map(abs, row[1:])) > STRONGEST:
        raise BadInput(
            f'The wind file {path} has a wind of {max(row[1:], key=abs):g} m/s in line '
            f'{count}; at most {STRONGEST:g} m/s are allowed.'
        )
    return row


def _check_order(path: Path, time: Array) -> None:
    """Raise `BadInput` if times do not increase or have a gap."""
    steps = np.diff(time)
    where = int(np.argmin(steps))
    if steps[where] <= 0.0:
        raise BadInput(
            f'The wind file {path} has t = {time[where + 1]:g} s after t = {time[where]:g} s; '
            'sort its rows by time, and give each time only once.'
        )
    where, usual = int(np.argmax(steps)), float(np.median(steps))
    if steps[where] > LONGEST_INTERVAL * usual:
        raise BadInput(
            f'The wind file {path} has a gap of {steps[where]:g} s after t = {time[where]:g} s, '
            f'where rows are {usual:g} s apart; add the missing rows, or end the file there.'
        )
