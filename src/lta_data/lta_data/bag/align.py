"""
Align several topics on one clock.

Each topic has its own times. On a common clock a column has the latest value before each instant
(`previous_weights`: what an onboard program would know), or is interpolated linearly
(`linear_weights`); quaternions are interpolated by slerp. Integers, flags and texts always take
the latest value. Gaps are never bridged: columns are empty where no message is near enough.
"""

from collections.abc import Callable, Sequence
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput, unknown_name_error
from lta_data.bag.table import AXES, RecordingTable
from lta_data.bag.table_text import DIM
from lta_data.even_grid import check_time_span
import numpy as np
from numpy.typing import NDArray

DENSE: Final = 20.0  # rows of an even clock per message of the longest topic, at most
TINY: Final = 1e-8  # rad; for smaller angles slerp equals linear interpolation
PERIODS: Final = 3.0  # default of the maximum gap, in periods of the topic
LEFT_OUT: Final = ('clock.', 'stamp.')  # prefixes of columns without use on another clock

Stamps = NDArray[np.int64]


@final
class SortedRows(NamedTuple):
    """Rows of a topic sorted by stamp, the last one of each stamp. [ns]"""

    stamps: Stamps
    rows: NDArray[np.intp]


@final
class ResamplingWeights(NamedTuple):
    """
    How to compute values at other times from rows.

    `before` and `after` are the neighbouring rows, `share` the relative position between them, and
    `known` whether there is a value.
    """

    before: NDArray[np.intp]
    after: NDArray[np.intp]
    share: NDArray[np.float64]
    valid: NDArray[np.bool_]


def previous_weights(rows: SortedRows, clock: Stamps, gap: float) -> ResamplingWeights:
    """Return the latest row at each instant, if it is no older than the gap. [ns]"""
    # side='right': a row exactly at the instant counts as known
    index = np.searchsorted(rows.stamps, clock, side='right') - 1
    row = rows.rows[np.maximum(index, 0)]
    valid = (index >= 0) & (clock - rows.stamps[np.maximum(index, 0)] <= gap)
    return ResamplingWeights(row, row, np.zeros(len(clock)), valid)


def linear_weights(rows: SortedRows, clock: Stamps, gap: float) -> ResamplingWeights:
    """Return the rows around each instant, if they are no farther apart than the gap. [ns]"""
    last = len(rows.stamps) - 1
    left = np.searchsorted(rows.stamps, clock, side='right') - 1
    inside = np.clip(left, 0, last)
    hit = rows.stamps[inside] == clock
    right = np.where(hit, inside, np.minimum(inside + 1, last))
    apart = rows.stamps[right] - rows.stamps[inside]
    # On a hit both rows are the same: the 1 ns avoids 0 / 0
    share = (clock - rows.stamps[inside]) / np.maximum(apart, 1)
    valid = (left >= 0) & (hit | ((left < last) & (apart <= gap)))
    return ResamplingWeights(
        rows.rows[inside], rows.rows[right], np.where(valid, share, 0.0), valid
    )


METHODS: Final[dict[str, Callable[[SortedRows, Stamps, float], ResamplingWeights]]] = {
    'previous': previous_weights,
    'linear': linear_weights,
}


def align_tables(
    tables: Sequence[RecordingTable],
    clock: Stamps,
    method: str = 'previous',
    gap: float | None = None,
) -> RecordingTable:
    """
    Align several topics to one clock.

    Parameters
    ----------
    tables : sequence of RecordingTable
        The topics, all with the same start.
    clock : ndarray of int64, shape (n,)
        Stamps of the new rows, in order. [ns]
    method : str
        'previous' or 'linear'.
    gap : float, optional
        Maximum gap of a topic; three of its median periods by default. [s]

    Returns
    -------
    RecordingTable
        Columns named 'odom/pose.pose.position.x', without stamps, headers and covariances. NaN,
        or '' for texts, in gaps.

    Raises
    ------
    BadInput
        If the method is unknown, or the gap is not above zero.

    """
    if method not in METHODS:
        raise unknown_name_error('method', method, list(METHODS))
    if gap is not None and not is_within(gap, np.inf):
        raise BadInput(
            f'The maximum gap is {gap!r}, but must be a number above 0; give it in seconds.'
        )
    if not tables:
        raise BadInput('No topics to align were given; name at least one.')
    data: dict[str, NDArray[Any]] = {}
    units: dict[str, str] = {}
    for table in tables:
        rows = sort_rows(table.stamp_ns)
        weights = METHODS[method](rows, clock, maximum_gap(rows, gap)) if len(table) else None
        for name, values in resample_columns(table, weights, len(clock)).items():
            data[f'{table.name}/{name}'] = values
            units[f'{table.name}/{name}'] = table.units.get(name, '')
    name = ' + '.join(table.name for table in tables)
    return RecordingTable(name, clock, tables[0].start, data, units)


