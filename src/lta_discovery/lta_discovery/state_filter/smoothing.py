# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Smooth a linearized flight: the most probable states and unexplained wrench, by all readings.

The backward pass is that of Bryson and Frazier, which inverts no covariance of states (Bierman,
Factorization methods for discrete sequential estimation, 1977, chapter X). What it carries also
tells how the likelihood changes with the noise (Koopman and Shephard, Biometrika 79, 1992).
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_config.compilation.compiler import compile_kernel
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.replay.replay import AXIS_COUNT
from lta_discovery.replay.state_changes import apply_state_changes, STATE_WIDTH
from lta_discovery.state_filter.kalman import (
    advance_filter,
    describe_noise,
    FILTER_SIZE,
    FilteredFlight,
    PRESSURE_CHANNEL,
    whiten_rows,
)
from lta_discovery.state_filter.linear_flight import LinearFlight, POSE_SIZE
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

WRENCH_STATES: Final = slice(STATE_WIDTH, STATE_WIDTH + AXIS_COUNT)
FADING: Final = (
    FILTER_SIZE - STATE_WIDTH
)  # states that fade: wrench, and errors of tracker and barometer


@final
class SmoothedFlight(NamedTuple):
    """Most probable motion and unexplained wrench at each grid point; NaN outside of the runs."""

    motion: Array  # of the body in the map, shape (n, 13)
    wrench: Array  # on the body axes, shape (n, 6) [N, N m]
    deviation: Array  # standard deviation of the wrench, shape (n, 6)


@final
class FilteredRun(NamedTuple):
    """
    All that a filter computes in a run of k grid points, with C columns.

    A column is a slope by a parameter; the last one is the value where the parameters are 0. Of m
    channels, those that were read come first.
    """

    number: Indices  # channels that were read at a point, shape (k,)
    which: Indices  # these channels, shape (k, m)
    rows: Array  # of their readings, by the state, shape (k, m, FILTER_SIZE)
    lower: Array  # Cholesky factors of the covariances of the innovations, shape (k, m, m)
    innovations: Array  # whitened, shape (k, m, C)
    gains: Array  # whitened, shape (k, m, FILTER_SIZE)
    states: Array  # by the readings up to a point, shape (k, FILTER_SIZE, C)
    spread: Array  # covariance of these, shape (k, FILTER_SIZE, FILTER_SIZE)


@final
class NoiseSlopes(NamedTuple):
    """Slopes of the log likelihood of a run by the noise."""

    first: Array  # by the variances of fading states in the beginning, shape (FADING,)
    added: Array  # by the variances added in each period, shape (FADING,)
    fading: Array  # by the factors kept in each period, shape (FADING,)
    white: Array  # by the variances of readings, shape (m,)


def smooth_flight(flight: LinearFlight, noise: NoiseModel, values: Array) -> SmoothedFlight:
    """
    Smooth a flight with given parameters.

    `values`: relative to those about which the flight is linearized, shape (K,).
    """
    states = np.full((len(flight.motion), FILTER_SIZE), np.nan)
    spread = np.full((len(flight.motion), AXIS_COUNT), np.nan)
    mean = np.append(values, 1.0)[:, None]
    for k, (begin, end) in enumerate(flight.runs):
        run = filter_run(flight, noise, k, mean)
        states[begin:end], spread[begin:end] = go_back(flight, noise, k, run)[:2]
    motion = apply_state_changes(flight.motion, states[:, :STATE_WIDTH])
    return SmoothedFlight(motion, states[:, WRENCH_STATES], np.sqrt(spread))


def filter_run(
    flight: LinearFlight, noise: NoiseModel, k: int, mix: Array | None = None
) -> FilteredRun:
    """
    Filter a run of a flight.

    `mix`: shape (K + 1, C); the columns are those of the parameters and of the values without
    them, times this. Without it they are those themselves.
    """
    (begin, end), channels = flight.runs[k], flight.left.shape[1]
    inside = slice(begin, end)
    moved = np.concatenate([flight.moved[inside], flight.defect[inside, :, None]], axis=2)
    off = np.concatenate([-flight.read_moved[inside], flight.left[inside, :, None]], axis=2)
    measured = np.isfinite(flight.left[inside])
    measured[:, :POSE_SIZE] &= flight.count[inside, None] > 0.0
    off[~measured] = 0.0
    begun = np.pad(flight.begun[k], ((0, 0), (0, 1)))
    if mix is not None:
        moved, off, begun = moved @ mix, off @ mix, begun @ mix
    count, columns = end - begin, begun.shape[1]
    run = FilteredRun(
        np.zeros(count, dtype=np.int64), np.zeros((count, channels), dtype=np.int64),
        np.zeros((count, channels, FILTER_SIZE)), np.zeros((count, channels, channels)),
        np.zeros((count, channels, columns)), np.zeros((count, channels, FILTER_SIZE)),
        np.zeros((count, FILTER_SIZE, columns)), np.zeros((count, FILTER_SIZE, FILTER_SIZE)),
    )  # fmt: skip
    _filter_run(
        flight.step[inside], flight.push[inside], moved, off, measured, flight.read[inside],
        flight.felt[inside], flight.count[inside], begun, *describe_noise(noise),
        noise.white**2, run.number, run.which, run.rows, run.lower, run.innovations, run.gains,
        run.states, run.spread,
    )  # fmt: skip
    return run


