# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find the time of a table: its column and unit, or the rate of its rows."""

from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.quantity import SI_UNITS
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.protocol import Numbers
from lta_data.importers.readers.column_log import is_date, is_time, parse_exact_times
from lta_data.interpretation.column_group import ColumnGroup, Columns
from lta_data.interpretation.column_names import parse_column_name, TIME_WORDS, UNIT_WORDS
import numpy as np

LOG_RATES: Final = (0.5, 3000.0)  # of samples that a flight log has [Hz]
EPOCHS: Final = {'s': 1e9, 'ms': 1e12, 'us': 1e15, 'ns': 1e18}  # times since 1970, at least
LONG_UNITS: Final = ('min', 'h')
DAYS: Final = ((30_000, 60_000), (720_000, 760_000))  # of today, in spreadsheets and MATLAB
FRAMES: Final = frozenset(
    ['frame', 'frames', 'index', 'idx', 'row', 'sample', 'samples', 'unnamed']
)
RISING_SHARE: Final = 0.9  # of the rows in which a time rises, more than
REPEATED: Final = 0.3  # least share of rows in which a time rises
# Ranks of a column as the time
UNREADABLE: Final = 4
NO_TIME: Final = 5
RESTART: Final = 0.1  # of what passed; a time that falls back to less of it begins anew
# Words for the parts of a time: whole seconds, and what is left of a second
SECOND_WORDS: Final = frozenset(['s', 'sec', 'secs', 'second', 'seconds'])
FRACTIONS: Final = {
    unit: frozenset([unit, *words, *(f'{word}s' for word in words)])
    for unit, words in {
        'ns': ('nsec', 'nanosec', 'nanosecond', 'nano'),
        'us': ('usec', 'microsec', 'microsecond', 'micro'),
        'ms': ('msec', 'millisec', 'millisecond', 'milli'),
    }.items()
}
# Usual rates [Hz]
NICE: Final = (
    1, 2, 4, 5, 10, 15, 20, 24, 25, 30, 40, 50, 60, 75, 80, 90, 100, 120, 125, 128, 150, 180,
    200, 240, 250, 256, 300, 333, 360, 400, 480, 500, 512, 600, 800, 1000,
)  # fmt: skip


@final
class TimeBase(NamedTuple):
    """The time of a table."""

    seconds: Numbers  # since the first row, shape (n,) [s]
    entry: dict[str, str]  # as in a mapping
    first: float = 0.0  # time of the first row on the clock of the table [s]


def find_time_base(
    name: str, table: Columns, groups: list[ColumnGroup], choices: DraftChoices
) -> TimeBase:
    """Return the time of a table, with its reason in `choices`."""
    prefix = f'{name}.' if name else ''
    if f'{prefix}time.column' not in choices.answers and (split := _find_split_time(table)):
        choices.add_reason(f'{prefix}time', [split['column'], split['fraction']], 's',
                           f'whole seconds, and {split["fraction_unit"]} that begin again with '
                           'each')  # fmt: skip
        whole, rest = (table[split[key]] for key in ('column', 'fraction'))
        _refuse_second_log(split['column'], whole)
        seconds = (whole - whole[0]) + (rest - rest[0]) * SI_UNITS[split['fraction_unit']][1]
        first = float(whole[0]) + float(rest[0]) * SI_UNITS[split['fraction_unit']][1]
        return TimeBase(np.asarray(seconds, dtype=np.float64), split, first)
    column = choices.override(f'{prefix}time.column', find_time_column(table, groups))
    if column in table:
        return _read_time_column(prefix, column, table, groups, choices)
    count = len(next(iter(table.values())))
    rows = np.arange(count, dtype=np.float64)
    rate, why = _derive_rate(table, groups)
    if stated := choices.settled.get('rate'):
        rate, why = float(stated), 'the rate that the file states'
    key = f'{prefix}time.rate'
    if rate:
        rate_text = choices.override(key, f'{rate:g}')
    else:
        options = [(f'{hertz}', f'{hertz} rows per second') for hertz in (100, 50, 60, 200)]
        question = 'No velocity says how fast the rows follow.'
        rate_text = choices.decide(
            key, options, f'{_describe_times(table)} {question}', is_open=True
        )
        why = choices.explain(key)
    hertz = _parse_rate(key, rate_text)
    choices.add_reason(f'{prefix}time', [], f'{hertz:g} Hz', why)
    return TimeBase(rows / hertz, {'rate': f'{hertz:g} Hz'})