def sort_rows(stamps: Stamps) -> SortedRows:
    """Sort rows by stamp, keeping the last one of each stamp."""
    order = np.argsort(stamps, kind='stable')
    if not len(order):
        return SortedRows(stamps, order)
    # The sort is stable, so the last of equal stamps is the latest message.
    last = np.append(np.diff(stamps[order]) > 0, True)
    return SortedRows(stamps[order][last], order[last])


def is_within(value: object, most: float) -> bool:
    """Return whether a value is a number above 0 and at most `most`."""
    return isinstance(value, int | float | np.number) and bool(0.0 < value <= most)


def maximum_gap(rows: SortedRows, gap: float | None) -> float:
    """Return the maximum gap of a topic. [ns]"""
    if gap is not None:
        return gap * 1e9
    return PERIODS * float(np.median(np.diff(rows.stamps))) if len(rows.stamps) > 1 else np.inf


def build_even_clock(tables: Sequence[RecordingTable], rate: float) -> Stamps:
    """Return an even clock over all rows of some tables; rate in Hz. [ns]"""
    if not is_within(rate, 1e6):
        raise BadInput(
            f'The rate is {rate!r}, but must be a number above 0 and at most 1e6; give it in Hz.'
        )
    stamps = [table.stamp_ns for table in tables if len(table)]
    if not stamps:
        return np.empty(0, np.int64)
    start = tables[0].start
    # Relative to the start: float64 seconds since 1970 resolve only 0.2 us
    first = (min(int(each.min()) for each in stamps) - start) * 1e-9
    last = (max(int(each.max()) for each in stamps) - start) * 1e-9
    most = max(map(len, stamps))
    check_time_span('', last - first, 1.0 / rate, most, DENSE, 'give a lower rate')
    # The tolerance keeps end points that are off by rounding.
    steps = np.arange(np.ceil(first * rate - 1e-6), np.floor(last * rate + 1e-6) + 1)
    return start + np.rint(steps * (1e9 / rate)).astype(np.int64)


def resample_columns(
    table: RecordingTable, weights: ResamplingWeights | None, count: int
) -> dict[str, NDArray[Any]]:
    """Return the columns of a table at other times, shape (n, ...); empty in gaps."""
    columns = {}
    turns = {f'{turn}.{axis}': turn for turn in table.quaternions for axis in AXES}
    turned: dict[str, NDArray[np.float64]] = {}
    for name in table.stored_columns:
        if DIM.search(name) or name.startswith(LEFT_OUT):
            continue
        values = table[name]
        if weights is None or not len(values):
            columns[name] = np.full(count, '' if values.dtype.kind == 'U' else np.nan)
        elif name in turns:
            turn = turns[name]
            # The four components are interpolated together, once
            if turn not in turned:
                turned[turn] = interpolate_quaternions(table.vector(turn), weights)
            columns[name] = turned[turn][:, AXES.index(name[-1])]
        else:
            columns[name] = interpolate_values(values, weights)
    return columns


def interpolate_values(values: NDArray[Any], weights: ResamplingWeights) -> NDArray[Any]:
    """Resample a column of shape (m, ...) to shape (n, ...)."""
    interpolated = values[weights.before]
    # Only floats are interpolated: integers are counts or codes, texts have no mean
    if values.dtype.kind == 'f':
        between = weights.share > 0.0
        change = values[weights.after[between]] - interpolated[between]
        interpolated[between] += weights.share[between] * change
    if weights.valid.all():
        return interpolated
    nothing: Any = '' if values.dtype.kind == 'U' else np.nan
    return np.where(weights.valid, interpolated, nothing)


def interpolate_quaternions(
    turns: NDArray[np.float64], weights: ResamplingWeights
) -> NDArray[np.float64]:
    """Interpolate quaternions by slerp along the shorter arc, shape (n, 4)."""
    interpolated = turns[weights.before]
    between = weights.share > 0.0
    one, other, share = (
        interpolated[between],
        turns[weights.after[between]],
        weights.share[between],
    )
    with np.errstate(invalid='ignore'):  # an unfilled zero quaternion becomes NaN
        one = one / np.linalg.norm(one, axis=1, keepdims=True)
        other = other / np.linalg.norm(other, axis=1, keepdims=True)
    cosine = np.einsum('ij,ij->i', one, other)
    # q and -q are one attitude: take the nearer one.
    other *= np.where(cosine < 0.0, -1.0, 1.0)[:, None]
    # atan2 is accurate for small and large angles, unlike arccos.
    apart, mean = np.linalg.norm(other - one, axis=1), np.linalg.norm(other + one, axis=1)
    angle = 2.0 * np.arctan2(apart, mean)
    tiny = angle < TINY
    # Any value but zero; it is not used where tiny
    whole = np.where(tiny, 1.0, angle)
    first = np.where(tiny, 1.0 - share, np.sin((1.0 - share) * whole) / np.sin(whole))
    second = np.where(tiny, share, np.sin(share * whole) / np.sin(whole))
    interpolated[between] = first[:, None] * one + second[:, None] * other
    return np.where(weights.valid[:, None], interpolated, np.nan)
