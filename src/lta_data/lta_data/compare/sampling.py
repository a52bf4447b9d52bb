"""Sort and resample signals; gaps stay gaps."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

GAP: Final = 2.5  # periods without a message that count as a gap
TURN: Final = 2.0 * np.pi
ABSURD: Final = 1e30  # larger than any real value: some drivers write it for 'unknown'
Array = NDArray[np.float64]


class SampledSignal(NamedTuple):
    """Times [s], increasing, and values, both of shape (n,); NaN marks an unknown value."""

    time: Array
    values: Array


def mask_absurd_values(values: ArrayLike) -> Array:
    """Replace infinite and absurdly large values by NaN."""
    numbers = np.asarray(values, dtype=np.float64)
    return np.where(np.abs(numbers) < ABSURD, numbers, np.nan)


def sort_samples(time: ArrayLike, values: ArrayLike) -> SampledSignal:
    """
    Return a signal sorted by time; of several values at one time, the first.

    Samples with a non-finite time are dropped.
    """
    when = np.asarray(time, dtype=np.float64).ravel()
    what = np.asarray(values, dtype=np.float64).ravel()
    usable = np.isfinite(when)
    # np.unique sorts and returns the index of the first occurrence.
    when, first = np.unique(when[usable], return_index=True)
    what = what[usable][first]
    return SampledSignal(when, mask_absurd_values(what))


def median_period(time: Array) -> float:
    """Return the median time between samples, NaN for fewer than two. [s]"""
    return float(np.median(np.diff(time))) if len(time) > 1 else float('nan')


def wrap_angle(angle: Array) -> Array:
    """Return angles in [-pi, pi). [rad]"""
    return (angle + np.pi) % TURN - np.pi


def interpolate_signal(
    line: SampledSignal, at: Array, *, angular: bool = False, gap: float = GAP
) -> Array:
    """
    Interpolate a signal linearly at the times `at`. [s]

    Angular values take the shorter way around. The result is NaN outside the signal, next to
    NaN values, and between samples more than `gap` median periods apart.
    """
    interpolated = np.full(len(at), np.nan)
    if not len(line.time):
        return interpolated
    right = np.searchsorted(line.time, at)
    # A sample at exactly the requested time counts even next to a gap or a NaN.
    # side='left': an equal time is at index `right`
    exact = right < len(line.time)
    exact[exact] = line.time[right[exact]] == at[exact]
    interpolated[exact] = line.values[right[exact]]
    between = ~exact & (right > 0) & (right < len(line.time))
    j = right[between]
    length = line.time[j] - line.time[j - 1]
    step = line.values[j] - line.values[j - 1]
    # Along the shorter arc
    step = wrap_angle(step) if angular else step
    value = line.values[j - 1] + step * (at[between] - line.time[j - 1]) / length
    value = wrap_angle(value) if angular else value
    # Interpolation across a gap would invent data.
    interpolated[between] = np.where(length > gap * median_period(line.time), np.nan, value)
    return interpolated


class AlignedSignals(NamedTuple):
    """Two signals at the same times."""

    time: Array  # times of the slower signal, shape (n,) [s]
    # Values; NaN where unknown, shape (n,)
    a: Array
    b: Array
    difference: Array  # b minus a; for angles, the shorter way around, shape (n,)

    @property
    def both_valid(self) -> NDArray[np.bool_]:
        """Mask of the times at which both are known."""
        return np.isfinite(self.difference)


def align_signals(
    a: SampledSignal, b: SampledSignal, *, angular: bool = False, gap: float = GAP
) -> AlignedSignals:
    """
    Return two signals at the times of the slower one, on their common span.

    The faster one is interpolated, never across a gap. At equal rates the times of `a` are used.
    """
    if not len(a.time) or not len(b.time):
        nothing = np.empty(0)
        return AlignedSignals(nothing, nothing, nothing, nothing)
    # The 0.1 % margin keeps the choice stable when both rates are nominally equal.
    by_a = not median_period(b.time) > median_period(a.time) * (1.0 + 1e-3)
    at = a.time if by_a else b.time
    begin, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
    at = at[(at >= begin) & (at <= end)]
    of_a = interpolate_signal(a, at, angular=angular, gap=gap)
    of_b = interpolate_signal(b, at, angular=angular, gap=gap)
    difference = of_b - of_a
    return AlignedSignals(at, of_a, of_b, wrap_angle(difference) if angular else difference)


def break_at_gaps(line: SampledSignal, gap: float = GAP) -> SampledSignal:
    """Insert a NaN into each gap, so that plots do not bridge it."""
    if len(line.time) < 2:
        return line
    steps = np.diff(line.time)
    after = np.flatnonzero(steps > gap * np.median(steps))
    when = line.time[after] + 0.5 * steps[after]
    return SampledSignal(
        np.insert(line.time, after + 1, when), np.insert(line.values, after + 1, np.nan)
    )
