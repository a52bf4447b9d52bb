"""
Estimate the drone's energy from its meters: charge, balance, times, reserve and faults.

For each reading: predict the voltage, run the fault detectors, correct the filter (or only predict
it if the reading is unusable), then update energy balance, load, way home and reserve. The true
state is never used.
"""

from lta_config.settings import setting
from lta_energy.faults.detector import MeterObservation
from lta_energy.faults.fault_monitor import SWAPPED, update_detectors
from lta_energy.faults.gap import LONGEST
from lta_energy.monitoring import endurance, load, reserve, way_home
from lta_energy.monitoring.clock_shift import append_stamp, ENOUGH, shift_stamps
from lta_energy.monitoring.endurance import TimeEstimate
from lta_energy.monitoring.energy_balance import add_interval, EnergyBalance
from lta_energy.monitoring.estimate import EnergyEstimate
from lta_energy.monitoring.latch import Latch, update_latch
from lta_energy.monitoring.power_system import PowerSystem
from lta_energy.monitoring.reading import MeterReading
from lta_energy.monitoring.reserve import EnergyReserveSettings
from lta_energy.monitoring.soc_ekf import (
    CellState,
    correct_state,
    initialize_from_reading,
    predict_state,
    RELAXATION,
    RESISTANCE,
    SocFilterSettings,
    VoltageInnovation,
)
from lta_energy.monitoring.way_home import WayHomeSettings
from lta_model.electrical.battery import BatteryModel, open_circuit_voltage

CRITICAL_VOLTAGE = 3.2  # V under load; Bitcraze's low-battery limit
RECOVERED_VOLTAGE = 3.3  # V
CRITICAL_RISE, CRITICAL_FALL = 0.3, 5.0  # s
BETWEEN = 0.3  # standard deviation of the mean current, relative to its change (uniform)
EMPTY = 0.02  # state of charge at either end where cells deviate from the chart
QUIET = 1e-3  # A; two counts of the meter and its offset


class MonitorSettings(EnergyReserveSettings):
    """Reserve, smoothing and filter settings of the energy monitor."""

    smoothing: float = setting(
        5.0,
        'Time constant with which the displayed power is smoothed.',
        unit='s',
        low=0.0,
        high=600.0,
    )
    outlook: float = setting(
        120.0,
        'Time constant of the mean power from which the time to empty is predicted.',
        unit='s',
        low=0.0,
        high=3600.0,
    )
    belief: SocFilterSettings = setting(
        SocFilterSettings(),
        'Assumed differences between the real battery cell and the vehicle file.',
    )
    way: WayHomeSettings = setting(WayHomeSettings(), 'Assumptions about the flight home.')


def update_estimate(
    settings: MonitorSettings, aboard: PowerSystem, before: EnergyEstimate, reading: MeterReading
) -> EnergyEstimate:
    """Update the energy estimate with one reading."""
    last, cell, back = before.last, aboard.cell, 0
    # Not newer than the last one: an overtaken or repeated message, or a clock that was set back
    if last is not None and reading.stamp_ns <= last.stamp_ns:
        behind = append_stamp(before.behind, reading.stamp_ns)
        if len(behind) < ENOUGH:
            dt = (reading.stamp_ns - last.stamp_ns) * 1e-9
            watch = update_detectors(before.watch, MeterObservation(reading, last, dt, cell))
            return _decide_reserve(settings, cell, before._replace(watch=watch, behind=behind))
        # Three in order mean a new clock: move the last reading to the first of the three stamps
        back = last.stamp_ns - behind[0]
        before = shift_stamps(before, back)
        last = before.last
    dt = 0.0 if last is None else (reading.stamp_ns - last.stamp_ns) * 1e-9
    expected = _predict_cell_state(settings, cell, before, reading, dt)
    seen_belief, surprise = expected, None
    if expected is not None and reading.is_usable:
        seen_belief, surprise = correct_state(
            settings.belief, cell, expected, reading.voltage, reading.current
        )
    off = _normalized_innovation(expected, surprise)
    watch = update_detectors(
        before.watch, MeterObservation(reading, last, dt, cell, off, back * 1e-9)
    )
    # A spoilt reading only lets the prediction stand; the correction is dropped
    belief = expected if watch.is_unusable else seen_belief
    # Restart the filter once, when the swap is confirmed
    another = watch.latches[SWAPPED].on and not before.watch.latches[SWAPPED].on
    if (belief is None and not watch.is_unusable) or (another and reading.is_usable):
        belief = initialize_from_reading(settings.belief, cell, reading.voltage, reading.current)
    after = before._replace(
        belief=belief, watch=watch, surprise=surprise, gap=dt, last=reading, behind=(),
        critical=_update_voltage_alarm(before.critical, reading, dt),
    )  # fmt: skip
    if not watch.is_unusable:
        after = _apply_usable_reading(settings, aboard, after, reading, dt)
    return _decide_reserve(settings, cell, after)


def _predict_cell_state(
    settings: MonitorSettings,
    cell: BatteryModel,
    before: EnergyEstimate,
    reading: MeterReading,
    dt: float,
) -> CellState | None:
    """Predict the state of the cell before the newest voltage is used."""
    belief = before.belief
    if belief is None or before.good is None:
        return belief
    current, unsure = _expected_current(before, belief)
    # Two consecutive usable readings: trapezoidal mean current; otherwise assume the load goes on
    if before.good is before.last and reading.is_usable and dt <= LONGEST:
        current = 0.5 * (before.good.current + reading.current)
        unsure = BETWEEN * abs(reading.current - before.good.current) + QUIET
    return predict_state(settings.belief, cell, belief, current, unsure, dt)


