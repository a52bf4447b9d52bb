# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Filter a linearized flight: a Kalman filter whose estimates are linear in the parameters.

The filter's state is the change of the vehicle's state from its measured motion, an unexplained
wrench on each axis (an Ornstein-Uhlenbeck process), the correlated part of the tracker's error on
each channel, and the slow part of the pressure's error (others). Every estimate is carried as
columns: its slope by each parameter, and its value where the parameters are 0. So one pass gives
the likelihood of all readings as a quadratic form in the parameters (Harvey, Forecasting,
structural time series models and the Kalman filter, 1989, section 3.4), and the error of each
forecast as a linear one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.compilation.compiler import compile_kernel
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.replay.replay import AXIS_COUNT
from lta_discovery.replay.state_changes import STATE_WIDTH
from lta_discovery.state_filter.linear_flight import LinearFlight, POSE_SIZE
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

PRESSURE_CHANNEL: Final = 13  # channel of the barometer
FILTER_SIZE: Final = STATE_WIDTH + AXIS_COUNT + POSE_SIZE + 1
BUFFERED: Final = 256  # rows
# Deviations of the first state from its polynomial: m, rad, m/s, rad/s
START: Final = np.array([0.05] * 3 + [0.1] * 3 + [0.2] * 6)
WEATHER: Final = 2.4  # Pa; slow error of the pressure, that of 20 cm of air
WEATHER_TIME: Final = 600.0  # s; in which it changes


@final
@dataclass(frozen=True, slots=True)
class FilteredFlight:
    """
    What a filter made of a flight with K parameters.

    The last row or column of K + 1 belongs to parameters of 0.
    """

    products: Array  # of the whitened innovations, shape (K + 1, K + 1)
    log_determinant: float  # of their covariances
    # At each start of a forecast: state estimated by the readings so far, and products up to
    # there, shape (S, FILTER_SIZE, K + 1), (S, K + 1, K + 1)
    states: Array
    sums: Array
    # Measured less forecast pose at each horizon; NaN where unknown, shape (S, H, 6, K + 1)
    errors: Array


def filter_flight(
    flight: LinearFlight,
    noise: NoiseModel,
    starts: Indices | None = None,
    horizons: Sequence[float] = (),
) -> FilteredFlight:
    """
    Filter a flight, and forecast from some of its grid points.

    `horizons`: how far ahead, rising. [s]
    """
    starts = np.zeros(0, dtype=np.int64) if starts is None else starts
    ahead = np.array([round(one / GRID_PERIOD) for one in horizons], dtype=np.int64)
    count = flight.moved.shape[2] + 1
    states, sums = (
        np.zeros((len(starts), FILTER_SIZE, count)),
        np.zeros((len(starts), count, count)),
    )
    errors = np.full((len(starts), len(ahead), POSE_SIZE, count), np.nan)
    products, log_determinant = np.zeros((count, count)), 0.0
    keep, spread, memory = describe_noise(noise)
    for (begin, end), begun in zip(flight.runs, flight.begun, strict=True):
        inside = np.flatnonzero((starts >= begin) & (starts < end))
        own, more = np.zeros((count, count)), np.zeros(1)
        parts = np.zeros((len(inside), FILTER_SIZE, count)), np.zeros((len(inside), count, count))
        missed = np.full((len(inside), len(ahead), POSE_SIZE, count), np.nan)
        _filter_run(
            flight.step, flight.push, flight.moved, flight.defect, flight.left, flight.read,
            flight.felt, flight.read_moved, flight.count, begun, begin, end, keep, spread, memory,
            noise.white**2, starts[inside], ahead, own, more, *parts, missed,
        )  # fmt: skip
        products += own
        log_determinant += float(more[0])
        # In a later run the flight's own parameters are known from the earlier ones
        states[inside], sums[inside], errors[inside] = parts[0], parts[1] + products - own, missed
    return FilteredFlight(products, log_determinant, states, sums, errors)


def describe_noise(noise: NoiseModel) -> tuple[Array, Array, Array]:
    """Return initial variances, variances added and factors kept in each period."""
    memory = np.concatenate([noise.memory, np.full(POSE_SIZE, noise.correlation), [WEATHER_TIME]])
    fading = np.concatenate([np.ones(STATE_WIDTH), np.exp(-GRID_PERIOD / memory)])
    first = np.concatenate([START, noise.wrench, noise.correlated, [WEATHER]]) ** 2
    added = first * (1.0 - fading**2)
    return first, added, fading


@compile_kernel
def whiten_rows(lower: NDArray[np.floating], rows: Array) -> None:
    """Solve `lower @ out = rows`; the rows are written."""
    for i in range(len(lower)):
        for m in range(i):
            for j in range(rows.shape[1]):
                rows[i, j] -= lower[i, m] * rows[m, j]
        for j in range(rows.shape[1]):
            rows[i, j] /= lower[i, i]


