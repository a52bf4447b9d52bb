# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Resample signals; gaps stay gaps."""

from typing import Final, NamedTuple

from lta_data.even_grid import (
    BRIDGED_PERIODS,
    median_period,
    NO_SAMPLES,
    SampledSignal,
)
import numpy as np
from numpy.typing import NDArray

FULL_TURN_RADIANS: Final = 2.0 * np.pi
Array = NDArray[np.float64]


def wrap_angle(angle: Array) -> Array:
    """Return angles in [-pi, pi) [rad]."""
    return (angle + np.pi) % FULL_TURN_RADIANS - np.pi


def interpolate_signal(line: SampledSignal, at: Array, *, angular: bool = False) -> Array:
    """
    Interpolate a signal linearly at the times `at` [s].

    Angular values take the shorter way around. The result is NaN outside the signal, next to
    NaN values, and in gaps.
    """
    time, values = line
    if not len(time):
        return np.full(len(at), np.nan)
    after = np.minimum(np.searchsorted(time, at), len(time) - 1)
    # A sample at exactly the requested time counts even next to a gap or a NaN
    before = np.where(time[after] == at, after, np.maximum(after - 1, 0))
    length = time[after] - time[before]
    step = values[after] - values[before]
    # Along the shorter arc
    step = wrap_angle(step) if angular else step
    value = values[before] + step * (at - time[before]) / np.where(length > 0.0, length, 1.0)
    value = wrap_angle(value) if angular else value
    inside = (at >= time[0]) & (at <= time[-1])
    # Interpolation across a gap would invent data.
    is_known = inside & ~(length > BRIDGED_PERIODS * median_period(time))
    return np.where(is_known, np.where(length > 0.0, value, values[after]), np.nan)


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


def align_signals(a: SampledSignal, b: SampledSignal, *, angular: bool = False) -> AlignedSignals:
    """
    Return two signals at the times of the slower one, on their common span.

    The faster one is interpolated, never across a gap. At equal rates the times of `a` are used.
    """
    if not len(a.time) or not len(b.time):
        return AlignedSignals(NO_SAMPLES, NO_SAMPLES, NO_SAMPLES, NO_SAMPLES)
    # The 0.1 % margin keeps the choice stable when both rates are nominally equal.
    by_a = not median_period(b.time) > median_period(a.time) * (1.0 + 1e-3)
    at = a.time if by_a else b.time
    begin, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
    at = at[(at >= begin) & (at <= end)]
    of_a = interpolate_signal(a, at, angular=angular)
    of_b = interpolate_signal(b, at, angular=angular)
    difference = of_b - of_a
    return AlignedSignals(at, of_a, of_b, wrap_angle(difference) if angular else difference)


def break_at_gaps(line: SampledSignal) -> SampledSignal:
    """Insert a NaN into each gap, so that plots do not bridge it."""
    if len(line.time) < 2:
        return line
    steps = np.diff(line.time)
    after = np.flatnonzero(steps > BRIDGED_PERIODS * np.median(steps))
    when = line.time[after] + 0.5 * steps[after]
    return SampledSignal(
        np.insert(line.time, after + 1, when), np.insert(line.values, after + 1, np.nan)
    )