def _find_split_time(table: Columns) -> dict[str, str]:
    """Return the time of whole seconds in one column and the rest in another; {} without one."""
    whole, rest = [], []
    for column, cells in table.items():
        if cells.dtype.kind not in 'fiu' or not np.isfinite(cells).all():
            continue
        name = parse_column_name(column)
        words = name.words | {name.unit}
        fraction = next((one for one, its in FRACTIONS.items() if words & its), '')
        if fraction and cells.min() >= 0 and cells.max() * SI_UNITS[fraction][1] < 1.0:
            rest.append((column, fraction))
        elif (
            words & SECOND_WORDS
            and (cells == np.floor(cells)).all()
            and (np.diff(cells) >= 0).all()
        ):
            whole.append(column)
    for column in whole:
        for other, unit in rest:
            total = (table[column] - table[column][0]) + table[other] * SI_UNITS[unit][1]
            if _rises(np.asarray(total, dtype=np.float64)):
                return {'column': column, 'unit': 's', 'fraction': other, 'fraction_unit': unit}
    return {}


def _refuse_second_log(column: str, cells: Numbers) -> None:
    """Raise BadInput for a time that begins anew: its file holds two logs."""
    finite = np.flatnonzero(np.isfinite(cells))
    times = np.asarray(cells, dtype=np.float64)[finite]
    back = int(np.argmin(np.diff(times))) + 1
    passed = times[back - 1] - times[0]
    if passed > 0.0 and len(times) - back > 1 and times[back] - times[0] < RESTART * passed:
        raise BadInput(
            f"The times in column '{column}' begin anew in row {finite[back] + 1}, at "
            f'{times[back]:.10g} after {times[back - 1]:.10g}: another log begins there. Split '
            'the file, and import each part.'
        )


def _parse_rate(key: str, text: str) -> float:
    """Return a rate that the user gave [Hz]."""
    try:
        rate = float(text.removesuffix('Hz'))
    except ValueError:
        rate = 0.0
    if not 0.0 < rate < np.inf:
        raise BadInput(
            f"--set {key} is '{text}', but must be rows per second above 0, such as 50."
        )
    return rate


def _describe_times(table: Columns) -> str:
    """Return why no column is a time, in a sentence."""
    for column, cells in table.items():
        name = parse_column_name(column)
        if not (name.words | {name.axis}) & TIME_WORDS:
            continue
        if cells.dtype.kind in 'fiub' or is_time(str(cells[0])):
            return f"Column '{column}' does not rise from row to row, so it is no time."
        return f"Column '{column}' has cells such as '{cells[0]}', neither numbers nor dates."
    return 'No column is a time.'


def find_time_column(table: Columns, groups: list[ColumnGroup]) -> str:
    """Return the name of the time column, '' if there is none."""
    taken = {column for group in groups for column in group.columns}
    ranks = {column: _rank_as_time(column, cells) for column, cells in table.items()
             if column not in taken}  # fmt: skip
    best = min(ranks, key=lambda column: ranks[column], default='')
    first = next(iter(table))
    if best and ranks[best] < UNREADABLE:
        return best
    # Without a name: the first column, if it rises evenly
    if first in ranks and _is_rising_number(first, table[first]) and _is_even(table[first]):
        return first
    return best if best and ranks[best] == UNREADABLE else ''


