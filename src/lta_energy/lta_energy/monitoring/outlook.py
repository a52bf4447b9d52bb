# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
How long the energy lasts: mean load, time to empty and full, reserve and way home.

The power drawn from the cell passes two first-order filters in series: the quick one follows the
present load, the slow one is the mean used for forecasts. If the quick one is an
Ornstein-Uhlenbeck process of correlation time T1 and variance v, its mean over T2 has the variance
v T1 / (T1 + T2).

A cell is empty where it can no longer deliver the mean power P above the cut-off voltage: at the
charge whose open-circuit voltage is :math:`V_c + R P / V_c`. With W(s) the energy between here and
there and p the power drawn from the chemistry, losses included, the time is :math:`T = W C / (C_0
p)`. Its variance is propagated to first order from charge, capacity (with their covariance) and p.
The time to full follows the same rule and neglects that a charger tapers its current at the end.

Power and speed of the flight home are averaged only while the drone moves, so that a drone resting
far from home still has a valid estimate. The speed over ground is the airspeed less an assumed
head wind.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_energy.monitoring.meters import TravelState
from lta_energy.monitoring.soc_ekf import CellState, CHARGE, INVERSE, RESISTANCE
from lta_model.electrical.battery import BatteryModel, state_of_charge, stored_energy


class LoadEstimate(NamedTuple):
    """Quick and slow mean [W], variance of the quick about the slow one [W2], age [s]."""

    quick: float = 0.0
    mean: float = 0.0
    variance: float = 0.0
    age: float = 0.0


def initial_load(power: float) -> LoadEstimate:
    """Return the load after one reading [W], with the power itself as its standard deviation."""
    return LoadEstimate(power, power, power * power)


def update_load(
    before: LoadEstimate, power: float, dt: float, quick: float, slow: float
) -> LoadEstimate:
    """
    Update the load with a new power.

    `power`: power drawn from the cell [W]. `dt`: time since the last update [s]. `quick`, `slow`:
    time constants; 0 disables the filter [s].
    """
    age = before.age + dt
    now = before.quick + _smoothing_weight(dt, quick, age) * (power - before.quick)
    share = _smoothing_weight(dt, slow, age)
    # Exponentially weighted variance of the quick mean about the slow one
    off = now - before.mean
    return LoadEstimate(
        now,
        before.mean + share * off,
        (1.0 - share) * (before.variance + share * off * off),
        age,
    )


def mean_load_deviation(load: LoadEstimate, quick: float, slow: float) -> float:
    """Return the standard deviation of the mean load [W]."""
    # T1 / (T1 + T2), with the age in place of T2 while the mean is young
    span = min(slow, load.age)
    share = quick / (quick + span) if quick + span > 0.0 else 1.0
    return math.sqrt(load.variance * share)


def _smoothing_weight(dt: float, time: float, age: float) -> float:
    """Return the weight of the newest value: exponential, or that of a plain mean while young."""
    # dt / age makes a plain mean of the first values, so that the first reading does not linger
    return max(-math.expm1(-dt / time), dt / age) if time > 0.0 and age > 0.0 else 1.0


class TimeEstimate(NamedTuple):
    """A time and its standard deviation [s]; infinite if it is never reached."""

    mean: float
    deviation: float


UNKNOWN_TIME = TimeEstimate(math.nan, math.nan)
NEVER_REACHED = TimeEstimate(math.inf, math.inf)


def empty_charge(cell: BatteryModel, state: CellState, power: float) -> float:
    """Return the charge at which a power [W] pulls the voltage down to the cut-off [1]."""
    resistance = state.mean[RESISTANCE] * (cell.resistance + cell.relaxation_resistance)
    return state_of_charge(
        cell.discharge_cutoff + resistance * max(power, 0.0) / cell.discharge_cutoff
    )


def energy_between(cell: BatteryModel, state: CellState, low: float, high: float) -> float:
    """Return the energy between two charges; negative where low is above high [J]."""
    capacity = cell.capacity / state.mean[INVERSE]
    return stored_energy(high, capacity) - stored_energy(low, capacity)


def estimate_discharge_time(
    cell: BatteryModel, state: CellState, power: float, deviation: float
) -> TimeEstimate:
    """Estimate the time to empty from the mean power and its standard deviation [W]."""
    if power <= 0.0:
        return NEVER_REACHED
    energy = energy_between(cell, state, empty_charge(cell, state, power), state.charge)
    return _energy_over_power(cell, state, max(energy, 0.0), power, deviation, 1.0)


def estimate_charging_time(
    cell: BatteryModel, state: CellState, power: float, deviation: float
) -> TimeEstimate:
    """Estimate the time to full; the power is negative while the cell is charged [W]."""
    if power >= 0.0:
        return NEVER_REACHED
    energy = energy_between(cell, state, state.charge, 1.0)
    return _energy_over_power(cell, state, energy, -power, deviation, -1.0)