def sum_runs(runs: Sequence[FilteredRun], columns: int) -> FilteredFlight:
    """Return the likelihood of the runs of a flight with some columns, without forecasts."""
    products, log_determinant = np.zeros((columns, columns)), 0.0
    for one in runs:
        flat, roots = one.innovations.reshape(-1, columns), one.lower.diagonal(axis1=1, axis2=2)
        products += flat.T @ flat
        log_determinant += 2.0 * float(np.sum(np.log(roots[roots > 0.0])))
    none = np.zeros((0, 0, 0))
    return FilteredFlight(products, log_determinant, none, none, none)


def go_back(
    flight: LinearFlight, noise: NoiseModel, k: int, run: FilteredRun
) -> tuple[Array, Array, NoiseSlopes]:
    """
    Return the states by all readings, the variance of the wrench, and slopes by the noise.

    The states are those of the last column, shape (k, FILTER_SIZE). The slopes are sums over the
    columns, as those of the columns of a square root of the second moments of the parameters are.
    """
    (begin, end), channels = flight.runs[k], flight.left.shape[1]
    states, spread = np.zeros((end - begin, FILTER_SIZE)), np.zeros((end - begin, AXIS_COUNT))
    slopes = NoiseSlopes(*(np.zeros(n) for n in (FADING, FADING, FADING, channels)))
    fading = describe_noise(noise)[2]
    _go_back(
        flight.step[begin:end], flight.push[begin:end], flight.count[begin:end], fading,
        run.number, run.which, run.rows, run.lower, run.innovations, run.gains, run.states,
        run.spread, states, spread, *slopes,
    )  # fmt: skip
    return states, spread, slopes


def log_slopes(noise: NoiseModel, runs: NoiseSlopes) -> Array:
    """Return slopes by the learned numbers of a noise model (`NoiseModel.logarithms`)."""
    first, _, fading = (each[STATE_WIDTH:] for each in describe_noise(noise))
    memory = np.concatenate([noise.memory, np.full(POSE_SIZE, noise.correlation)])
    size = 2.0 * first * (runs.first + (1.0 - fading**2) * runs.added)
    lasting = (runs.fading - 2.0 * fading * first * runs.added)[: AXIS_COUNT + POSE_SIZE]
    lasting *= fading[: AXIS_COUNT + POSE_SIZE] * GRID_PERIOD / memory
    white = 2.0 * noise.white[:POSE_SIZE] ** 2 * runs.white[:POSE_SIZE]
    half = AXIS_COUNT // 2
    tracker, wrench = slice(AXIS_COUNT, AXIS_COUNT + POSE_SIZE), slice(0, AXIS_COUNT)
    return np.concatenate([
        white.reshape(2, half).sum(axis=1),
        size[tracker].reshape(2, half).sum(axis=1),
        [lasting[tracker].sum()],
        size[wrench],
        lasting[wrench].reshape(2, half).sum(axis=1),
    ])  # fmt: skip


@compile_kernel
def _filter_run(
    step: Array,
    push: Array,
    moved: Array,
    off: Array,
    measured: NDArray[np.bool_],
    read: Array,
    felt: Array,
    count: Array,
    begun: Array,
    first: Array,
    added: Array,
    fading: Array,
    white: Array,
    number: Indices,
    which: Indices,
    rows: Array,
    lower: Array,
    innovations: Array,
    gains: Array,
    states: Array,
    spread: Array,
) -> None:
    """Filter all grid points of a run; the last eight arrays are written."""
    x, s = np.zeros((FILTER_SIZE, begun.shape[1])), np.diag(first)
    x[:STATE_WIDTH] = begun
    for k in range(len(step)):
        n = 0
        for c in range(measured.shape[1]):
            if measured[k, c]:
                which[k, n] = c
                rows[k, n, :STATE_WIDTH] = read[k, c]
                rows[k, n, STATE_WIDTH : STATE_WIDTH + AXIS_COUNT] = felt[k, c]
                if c < POSE_SIZE:
                    rows[k, n, STATE_WIDTH + AXIS_COUNT + c] = 1.0
                elif c == PRESSURE_CHANNEL:
                    rows[k, n, FILTER_SIZE - 1] = 1.0
                innovations[k, n] = off[k, c]
                n += 1
        number[k] = n
        if n > 0:
            h = rows[k, :n]
            cross = h @ s
            v = cross @ h.T
            for i in range(n):
                c = which[k, i]
                v[i, i] += white[c] / count[k] if c < POSE_SIZE else white[c]
            root = np.linalg.cholesky(v)
            lower[k, :n, :n] = root
            gains[k, :n] = cross
            innovations[k, :n] -= h @ x
            whiten_rows(root, gains[k, :n])
            whiten_rows(root, innovations[k, :n])
            x += gains[k, :n].T @ innovations[k, :n]
            s -= gains[k, :n].T @ gains[k, :n]
        states[k], spread[k] = x, s
        advance_filter(x, s, step[k], push[k], fading, added)
        x[:STATE_WIDTH] += moved[k]