def _rank_as_time(column: str, cells: Numbers) -> int:
    """Return how clearly a column is the time: 0 is the clearest, `NO_TIME` no time."""
    is_named = bool(parse_column_name(column).words & TIME_WORDS)
    if cells.dtype.kind in 'fiub':
        if not is_named:
            return NO_TIME
        if _is_rising_number(column, cells):
            return 0
        # Rows that were written several times have one time
        repeats = cells.dtype.kind in 'fiu' and _rises(np.unique(cells)) and _repeats(cells)
        return 2 if repeats else NO_TIME
    if not is_time(str(cells[0])):
        return NO_TIME
    try:
        times = parse_exact_times([str(cell) for cell in cells], 's', column).times
    except BadInput:
        # To read it says which row is wrong
        return UNREADABLE if is_named else NO_TIME
    if _rises((times - times[0]).astype(np.float64)):
        return 0 if is_date(str(cells[0])) else 1
    # To a second only
    is_coarse = times[-1] > times[0] and np.mean(np.diff(times) >= 0) > RISING_SHARE
    return 3 if is_coarse else NO_TIME


def _is_rising_number(column: str, cells: Numbers) -> bool:
    """Return whether a column has numbers that rise, and are not those of frames."""
    return cells.dtype.kind in 'fiub' and _rises(cells) and not _counts(column, cells)


def _rises(cells: Numbers) -> bool:
    """Return whether numbers rise nearly everywhere."""
    good = cells[np.isfinite(cells)]
    # The last row of a log that was cut may be a part of a number
    if len(good) < 2 or np.median(good[-3:]) <= good[0]:
        return False
    return bool(np.mean(np.diff(good) > 0.0) > RISING_SHARE)


def _repeats(cells: Numbers) -> bool:
    """Return whether times never fall, and rise at least in every third row."""
    # The last may be a part of a number, as above
    step = np.diff(cells[:-1])
    return len(step) > 1 and bool((step >= 0.0).all() and np.mean(step > 0.0) > REPEATED)


def _counts(column: str, cells: Numbers) -> bool:
    """Return whether a column numbers the frames of a camera, which says nothing of their rate."""
    counted = bool(parse_column_name(column).words & FRAMES)
    return counted and bool(np.mean(np.diff(cells[np.isfinite(cells)]) == 1.0) > 0.9)


def _is_even(cells: Numbers) -> bool:
    step = np.diff(cells)
    usual = float(np.median(step))
    return usual > 0.0 and float(np.median(np.abs(step - usual))) < 0.2 * usual


def _read_time_column(
    prefix: str, column: str, table: Columns, groups: list[ColumnGroup], choices: DraftChoices
) -> TimeBase:
    """Return the time of a column in the unit that fits."""
    cells = table[column]
    key = f'{prefix}time.unit'
    if cells.dtype.kind not in 'fiub':
        times = parse_exact_times([str(cell) for cell in cells], 's', column).times
        seconds = times.astype(np.float64) * 1e-9
        reading, why = ('durations', 'times of day, or what has passed')
        if is_date(str(cells[0])):
            reading, why = 'dates', 'dates with time of day'
        choices.add_reason(f'{prefix}time', [column], reading, why)
        return TimeBase(seconds - seconds[0], {'column': column}, float(seconds[0]))
    unit, why = _find_time_unit(column, cells, table, groups)
    if not unit:
        fitting = _list_units(cells)
        options = [
            (one, f'{1.0 / (_median_step(cells) * SI_UNITS[one][1]):.4g} rows per second')
            for one in fitting or EPOCHS
        ]
        question = 'The rate of the rows is plausible in each unit.'
        if not fitting:
            question = 'In no unit is the rate of the rows that of a flight log.'
        if len(fitting) == 1:
            question = 'The unit in the name gives a rate of the rows that no flight log has.'
        unit = choices.decide(key, options, question)
        why = choices.explain(key)
    unit = choices.override(key, unit)
    choices.add_reason(f'{prefix}time', [column], unit, why)
    _refuse_second_log(column, cells)
    first = cells[np.isfinite(cells)][0]
    scale = SI_UNITS[unit][1]
    entry = {'column': column, 'unit': unit}
    return TimeBase((cells - first) * scale, entry, float(first) * scale)


