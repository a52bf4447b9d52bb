# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Two forecasts of a blimp as one writes them in an evening, to compare calibrated models with.

Both begin on a straight line through the poses of the past half second, know the commands that
come, and learn from training flights: `Physics`, four independent axes, and `Ridge`, a regression.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_data.even_grid import find_runs
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight
from lta_discovery.state_filter.forecast_noise import list_starts
from lta_discovery.state_filter.forecasts import COASTING_PERIODS, LEAST_COASTING
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MIDDLE: Final = COASTING_PERIODS // 2  # grid periods; from the middle of the line to the start
STEERED: Final = [0, 1, 2, 5]  # surge, sway, heave and yaw of a commanded wrench
LEARNED: Final = (1.0, 3.0)  # s; horizons to which the physics is fitted
APART: Final = 1.5  # s; between the forecasts that teach the physics
OFTEN: Final = 0.5  # s; between those that teach the regression
DELAYS: Final = (0.0, 0.1, 0.2, 0.3, 0.4)  # s; of the commands, of which the best is taken
YAW: Final = 0.1  # m/rad; weight of an error of the heading
USUAL: Final = 0.03  # m/s; error by horizon beyond which one counts linearly
FIRST_DRAG: Final = 0.2  # 1/s
MOST_DRAG: Final = 5.0  # 1/s
PUSH: Final = 0.02  # m/s2; usual acceleration by a command
NEEDED: Final = 2.0  # ended forecasts that count as much as the bias of the training flights
HELD: Final = 12  # samples of the commands in one interval
LONG: Final = 3.0  # s; further ahead, a forecast has six intervals of commands, else two a second
WEIGHTS: Final = 10.0 ** np.arange(-1.0, 5.1, 0.5)  # of the penalty, of which the best is taken
FURTHEST: Final = 4.0  # standard deviations; no feature counts as further from the training
FOLDS: Final = 5  # of a single training flight


def turn(vectors: Array, angles: Array) -> Array:
    """Return vectors, shape (N, 3), turned about the vertical."""
    c, s = np.cos(angles), np.sin(angles)
    x, y, z = vectors.T
    return np.column_stack([c * x - s * y, s * x + c * y, z])


@final
class Flown:
    """A measured flight as position and angles by grid point, with what it was told."""

    def __init__(self, flight: MeasuredFlight) -> None:
        self.flight = flight
        known = np.isfinite(np.hstack([flight.position, flight.quaternion])).all(axis=1)
        # Position, roll, pitch, yaw; NaN where nothing was measured. [m, rad]
        self.pose = np.full((len(flight.time), 6), np.nan)
        angles = Rotation.from_quat(flight.quaternion[known]).as_euler('ZYX')[:, ::-1]
        self.pose[known] = np.column_stack([flight.position[known], np.unwrap(angles, axis=0)])

    def told(self, time: Array) -> Array:
        """Return the commands at some times: wrench, or duties and place of the moved mass."""
        flight = self.flight
        if flight.wrench is not None:
            streams = [(flight.wrench.time, flight.wrench.values[:, STEERED])]
        else:
            streams = [(one.time, one.values) for one in (flight.commands, flight.mass) if one]
        rows = [np.searchsorted(each, time + 1e-9, side='right') - 1 for each, _ in streams]
        return np.concatenate(
            [values[np.maximum(k, 0)] for (_, values), k in zip(streams, rows, strict=True)], -1
        )

    def list_starts(self, every: float) -> Indices:
        """Return the grid points of forecasts that teach."""
        return list_starts(find_runs(self.flight.usable).tolist(), every)


@final
class Starts:
    """Where N forecasts of some flights begin; those without enough poses are left out."""

    def __init__(self, flights: Sequence[Flown], starts: Sequence[Indices]) -> None:
        self.flights = flights
        found = [
            (f, start, *line)
            for f, flight in enumerate(flights)
            for start in starts[f]
            if (line := fit_line(flight, int(start))) is not None
        ]
        self.of = np.array([one[0] for one in found], dtype=np.int64)
        self.at = np.array([one[1] for one in found], dtype=np.int64)
        self.pose = np.array([one[2] for one in found]).reshape(-1, 6)
        self.rate = np.array([one[3] for one in found]).reshape(-1, 6)
        self.time = np.array([flights[one[0]].flight.time[one[1]] for one in found])
        self.yaw = self.pose[:, 5]

    def truth(self, horizon: float) -> Array:
        """Return position and heading after a time, shape (N, 4); NaN where not measured."""
        out, ahead = np.full((len(self.at), 4), np.nan), round(horizon / GRID_PERIOD)
        for n, (f, k) in enumerate(zip(self.of, self.at + ahead, strict=True)):
            if k < len(self.flights[f].pose):
                out[n] = self.flights[f].pose[k, [0, 1, 2, 5]]
        return out

    def told(self, after: Array) -> Array:
        """Return the commands at some times after each start, shape (N, len(after), M)."""
        return np.array([
            self.flights[f].told(time + after) for f, time in zip(self.of, self.time, strict=True)
        ])  # fmt: skip

    def extend_lines(self, horizon: float) -> Array:
        """Return positions at constant velocity, shape (N, 3)."""
        straight: Array = self.pose[:, :3] + horizon * self.rate[:, :3]
        return straight