@compile_kernel
def _unwhiten_rows(lower: NDArray[np.floating], rows: Array) -> None:
    """Solve `lower.T @ out = rows`; the rows are written."""
    for i in range(len(lower) - 1, -1, -1):
        for m in range(i + 1, len(lower)):
            for j in range(rows.shape[1]):
                rows[i, j] -= lower[m, i] * rows[m, j]
        for j in range(rows.shape[1]):
            rows[i, j] /= lower[i, i]


@compile_kernel
def _pull_back(r: Array, step: Array, push: Array, fading: Array) -> Array:
    """Return the transpose of a period's transition times some columns."""
    out = np.empty_like(r)
    out[:12] = step.T @ r[:12]
    out[12:18] = push.T @ r[:12]
    for i in range(12, len(r)):
        for j in range(r.shape[1]):
            out[i, j] = fading[i] * r[i, j] + (out[i, j] if i < 18 else 0.0)
    return out


@compile_kernel
def _go_back(
    step: Array,
    push: Array,
    count: Array,
    fading: Array,
    number: Indices,
    which: Indices,
    rows: Array,
    lower: Array,
    innovations: Array,
    gains: Array,
    states: Array,
    spread: Array,
    smooth: Array,
    variance: Array,
    by_first: Array,
    by_added: Array,
    by_fading: Array,
    by_white: Array,
) -> None:
    """Go back through a filtered run; the last six arrays are written."""
    r, tell = np.zeros((FILTER_SIZE, states.shape[2])), np.zeros((FILTER_SIZE, FILTER_SIZE))
    for k in range(len(step) - 1, -1, -1):
        # Back over the step to the next point
        back = _pull_back(r, step[k], push[k], fading)
        ahead = _pull_back(tell, step[k], push[k], fading)
        whole = states[k, STATE_WIDTH:] + spread[k, STATE_WIDTH:] @ back
        for i in range(FADING):
            j = STATE_WIDTH + i
            by_added[i] += 0.5 * (np.sum(r[j] ** 2) - tell[j, j])
            by_fading[i] += np.sum(r[j] * whole[i]) - np.sum(ahead[:, j] * spread[k, :, j])
        r, tell = back, _pull_back(ahead.T.copy(), step[k], push[k], fading)
        smooth[k] = states[k, :, -1] + spread[k] @ back[:, -1].copy()
        for i in range(AXIS_COUNT):
            row = spread[k, STATE_WIDTH + i]
            variance[k, i] = row[STATE_WIDTH + i] - row @ tell @ row
        # Back over the readings of this point
        n = number[k]
        if n == 0:
            continue
        h, root, g = rows[k, :n], lower[k, :n, :n].copy(), gains[k, :n]
        u = innovations[k, :n] - g @ r
        _unwhiten_rows(root, u)
        inside = np.eye(n) + g @ tell @ g.T
        _unwhiten_rows(root, inside)
        d = inside.T.copy()
        _unwhiten_rows(root, d)
        for i in range(n):
            c = which[k, i]
            slope = 0.5 * (np.sum(u[i] ** 2) - d[i, i])
            by_white[c] += slope / count[k] if c < POSE_SIZE else slope
        r += h.T @ u
        # (1 - h' w) tell (1 - h' w)' + whiter' whiter
        w, whiter = g.copy(), h.copy()
        _unwhiten_rows(root, w)
        whiten_rows(root, whiter)
        tell -= h.T @ (w @ tell)
        tell += whiter.T @ whiter - (tell @ w.T) @ h
    for i in range(FADING):
        j = STATE_WIDTH + i
        by_first[i] += 0.5 * (np.sum(r[j] ** 2) - tell[j, j])
