# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate the air in the room: unsteady wind, draughts and other disturbances."""

from collections.abc import Sequence
import math
from typing import Final, final, Protocol

import numpy as np

from campaigns.challenge.truth import Six, VehicleTruth

UNSTEADY: Final = 0.02  # rms variation of the wind, relative to its mean
GRID: Final = 0.1  # s; sample interval of the draught
MEMORY: Final = 2.5  # s; time constant of each of its two filters


class MovingAir(Protocol):
    """A source of air motion."""

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Return velocity [m/s] and acceleration [m/s2] of the air at a position of the map."""
        ...


@final
class RoomAirMotion:
    """
    Slow random horizontal air motion, the same in the whole room.

    White noise through two equal first-order filters, so that its acceleration is finite.

    `size`: root mean square of each component [m/s]. `seconds`: length of the flight [s].
    """

    def __init__(self, size: float, seconds: float, draw: np.random.Generator) -> None:
        # Samples until the filters have forgotten their start
        settled = int(10.0 * MEMORY / GRID)
        count = settled + int(seconds / GRID) + 3
        keep = math.exp(-GRID / MEMORY)
        series = draw.standard_normal((count, 2))
        for _ in range(2):
            for k in range(1, count):
                series[k] = keep * series[k - 1] + (1.0 - keep) * series[k]
        # Variance of white noise after both filters: the sum of the squared kernel
        powers = np.arange(count, dtype=float)
        # Impulse response of two equal first-order filters in series
        kernel = (1.0 - keep) ** 2 * (powers + 1.0) * keep**powers
        series *= size / math.sqrt(float(np.sum(kernel**2)))
        self._series: list[list[float]] = series[settled:].tolist()

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Interpolate the series linearly."""
        index = min(int(time / GRID), len(self._series) - 2)
        one, two = self._series[index], self._series[index + 1]
        share = time / GRID - index
        gain = [(after - before) / GRID for before, after in zip(one, two, strict=True)]
        u, v = (before + share * GRID * g for before, g in zip(one, gain, strict=True))
        return u, v, 0.0, gain[0], gain[1], 0.0


@final
class UnsteadyWind:
    """
    Uniform wind with small fluctuations.

    It has no boundary layer, since wind that grows with height is another effect of the library.

    `truth`: contains the mean wind. `seconds`: length of the flight [s].
    """

    def __init__(self, truth: VehicleTruth, seconds: float, draw: np.random.Generator) -> None:
        self._wind = truth.wind
        self._more = RoomAirMotion(UNSTEADY, seconds, draw)

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Return velocity and acceleration of the air."""
        share, _, _, gain, _, _ = self._more.sample_flow(time, x, y, z)
        u, v, w = self._wind
        share += 1.0
        return share * u, share * v, share * w, gain * u, gain * v, gain * w


@final
class RoomAir:
    """The sum of all sources of air motion."""

    def __init__(self, movers: Sequence[MovingAir]) -> None:
        self._movers = movers

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Return velocity and acceleration of the air at a place of the map."""
        u = v = w = a = b = c = 0.0
        for one in self._movers:
            more = one.sample_flow(time, x, y, z)
            u, v, w = u + more[0], v + more[1], w + more[2]
            a, b, c = a + more[3], b + more[4], c + more[5]
        return u, v, w, a, b, c
