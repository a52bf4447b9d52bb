# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
Estimate the state of charge from voltage and current with an extended Kalman filter.

The state is the charge s, the relaxation voltage u, two factors relative to the vehicle file (on
the resistance and on the inverse capacity), and the error e of the open-circuit voltage chart.
With the current I, positive while charging,

.. math::

    \dot s = f_C I / C, \qquad \tau \dot u = f_R R_1 I - u, \qquad
    V = E(s) + e + u + f_R R_0 I .

Plett, "Extended Kalman filtering for battery management systems", parts 2 and 3, J. Power Sources
134 (2004): states and parameters in one filter. The chart error depends on the charge and does not
average out over readings, so it is modelled as a Gauss-Markov process over the charge instead of
noise. The chart has kinks; its slope is taken over a chord as wide as the uncertainty of the
charge.

All arithmetic is on plain scalars in a fixed order, without BLAS, so that results are bitwise the
same in every process.
"""

from dataclasses import dataclass
from functools import cached_property
import math
from typing import final, NamedTuple

from lta_config.settings import setting, Settings
from lta_model.electrical.battery import BatteryModel, open_circuit_voltage, state_of_charge

CHARGE, RELAXATION, RESISTANCE, INVERSE, CHART = range(5)
EKF_STATES = 5
UNKNOWN_CHARGE = 1.0 / math.sqrt(12.0)  # standard deviation of a charge anywhere between 0 and 1
CHART_CORRELATION = 0.2  # correlation length of the chart error over the charge: 4 of its 20 steps
NARROWEST_CHORD, WIDEST_CHORD = 0.01, 0.2  # bounds of the half width of the chord [charge]
CHARGE_DRIFT = 1e-5  # growth of the charge's deviation due to the meter's offset [1/sqrt(s)]
Row = tuple[float, float, float, float, float]


class SocFilterSettings(Settings):
    """Spread of cells about their vehicle file, as standard deviations."""

    capacity_spread: float = setting(0.05, low=0.0, high=0.5)
    """Assumed relative standard deviation of the battery capacity."""
    resistance_spread: float = setting(0.3, low=0.0, high=1.0)
    """Assumed relative standard deviation of the battery resistances, from temperature and age."""
    chart_error: float = setting(0.010, 'V', 1e-4, 0.2)
    """
    Assumed standard deviation of the open-circuit voltage, from the discharge curve and the meter.
    """
    voltage_noise: float = setting(0.010, 'V', 1e-4, 0.2)
    """Standard deviation of one reading of the battery voltage."""
    recent_current: float = setting(0.2, 'A', 0.0, 50.0)
    """Battery current assumed before the monitor started."""


@final
@dataclass(frozen=True)
class CellState:
    """Mean and covariance of the filter state."""

    mean: Row
    spread: tuple[Row, ...]

    @cached_property
    def charge(self) -> float:
        """State of charge [1]."""
        return self.mean[CHARGE]

    @cached_property
    def deviation(self) -> float:
        """Return the standard deviation of the state of charge [1]."""
        return math.sqrt(max(self.spread[CHARGE][CHARGE], 0.0))

    @cached_property
    def resting_voltage(self) -> float:
        """Open-circuit voltage at the state of charge [V]."""
        return open_circuit_voltage(self.charge)


class VoltageInnovation(NamedTuple):
    """Measured minus predicted voltage, and its expected standard deviation [V]."""

    innovation: float
    deviation: float


def initial_state(settings: SocFilterSettings, cell: BatteryModel) -> CellState:
    """Return the state before any reading, with the charge uniform between 0 and 1."""
    deviations = (
        UNKNOWN_CHARGE,
        cell.relaxation_resistance * settings.recent_current,
        settings.resistance_spread,
        settings.capacity_spread,
        settings.chart_error,
    )
    rows = [
        tuple(deviations[i] ** 2 if i == j else 0.0 for j in range(EKF_STATES))
        for i in range(EKF_STATES)
    ]
    return CellState((0.5, 0.0, 1.0, 1.0, 0.0), tuple(rows))  # type: ignore[arg-type]


def predict_state(
    settings: SocFilterSettings,
    cell: BatteryModel,
    state: CellState,
    current: float,
    deviation: float,
    dt: float,
) -> CellState:
    """Predict the state after a time step [s] at a mean current and its standard deviation [A]."""
    s, u, resistance, inverse, chart = state.mean
    step = current * dt / cell.capacity
    # Exact solution of the RC pair for a constant current
    decay = math.exp(-dt / cell.relaxation_time) if cell.relaxation_time > 0.0 else 0.0
    pull = (1.0 - decay) * cell.relaxation_resistance * current
    # The chart error decorrelates with the charge moved, not with time
    moved = abs(step) / CHART_CORRELATION
    faded = math.exp(-moved)
    mean = (
        min(max(s + inverse * step, 0.0), 1.0),
        decay * u + pull * resistance,
        resistance,
        inverse,
        faded * chart,
    )
    # F P F^T; F is the identity except in the rows of charge, relaxation and chart
    rows = list(map(list, state.spread))
    for row in rows:  # P F^T
        row[CHARGE] += step * row[INVERSE]
        row[RELAXATION] = decay * row[RELAXATION] + pull * row[RESISTANCE]
        row[CHART] *= faded
    for k in range(EKF_STATES):  # F (P F^T)
        rows[CHARGE][k] += step * rows[INVERSE][k]
        rows[RELAXATION][k] = decay * rows[RELAXATION][k] + pull * rows[RESISTANCE][k]
        rows[CHART][k] *= faded
    # Process noise: of the current, through charge and relaxation, and of the chart
    unsure = deviation * dt / cell.capacity
    blurred = (1.0 - decay) * cell.relaxation_resistance * deviation
    noise = (
        unsure * unsure + CHARGE_DRIFT * CHARGE_DRIFT * dt,
        blurred * blurred,
        0.0,
        0.0,
        settings.chart_error**2 * -math.expm1(-2.0 * moved),
    )
    for place, added in enumerate(noise):
        rows[place][place] += added
    return CellState(mean, tuple(map(tuple, rows)))  # type: ignore[arg-type]


def correct_state(
    settings: SocFilterSettings,
    cell: BatteryModel,
    state: CellState,
    voltage: float,
    current: float,
    at: float | None = None,
) -> tuple[CellState, VoltageInnovation]:
    """
    Correct the state with a measured terminal voltage [V] and current [A].

    This is one scalar Kalman update, linearised at a charge, by default that of the state.
    """
    mean, p = state.mean, state.spread
    at = mean[CHARGE] if at is None else at
    # Linearised at a measured charge, the uncertainty of the prior says nothing about the chord
    half = (
        min(max(state.deviation, NARROWEST_CHORD), WIDEST_CHORD)
        if at == mean[CHARGE]
        else NARROWEST_CHORD
    )
    slope = chord_slope(at, half)
    drop = cell.resistance * current
    expected = (
        open_circuit_voltage(at)
        + slope * (mean[CHARGE] - at)
        + mean[CHART]
        + mean[RELAXATION]
        + mean[RESISTANCE] * drop
    )
    # P H^T with H = (slope, 1, drop, 0, 1)
    column = [
        slope * row[CHARGE] + row[RELAXATION] + drop * row[RESISTANCE] + row[CHART] for row in p
    ]
    variance = (
        slope * column[CHARGE]
        + column[RELAXATION]
        + drop * column[RESISTANCE]
        + column[CHART]
        + settings.voltage_noise**2
    )
    innovation = voltage - expected
    after, rows = list(mean), list(map(list, p))
    for i in range(EKF_STATES):
        gain = column[i] / variance
        after[i] += gain * innovation
        for j in range(EKF_STATES):
            rows[i][j] -= gain * column[j]
    # The chart ends at 0 and 1; the covariance is not changed by the clamp
    after[CHARGE] = min(max(after[CHARGE], 0.0), 1.0)
    corrected = CellState(tuple(after), tuple(map(tuple, rows)))  # type: ignore[arg-type]
    return corrected, VoltageInnovation(innovation, math.sqrt(variance))


def initialize_from_reading(
    settings: SocFilterSettings, cell: BatteryModel, voltage: float, current: float
) -> CellState:
    """Return the state after a first reading [V, A], linearised at the charge of that voltage."""
    pointed = state_of_charge(voltage - cell.resistance * current)
    start = initial_state(settings, cell)
    return correct_state(settings, cell, start, voltage, current, pointed)[0]


def chord_slope(charge: float, half: float) -> float:
    """Return the mean slope of the open-circuit voltage within `half` of a charge [V]."""
    low, high = max(charge - half, 0.0), min(charge + half, 1.0)
    return (open_circuit_voltage(high) - open_circuit_voltage(low)) / (high - low)