def _find_time_unit(
    column: str, cells: Numbers, table: Columns, groups: list[ColumnGroup]
) -> tuple[str, str]:
    """Return the unit of times and the reason; '' if several fit."""
    named = UNIT_WORDS.get(parse_column_name(column).unit, ('',))[0]
    fitting = _list_units(cells)
    if named in (*EPOCHS, *LONG_UNITS):
        # A name may be wrong: no flight log has a row every 20 s
        doubtful = fitting and not _is_usual(cells, named)
        return ('', '') if doubtful else (named, 'the unit in the name')
    first = float(cells[np.isfinite(cells)][0])
    is_short = not any(_is_usual(cells, unit) for unit in EPOCHS)
    if is_short and any(low < first < high for low, high in DAYS):
        raise BadInput(
            f"Column '{column}' counts days ({first:.6f}), as spreadsheets and MATLAB do; "
            'multiply what has passed since its first row by 86400, which gives seconds.'
        )
    for unit, least in EPOCHS.items():
        if least <= first < least * 10.0:
            return unit, 'the size of a time since 1970'
    rate, _ = _derive_rate(table, groups)
    if rate:
        step = _median_step(cells)
        best = min(EPOCHS, key=lambda unit: abs(np.log(step * SI_UNITS[unit][1] * rate)))
        return best, f'the derivative of the motion: {rate:g} rows per second'
    if len(fitting) == 1:
        step = _median_step(cells) * SI_UNITS[fitting[0]][1]
        return fitting[0], f'{1.0 / step:.4g} rows per second, the only plausible rate'
    return '', ''


def _list_units(cells: Numbers) -> list[str]:
    """Return the units in which the rate of the rows is that of a flight log."""
    usual, long = (
        [one for one in units if _is_usual(cells, one)] for units in (EPOCHS, LONG_UNITS)
    )
    return usual or long


def _is_usual(cells: Numbers, unit: str) -> bool:
    """Return whether the rate of the rows is that of a flight log, in a unit."""
    return LOG_RATES[0] <= 1.0 / (_median_step(cells) * SI_UNITS[unit][1]) <= LOG_RATES[1]


def _median_step(cells: Numbers) -> float:
    step = np.diff(cells[np.isfinite(cells)])
    rising = step[step > 0.0]
    return float(np.median(rising)) if len(rising) else 1.0


def _derive_rate(table: Columns, groups: list[ColumnGroup]) -> tuple[float, str]:
    """Return rows per second from velocity over movement per row; 0 if nothing says it [Hz]."""
    places = [group for group in groups if group.kind == 'position']
    speeds = [group for group in groups if group.kind == 'velocity']
    for place in places:
        for speed in speeds:
            if speed.role != place.role or speed.unit or place.unit:
                continue
            moved = np.linalg.norm(np.diff(place.stack(table), axis=0), axis=1)
            fast = np.linalg.norm(speed.stack(table), axis=1)[1:]
            # Only where it moves clearly
            good = np.isfinite(moved) & np.isfinite(fast) & (moved > 0.0)
            good &= fast > np.nanpercentile(fast, 30)
            if good.sum() < 20:
                continue
            rates = fast[good] / moved[good]
            rate = float(np.median(rates))
            spread = float(np.median(np.abs(rates / rate - 1.0)))
            if spread < 0.2 and LOG_RATES[0] <= rate <= LOG_RATES[1]:
                nice = min(NICE, key=lambda hertz: abs(np.log(hertz / rate)))
                close = abs(nice / rate - 1.0) < 0.05
                return float(nice if close else round(rate, 1)), (
                    f'{", ".join(speed.columns)} over the movement per row of '
                    f'{", ".join(place.columns)} gives {rate:.4g} Hz'
                )
    return 0.0, ''