def _normalized_innovation(
    expected: CellState | None, surprise: VoltageInnovation | None
) -> float:
    """Return the voltage innovation in standard deviations; 0 beyond the ends of the chart."""
    if expected is None or surprise is None:
        return 0.0
    # A nearly empty cell may fall below the chart and a full one rise above it, without a fault
    end = EMPTY if surprise.innovation < 0.0 else 1.0 - EMPTY
    beyond = expected.charge < end if surprise.innovation < 0.0 else expected.charge > end
    return 0.0 if beyond else abs(surprise.innovation) / surprise.deviation


def _expected_current(before: EnergyEstimate, state: CellState) -> tuple[float, float]:
    """Return the current expected without a reading, and its standard deviation. [A]"""
    current = -before.load.quick / open_circuit_voltage(state.charge)
    return current, abs(current) + QUIET


def _update_voltage_alarm(before: Latch, reading: MeterReading, dt: float) -> Latch:
    """Update the alarm of critical voltage, with hysteresis."""
    if not reading.is_usable:
        return before
    # The voltage recovers when the load falls; the higher limit prevents a second take-off
    limit = RECOVERED_VOLTAGE if before.on else CRITICAL_VOLTAGE
    return update_latch(before, reading.voltage <= limit, dt, CRITICAL_RISE, CRITICAL_FALL)


def _apply_usable_reading(
    settings: MonitorSettings,
    aboard: PowerSystem,
    after: EnergyEstimate,
    reading: MeterReading,
    dt: float,
) -> EnergyEstimate:
    """Update load, energy balance and travel with a usable reading."""
    belief = after.belief
    if belief is None:
        return after
    # Power out of the chemistry, so open-circuit voltage; positive while discharging
    power = -open_circuit_voltage(belief.charge) * reading.current
    if after.good is None or after.travel is None:
        return after._replace(
            load=load.initial_load(power),
            travel=way_home.initial_travel(settings.way),
            good=reading,
        )
    return after._replace(
        load=load.update_load(after.load, power, dt, settings.smoothing, settings.outlook),
        travel=way_home.update_travel(settings.way, after.travel, reading.where, power, dt),
        books=_update_energy_balance(after.books, aboard, belief, after.good, reading),
        good=reading,
    )


def _update_energy_balance(
    books: EnergyBalance,
    aboard: PowerSystem,
    state: CellState,
    last: MeterReading,
    reading: MeterReading,
) -> EnergyBalance:
    """
    Add the interval between two usable readings to the energy balance.

    The residual of the balance shows how far model and meters disagree.
    """
    dt = (reading.stamp_ns - last.stamp_ns) * 1e-9
    # Trapezoidal means over the interval
    current = 0.5 * (last.current + reading.current)
    squared = 0.5 * (last.current**2 + reading.current**2)
    harvest = 0.5 * (last.plausible_panel_power + reading.plausible_panel_power)
    charger_power = 0.5 * (
        aboard.charger_output(last.panel_power) + aboard.charger_output(reading.panel_power)
    )
    return add_interval(
        books,
        harvest=harvest,
        load=charger_power - 0.5 * (last.cell_power + reading.cell_power),
        # Charger loss + resistive heat R I^2 + heat of the relaxation branch u I
        loss=harvest
        - charger_power
        + state.mean[RESISTANCE] * aboard.cell.resistance * squared
        + state.mean[RELAXATION] * current,
        stored=open_circuit_voltage(state.charge) * current * dt,
        dt=dt,
    )


def _decide_reserve(
    settings: MonitorSettings, cell: BatteryModel, after: EnergyEstimate
) -> EnergyEstimate:
    """Compute the reserve margin and decide whether the reserve is reached."""
    belief, travel = after.belief, after.travel
    if belief is None or travel is None:
        return after
    where = None if after.last is None else after.last.where
    away = 0.0 if where is None else where.distance
    stock = reserve.compute_reserve_margin(
        settings, cell, belief, way_home.energy_home(settings.way, travel, away)
    )
    low = reserve.is_reserve_reached(settings, after.low, stock)
    # An uncertain charge counts as a reached reserve, so that the drone errs on the safe side
    doubtful = belief.deviation > settings.doubt
    return after._replace(stock=stock, low=low, reserve=low or doubtful or after.is_landing_urgent)


def time_to_empty(
    settings: MonitorSettings, cell: BatteryModel, estimate: EnergyEstimate
) -> TimeEstimate:
    """Return the time to empty at the mean load; infinite while the cell is not drained."""
    if estimate.belief is None:
        return endurance.UNKNOWN
    spread = load.mean_load_deviation(estimate.load, settings.smoothing, settings.outlook)
    return endurance.estimate_discharge_time(cell, estimate.belief, estimate.load.mean, spread)


def time_to_full(
    settings: MonitorSettings, cell: BatteryModel, estimate: EnergyEstimate
) -> TimeEstimate:
    """Return the time to full at the mean load; infinite while the cell is not charged."""
    if estimate.belief is None:
        return endurance.UNKNOWN
    spread = load.mean_load_deviation(estimate.load, settings.smoothing, settings.outlook)
    return endurance.estimate_charging_time(cell, estimate.belief, estimate.load.mean, spread)