def _energy_over_power(
    cell: BatteryModel,
    state: CellState,
    energy: float,
    power: float,
    deviation: float,
    sign: float,
) -> TimeEstimate:
    """Return how long an energy lasts, with its error; `sign` is -1 if charge shortens it."""
    p, inverse = state.spread, state.mean[INVERSE]
    time = energy / power
    # Partial derivatives of the time by charge, inverse capacity and power
    by_charge = sign * state.resting_voltage * cell.capacity / inverse / power
    by_inverse = -time / inverse
    by_power = -time / power
    # The charge is correlated with the capacity, but neither with the load
    variance = (
        by_charge * by_charge * p[CHARGE][CHARGE]
        + 2.0 * by_charge * by_inverse * p[CHARGE][INVERSE]
        + by_inverse * by_inverse * p[INVERSE][INVERSE]
        + by_power * by_power * deviation * deviation
    )
    return TimeEstimate(time, math.sqrt(max(variance, 0.0)))


class EnergyReserveSettings(Settings):
    """Energy reserve that the drone must keep."""

    reserve: float = setting(0.25, low=0.0, high=0.9)
    """State of charge (0 to 1) at which the energy reserve is reached."""
    hysteresis: float = setting(0.05, low=0.0, high=0.1)
    """Rise of the state of charge above the reserve at which the alarm clears."""
    caution: float = setting(1.0, low=0.0, high=5.0)
    """
    Safety margin subtracted from the state of charge, in standard deviations of its estimate.
    """
    doubt: float = setting(0.15, low=0.01, high=0.3)
    """Standard deviation above which the state of charge is reported as unreliable."""


class ReserveMargin(NamedTuple):
    """Charge compared with the reserve."""

    sure: float  # lower bound of the charge [1]
    home: float  # charge needed for the way home [1]
    spare: float  # energy beyond reserve and way home; negative if it is missing [J]


def compute_reserve_margin(
    settings: EnergyReserveSettings, cell: BatteryModel, state: CellState, home: float
) -> ReserveMargin:
    """Compare the charge with the reserve and the energy of the way home [J]."""
    sure = state.charge - settings.caution * state.deviation
    # Energy per unit of charge at the present voltage [J]
    full = state.resting_voltage * cell.capacity / state.mean[INVERSE]
    return ReserveMargin(
        sure, home / full, energy_between(cell, state, settings.reserve, max(sure, 0.0)) - home
    )


def is_reserve_reached(
    settings: EnergyReserveSettings, before: bool, stock: ReserveMargin
) -> bool:
    """Return whether the reserve is reached, with hysteresis."""
    # Once reached, the charge must rise by the hysteresis before the alarm clears
    return stock.sure <= settings.reserve + stock.home + (settings.hysteresis if before else 0.0)


class WayHomeSettings(Settings):
    """Assumptions about the way home that hold until measured or cannot be measured."""

    power: float = setting(1.4, 'W', 0.0, 1000.0)
    """Power assumed for the flight home until it has been measured."""
    speed: float = setting(0.5, 'm/s', 0.05, 30.0)
    """Airspeed assumed for the flight home until it has been measured."""
    moving: float = setting(0.1, 'm/s', 0.01, 10.0)
    """Airspeed above which power and speed count towards their means in flight."""
    head_wind: float = setting(0.1, 'm/s', 0.0, 10.0)
    """Head wind assumed for the flight home; it cannot be measured."""
    slowest: float = setting(0.05, 'm/s', 0.01, 10.0)
    """Lowest ground speed assumed for the flight home."""
    smoothing: float = setting(30.0, 's', 0.0, 3600.0)
    """Time constant of the mean power and airspeed in flight."""


class TravelEstimate(NamedTuple):
    """Mean power from the chemistry and mean airspeed while moving [W, m/s]."""

    power: float
    speed: float


def initial_travel(settings: WayHomeSettings) -> TravelEstimate:
    """Return the assumptions before the drone has moved."""
    return TravelEstimate(settings.power, settings.speed)


def update_travel(
    settings: WayHomeSettings,
    travel: TravelEstimate,
    where: TravelState | None,
    power: float,
    dt: float,
) -> TravelEstimate:
    """Update power [W] and speed of flight after a time step [s], if the drone moves."""
    if where is None or where.speed < settings.moving:
        return travel
    share = -math.expm1(-dt / settings.smoothing) if settings.smoothing > 0.0 else 1.0
    return TravelEstimate(
        travel.power + share * (max(power, 0.0) - travel.power),
        travel.speed + share * (where.speed - travel.speed),
    )


def energy_home(settings: WayHomeSettings, travel: TravelEstimate, distance: float) -> float:
    """Return the energy to fly a distance [m] [J]."""
    return travel.power * distance / _ground_speed(settings, travel)


def reachable_distance(settings: WayHomeSettings, travel: TravelEstimate, energy: float) -> float:
    """Return the distance that an energy [J] allows [m]."""
    if travel.power <= 0.0:
        return math.inf
    return max(energy, 0.0) / travel.power * _ground_speed(settings, travel)


def _ground_speed(settings: WayHomeSettings, travel: TravelEstimate) -> float:
    # The lower bound keeps the energy finite in a head wind as fast as the drone
    return max(travel.speed - settings.head_wind, settings.slowest)