def fit_line(flight: Flown, start: int) -> tuple[Array, Array] | None:
    """Return pose and rates at a start from the half second before; None with too few poses."""
    rows = np.arange(max(start - COASTING_PERIODS, 0), start + 1)
    table, late = flight.pose[rows], flight.flight.time[rows] - flight.flight.time[start]
    known = np.isfinite(table).all(axis=1)
    if known.sum() < LEAST_COASTING:
        return None
    slope, place = np.polyfit(late[known], table[known], 1)
    return place, slope


@final
@dataclass(frozen=True, slots=True)
class Physics:
    """
    Surge, sway, heave and yaw, each with gain, linear drag and bias, and one delay of all.

    The velocity turns with the nose. A commanded wrench acts on its own axes, duties on all. What
    the forecasts of a flight that have ended were off tells its bias in surge, sway and heave.
    """

    drag: Array  # shape (4,) [1/s]
    bias: Array  # shape (4,) [m/s2, rad/s2]
    gain: Array  # acceleration by command, shape (4, M)
    delay: float  # [s]

    @classmethod
    def fit(cls, flights: Sequence[Flown]) -> 'Physics':
        """Fit training flights."""
        starts = Starts(flights, [one.list_starts(APART) for one in flights])
        truth = {horizon: starts.truth(horizon) for horizon in LEARNED}
        told = np.concatenate([one.told(one.flight.time) for one in flights])
        size = np.sqrt(np.mean(told**2, axis=0))
        own = flights[0].flight.wrench is not None
        acts = np.eye(4, dtype=np.bool_) if own else np.ones((4, len(size)), dtype=np.bool_)
        acts = acts & (told.std(axis=0) > 1e-9 * size)
        usual = PUSH / np.broadcast_to(np.maximum(size, 1e-12), acts.shape)[acts]

        def build(x: Array, delay: float) -> 'Physics':
            gain = np.zeros(acts.shape)
            gain[acts] = x[8:]
            return cls(x[:4], x[4:8], gain, delay)

        def off(x: Array, delay: float) -> Array:
            with np.errstate(all='ignore'):
                flown = build(x, delay).fly(starts, LEARNED)
            # Nothing measured counts nothing; what diverges counts much
            parts = [(flown[h] - truth[h]) * (1.0, 1.0, 1.0, YAW) / h for h in LEARNED]
            lost = [~np.isfinite(flown[h]) for h in LEARNED]
            return np.concatenate([
                np.where(bad, 1e3, np.nan_to_num(np.clip(part, -1e3, 1e3))).ravel()
                for part, bad in zip(parts, lost, strict=True)
            ])  # fmt: skip

        count = len(usual)
        first = np.concatenate([np.full(4, FIRST_DRAG), np.zeros(4 + count)])
        low = np.concatenate([np.zeros(4), np.full(4 + count, -np.inf)])
        high = np.concatenate([np.full(4, MOST_DRAG), np.full(4 + count, np.inf)])
        scale = np.concatenate([np.ones(4), np.full(4, PUSH), usual])
        fits = [
            (least_squares(
                off, first, bounds=(low, high), x_scale=scale, loss='soft_l1', f_scale=USUAL,
                max_nfev=60, args=(delay,),
            ), delay)
            for delay in DELAYS
        ]  # fmt: skip
        best, delay = min(fits, key=lambda one: float(one[0].cost))
        return build(best.x, delay)

    def fly(
        self, starts: Starts, horizons: Sequence[float], more: Array | float = 0.0
    ) -> dict[float, Array]:
        """Return position and heading at horizons, shape (N, 4); `more`: bias of each forecast."""
        # The slope of a line is the velocity in its middle
        count = MIDDLE + round(max(horizons) / GRID_PERIOD)
        pushed = starts.told(GRID_PERIOD * (np.arange(count) - MIDDLE) - self.delay) @ self.gain.T
        begun = starts.pose - MIDDLE * GRID_PERIOD * starts.rate
        place, yaw = begun[:, :3].copy(), begun[:, 5]
        speed = np.column_stack([turn(starts.rate[:, :3], -yaw), starts.rate[:, 5]])
        ends = {MIDDLE + round(horizon / GRID_PERIOD): horizon for horizon in horizons}
        out = {}
        for k in range(count):
            place += GRID_PERIOD * turn(speed[:, :3], yaw)
            yaw = yaw + GRID_PERIOD * speed[:, 3]
            speed = speed + GRID_PERIOD * (self.bias + more - self.drag * speed + pushed[:, k])
            if k + 1 in ends:
                out[ends[k + 1]] = np.column_stack([place, yaw])
        return out

    def forecast(self, starts: Starts, horizons: Sequence[float]) -> dict[float, Array]:
        """Return positions at horizons, shape (N, 3), with the bias that ended forecasts tell."""
        short = LEARNED[-1]
        error = (starts.truth(short) - self.fly(starts, (short,))[short])[:, :3]
        error = turn(error, -starts.yaw)
        # Way by a constant acceleration against the drag
        drag = np.maximum(self.drag[:3], 1e-3)
        reach = short / drag - (1.0 - np.exp(-drag * short)) / drag**2
        more = np.zeros((len(error), 4))
        for n, (f, now) in enumerate(zip(starts.of, starts.time, strict=True)):
            ended = (starts.of == f) & (starts.time + short <= now + 1e-9)
            ended &= np.isfinite(error).all(axis=1)
            more[n, :3] = error[ended].sum(axis=0) / reach / (ended.sum() + NEEDED)
        flown = self.fly(starts, horizons, more)
        return {horizon: place[:, :3] for horizon, place in flown.items()}