@compile_kernel
def advance_filter(
    x: Array, s: Array, step: Array, push: Array, fading: Array, added: Array
) -> None:
    """
    Take states and their covariance over a period; both are written.

    Only the first twelve change by the model; the others fade.
    """
    wide = step @ s[:12] + push @ s[12:18]
    x[:12] = step @ x[:12] + push @ x[12:18]
    s[:12, :12] = wide[:, :12].copy() @ step.T + wide[:, 12:18].copy() @ push.T
    for i in range(12, len(s)):
        for j in range(x.shape[1]):
            x[i, j] *= fading[i]
        for j in range(12):
            s[j, i] = wide[j, i] * fading[i]
            s[i, j] = s[j, i]
        for j in range(12, len(s)):
            s[i, j] *= fading[i] * fading[j]
        s[i, i] += added[i]


@compile_kernel
def _filter_run(
    step: Array,
    push: Array,
    moved: Array,
    defect: Array,
    left: Array,
    read: Array,
    felt: Array,
    read_moved: Array,
    count: Array,
    begun: Array,
    begin: int,
    end: int,
    first: Array,
    added: Array,
    fading: Array,
    white: Array,
    starts: Indices,
    ahead: Indices,
    products: Array,
    log_determinant: Array,
    states: Array,
    sums: Array,
    errors: Array,
) -> None:
    """Filter the grid points from `begin` to `end`; the last six arrays are written."""
    size, columns, channels = len(first), moved.shape[2] + 1, left.shape[1]
    x, s = np.zeros((size, columns)), np.diag(first)
    for i in range(12):
        for j in range(columns - 1):
            x[i, j] = begun[i, j]
    h, e = np.zeros((channels, size)), np.zeros((channels, columns))
    which, next_start = np.zeros(channels, dtype=np.int64), 0
    # Whitened innovations whose products are added together, which is faster
    rows, filled = np.zeros((BUFFERED, columns)), 0
    for k in range(begin, end):
        n = 0
        for c in range(channels):
            if np.isfinite(left[k, c]) and (c >= 6 or count[k] > 0.0):
                which[n] = c
                n += 1
        if n > 0:
            for i in range(n):
                c = which[i]
                h[i] = 0.0
                for j in range(12):
                    h[i, j] = read[k, c, j]
                for j in range(6):
                    h[i, 12 + j] = felt[k, c, j]
                if c < 6:
                    h[i, 18 + c] = 1.0
                elif c == PRESSURE_CHANNEL:
                    h[i, size - 1] = 1.0
                for j in range(columns - 1):
                    e[i, j] = -read_moved[k, c, j]
                e[i, columns - 1] = left[k, c]
                for m in range(size):
                    if h[i, m] != 0.0:
                        for j in range(columns):
                            e[i, j] -= h[i, m] * x[m, j]
            cross = s @ h[:n].T
            v = h[:n] @ cross
            for i in range(n):
                c = which[i]
                v[i, i] += white[c] / count[k] if c < 6 else white[c]
            lower = np.linalg.cholesky(v)
            for i in range(n):
                log_determinant[0] += 2.0 * math.log(lower[i, i])
            gain = cross.T.copy()
            whiten_rows(lower, gain)
            whiten_rows(lower, e[:n])
            if filled + n > BUFFERED:
                products += rows[:filled].T @ rows[:filled]
                filled = 0
            rows[filled : filled + n] = e[:n]
            filled += n
            x += gain.T @ e[:n]
            s -= gain.T @ gain
        if next_start < len(starts) and starts[next_start] == k:
            products += rows[:filled].T @ rows[:filled]
            filled = 0
            states[next_start] = x
            sums[next_start] = products
            _forecast(
                x,
                step,
                push,
                moved,
                defect,
                left,
                read,
                read_moved,
                count,
                k,
                end,
                fading,
                ahead,
                errors[next_start],
            )
            next_start += 1
        advance_filter(x, s, step[k], push[k], fading, added)
        for i in range(12):
            for j in range(columns - 1):
                x[i, j] += moved[k, i, j]
            x[i, columns - 1] += defect[k, i]
    products += rows[:filled].T @ rows[:filled]


@compile_kernel
def _forecast(
    x: Array,
    step: Array,
    push: Array,
    moved: Array,
    defect: Array,
    left: Array,
    read: Array,
    read_moved: Array,
    count: Array,
    begin: int,
    end: int,
    fading: Array,
    ahead: Indices,
    errors: Array,
) -> None:
    """Write the errors of a forecast without further readings."""
    columns, h = moved.shape[2], 0
    state, wrench = x[:12].copy(), x[12:18].copy()
    if len(ahead) == 0:
        return
    for k in range(begin, min(end, begin + ahead[-1] + 1)):
        if k - begin == ahead[h]:
            if count[k] > 0.0 and np.isfinite(left[k, 0]):
                errors[h] = -(read[k, :6] @ state)
                errors[h, :, :columns] -= read_moved[k, :6]
                errors[h, :, columns] += left[k, :6]
            h += 1
            if h == len(ahead):
                break
        state = step[k] @ state + push[k] @ wrench
        for i in range(12):
            for j in range(columns):
                state[i, j] += moved[k, i, j]
            state[i, columns] += defect[k, i]
        for i in range(6):
            for j in range(columns + 1):
                wrench[i, j] *= fading[12 + i]
