# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A small random linear flight, and its joint normal distribution as one dense matrix."""

from dataclasses import dataclass, replace
import math
from types import SimpleNamespace
from typing import Any

from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.state_filter.kalman import PRESSURE_CHANNEL, START, WEATHER, WEATHER_TIME
from lta_discovery.state_filter.linear_flight import LinearFlight
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

COUNT, PARAMETERS = 14, 3  # grid points, parameters
RUN = (1, 13)  # first and end of the part that is filtered
BODY, WHOLE = 12, 25  # components of a change of state, and of the whole state

NOISE = NoiseModel(
    white=np.array([2e-3] * 3 + [3e-3] * 3),
    correlated=np.array([1e-3] * 3 + [4e-3] * 3),
    correlation=0.1,
    wrench=np.array([0.5, 0.4, 0.3, 0.2, 0.3, 0.4]),
    memory=np.array([0.2] * 3 + [0.5] * 3),
)
ALL_SENSORS = replace(NOISE, white=np.concatenate([NOISE.white, np.full(8, 0.2)]))


def build_flight(seed: int, channels: int = 6) -> LinearFlight:
    """Return a random flight: some grid points without a pose, some with four."""
    rng = np.random.default_rng(seed)

    def draw(*shape: int) -> Array:
        return rng.standard_normal(shape)

    count = np.ones(COUNT)
    count[[4, 9]] = 0.0
    count[[2, 6, 7]] = 4.0
    left = 0.1 * draw(COUNT, channels)
    left[count == 0.0, :6] = np.nan
    # A reading may lack a channel
    left[6, 5] = np.nan
    motion: Any = None
    return LinearFlight(
        motion,
        0.9 * np.eye(BODY) + 0.1 * draw(COUNT, BODY, BODY),
        0.05 * draw(COUNT, BODY, 6),
        0.02 * draw(COUNT, BODY, PARAMETERS),
        0.02 * draw(COUNT, BODY),
        left,
        0.5 * draw(COUNT, channels, BODY),
        0.1 * draw(COUNT, channels, 6),
        0.05 * draw(COUNT, channels, PARAMETERS),
        count,
        [RUN],
        0.05 * draw(1, BODY, PARAMETERS),
        SimpleNamespace(mass=0.1),  # type: ignore[arg-type] - enough for the noise
    )


@dataclass
class DenseFlight:
    """All states of a run and its readings as linear functions of independent normal numbers."""

    # Whole states, by grid point of the run: constant, slopes by the parameters, and covariance
    # with all others
    states: Array  # shape (k, 25)
    slopes: Array  # shape (k, 25, K)
    spread: Array  # shape (k, 25, k, 25)
    # Known readings
    places: list[tuple[int, int]]  # grid point of the run and channel
    values: Array  # measured less the constant part, shape (N,)
    design: Array  # shape (N, K)
    covariance: Array  # shape (N, N)
    across: Array  # of whole states with readings, shape (k, 25, N)

    def select(self, end: int) -> NDArray[np.bool_]:
        """Return which readings are of the grid points before one."""
        return np.array([k < end for k, _ in self.places])

    def condition(self, at: int, end: int, parameters: Array) -> Array:
        """Return the mean of the whole state at a grid point, given readings before another."""
        some = self.select(end)
        left = (self.values - self.design @ parameters)[some]
        gain = self.across[at][:, some] @ np.linalg.inv(self.covariance[np.ix_(some, some)])
        mean: Array = self.states[at] + self.slopes[at] @ parameters + gain @ left
        return mean


def build_dense(flight: LinearFlight, noise: NoiseModel) -> DenseFlight:
    """Build the joint distribution, one grid point after the other, from its definition."""
    begin, end = flight.runs[0]
    count, width = end - begin, flight.moved.shape[2]
    memory = np.concatenate([noise.memory, np.full(6, noise.correlation), [WEATHER_TIME]])
    usual = np.concatenate([noise.wrench, noise.correlated, [WEATHER]])
    kept = np.exp(-GRID_PERIOD / memory)
    # State of each grid point by independent numbers of unit variance, 25 each
    states, slopes = np.zeros((count, WHOLE)), np.zeros((count, WHOLE, width))
    slopes[0, :BODY] = flight.begun[0]
    roots = np.zeros((count, WHOLE, count * WHOLE))
    roots[0, :, :WHOLE] = np.diag(np.concatenate([START, usual]))
    for k in range(count - 1):
        transition = np.zeros((WHOLE, WHOLE))
        transition[:BODY, :BODY] = flight.step[begin + k]
        transition[:BODY, BODY:18] = flight.push[begin + k]
        transition[BODY:, BODY:] = np.diag(kept)
        states[k + 1] = transition @ states[k]
        states[k + 1, :BODY] += flight.defect[begin + k]
        slopes[k + 1] = transition @ slopes[k]
        slopes[k + 1, :BODY] += flight.moved[begin + k]
        roots[k + 1] = transition @ roots[k]
        fresh = np.arange(BODY, WHOLE)
        # Each keeps its usual variance
        roots[k + 1, fresh, (k + 1) * WHOLE + fresh] += usual * np.sqrt(1.0 - kept**2)
    spread = np.einsum('isn,jtn->isjt', roots, roots)
    places, values, design, rows, own = [], [], [], [], []
    for k in range(count):
        for c in range(flight.left.shape[1]):
            value = flight.left[begin + k, c]
            if math.isnan(value):
                continue
            row = np.zeros(WHOLE)
            row[:BODY] = flight.read[begin + k, c]
            row[BODY:18] = flight.felt[begin + k, c]
            if c < 6:
                row[18 + c] = 1.0
            elif c == PRESSURE_CHANNEL:
                row[-1] = 1.0
            places.append((k, c))
            values.append(value - row @ states[k])
            design.append(flight.read_moved[begin + k, c] + row @ slopes[k])
            rows.append(row)
            own.append(noise.white[c] ** 2 / (flight.count[begin + k] if c < 6 else 1.0))
    at = [k for k, _ in places]
    both = np.array([row @ roots[k] for row, k in zip(rows, at, strict=True)])
    return DenseFlight(
        states, slopes, spread, places, np.array(values), np.array(design),
        both @ both.T + np.diag(own), np.einsum('isn,mn->ism', roots, both),
    )  # fmt: skip