@final
@dataclass(frozen=True, slots=True)
class Ridge:
    """Deviation from a straight line at one horizon, by ridge regression, in heading axes."""

    horizon: float
    mean: Array
    spread: Array
    weights: Array  # of a constant and of each feature, shape (1 + F, 3)

    @classmethod
    def fit(cls, flights: Sequence[Flown], horizon: float) -> 'Ridge':
        """Fit training flights; the penalty is that which predicts flights left out best."""
        starts = Starts(flights, [one.list_starts(OFTEN) for one in flights])
        wanted = turn(starts.truth(horizon)[:, :3] - starts.extend_lines(horizon), -starts.yaw)
        known = np.isfinite(wanted).all(axis=1)
        features, wanted = list_features(starts, horizon)[known], wanted[known]
        mean, spread = features.mean(axis=0), features.std(axis=0)
        spread = np.where(spread > 1e-9, spread, 1.0)
        table = np.column_stack([np.ones(len(features)), (features - mean) / spread])
        fold = starts.of[known]
        if len(flights) == 1:
            fold = FOLDS * np.arange(len(wanted)) // len(wanted)
        penalty = np.diag(np.concatenate([[1e-6], np.ones(len(mean))]))

        def solve(rows: NDArray[np.bool_], weight: float) -> Array:
            part = table[rows]
            found: Array = np.linalg.solve(part.T @ part + weight * penalty, part.T @ wanted[rows])
            return found

        def left(weight: float) -> float:
            return sum(
                float(np.sum((table[out] @ solve(~out, weight) - wanted[out]) ** 2))
                for out in (fold == k for k in np.unique(fold))
            )

        weight = min(WEIGHTS.tolist(), key=left)
        return cls(horizon, mean, spread, solve(np.full(len(table), True), weight))

    def forecast(self, starts: Starts) -> Array:
        """Return positions at the horizon, shape (N, 3)."""
        features = (list_features(starts, self.horizon) - self.mean) / self.spread
        table = np.clip(features, -FURTHEST, FURTHEST)
        away = np.column_stack([np.ones(len(table)), table]) @ self.weights
        return starts.extend_lines(self.horizon) + turn(away, starts.yaw)


def list_features(starts: Starts, horizon: float) -> Array:
    """Return velocity and rates, tilt, and the commands of the past and to come, shape (N, F)."""
    parts = 6 if horizon > LONG else max(2, round(2.0 * horizon))
    ahead = starts.told(horizon * (np.arange(parts * HELD) + 0.5) / (parts * HELD))
    ahead = ahead.reshape(len(ahead), parts, HELD, -1).mean(axis=2)
    past = starts.told(-GRID_PERIOD * np.arange(COASTING_PERIODS + 1)).mean(axis=1)
    return np.column_stack([
        turn(starts.rate[:, :3], -starts.yaw),
        starts.rate[:, 3:],
        np.sin(starts.pose[:, 3:5]),
        ahead.reshape(len(ahead), -1),
        past,
    ])  # fmt: skip
