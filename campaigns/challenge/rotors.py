# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate the rotors: deadband, lag and thrust, exact between two commands."""

from collections.abc import Sequence
import math
from typing import Final, final

from campaigns.challenge.body import cross_product
from campaigns.challenge.truth import Six, VehicleTruth

WIDTH: Final = 0.02  # hysteresis of the deadband, relative: starts above it, stops below
SECOND: Final = 0.1  # share of the second stage in a hidden lag


def split_lag(truth: VehicleTruth) -> tuple[float, float]:
    """Return the time constants of both stages of the lag; 0 for none [s]."""
    # The mean delay of two stages is the sum of their time constants
    whole = truth.lag + truth.slow_lag
    late = SECOND * whole if truth.slow_lag else 0.0
    return whole - late, late


def approximate_lag(truth: VehicleTruth) -> tuple[float, float]:
    """
    Return the lag and the additional delay of one stage that act as both stages [s].

    Their impulse response has the same mean and variance: two stages a and b have a + b and
    a^2 + b^2, and a stage c after a delay d has c + d and c^2.
    """
    stages = split_lag(truth)
    lag = math.hypot(*stages)
    return lag, sum(stages) - lag


@final
class RotorSet:
    """
    All rotors of a vehicle.

    `truth`: true parameters. `duties`: steady duties before the start.
    """

    def __init__(self, truth: VehicleTruth, duties: Sequence[float]) -> None:
        self._truth = truth
        self._early, self._late = split_lag(truth)
        self._turning = [False] * len(truth.gains)
        self._aim = [0.0] * len(truth.gains)
        self.set_duties(duties)
        self._first, self._second = list(self._aim), list(self._aim)

    def set_duties(self, duties: Sequence[float]) -> None:
        """Set the duties from now on."""
        low = self._truth.deadband
        for k, duty in enumerate(duties):
            edge = low * (1.0 - WIDTH if self._turning[k] else 1.0 + WIDTH)
            self._turning[k] = duty >= edge
            self._aim[k] = duty if self._turning[k] else 0.0

    def _lag_stages(self, seconds: float) -> tuple[list[float], list[float]]:
        """Return both stages at a time after the command [s]."""
        early, late = self._early, self._late
        # Closed solution of the first-order lag for a constant command
        fast = math.exp(-seconds / early)
        first = [aim + (u - aim) * fast for aim, u in zip(self._aim, self._first, strict=True)]
        if not late:
            return first, first
        # Two lags in series; the time constants differ, so the partial fractions exist
        slow, ratio = math.exp(-seconds / late), early / (early - late)
        second = [
            aim + (u - aim) * ratio * fast + (v - aim - (u - aim) * ratio) * slow
            for aim, u, v in zip(self._aim, self._first, self._second, strict=True)
        ]
        return first, second

    def advance(self, seconds: float) -> None:
        """Advance the rotors by a time [s]."""
        self._first, self._second = self._lag_stages(seconds)

    def thrusts_after_command(self, seconds: float) -> list[float]:
        """Return the thrust of each rotor [N] at a time after the command [s]."""
        a, b = self._truth.curve
        scale = self._truth.thrust
        return [
            scale * gain * (a * u + b) * u
            for gain, u in zip(self._truth.gains, self._lag_stages(seconds)[1], strict=True)
        ]

    def total_wrench(self, thrusts: Sequence[float]) -> Six:
        """Return force and moment of the thrusts about the hull centre."""
        sums = [0.0] * 6
        for thrust, column in zip(thrusts, self._truth.columns, strict=True):
            for k in range(6):
                sums[k] += thrust * column[k]
        return sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]


def rotate_column(
    column: Six, place: tuple[float, float, float], turn: tuple[float, float, float]
) -> Six:
    """Return the column of a rotor rotated about its own position by small angles [rad]."""
    force, moment = column[:3], column[3:]
    more = cross_product(turn, force)
    # Moment of the changed force at the rotor; the torque of the rotor itself is kept
    lever = cross_product(place, more)
    x, y, z = (force[k] + more[k] for k in range(3))
    l, m, n = (moment[k] + lever[k] for k in range(3))  # noqa: E741
    return x, y, z, l, m, n
