"""
Estimate the drone's energy from its meters: charge, balance, load, reserve and faults.

For each reading: predict the voltage, run the fault detectors, correct the filter (or only predict
it if the reading is unusable), then update energy balance, load, way home and reserve. The true
state is never used.
"""

from lta_config.settings import setting
from lta_energy.faults.detector import MeterObservation
from lta_energy.faults.fault_monitor import SWAPPED, update_detectors
from lta_energy.faults.gap import LONGEST
from lta_energy.monitoring import load, reserve, way_home
from lta_energy.monitoring.clock_shift import append_stamp, ENOUGH, shift_stamps
from lta_energy.monitoring.energy_balance import update_energy_balance
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
    SocFilterSettings,
    VoltageInnovation,
)
from lta_energy.monitoring.way_home import WayHomeSettings
from lta_model.electrical.battery import BatteryModel

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
    corrected, surprise, off = expected, None, 0.0
    if expected is not None and reading.is_usable:
        corrected, surprise = correct_state(
            settings.belief, cell, expected, reading.voltage, reading.current
        )
        off = _normalized_innovation(expected, surprise)
    watch = update_detectors(
        before.watch, MeterObservation(reading, last, dt, cell, off, back * 1e-9)
    )
    # A spoilt reading only lets the prediction stand; the correction is dropped
    belief = expected if watch.is_unusable else corrected
    # Restart the filter once, when the swap is confirmed
    another = watch.latches[SWAPPED].on and not before.watch.latches[SWAPPED].on
    if (belief is None and not watch.is_unusable) or (another and reading.is_usable):
        belief = initialize_from_reading(settings.belief, cell, reading.voltage, reading.current)
    after = before._replace(
        belief=belief, watch=watch, surprise=surprise, gap=dt, last=reading, behind=(),
        critical=_update_voltage_alarm(before.critical, reading, dt),
    )  # fmt: skip
    if belief is not None and not watch.is_unusable:
        after = _apply_usable_reading(settings, aboard, after, belief, reading, dt)
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
    # Two consecutive usable readings: trapezoidal mean current; otherwise assume the load goes on
    if before.good is before.last and reading.is_usable and dt <= LONGEST:
        current = 0.5 * (before.good.current + reading.current)
        unsure = BETWEEN * abs(reading.current - before.good.current) + QUIET
    else:
        current = -before.load.quick / belief.resting_voltage
        unsure = abs(current) + QUIET
    return predict_state(settings.belief, cell, belief, current, unsure, dt)


def _normalized_innovation(expected: CellState, surprise: VoltageInnovation) -> float:
    """Return the voltage innovation in standard deviations; 0 beyond the ends of the chart."""
    # A nearly empty cell may fall below the chart and a full one rise above it, without a fault
    end = EMPTY if surprise.innovation < 0.0 else 1.0 - EMPTY
    beyond = expected.charge < end if surprise.innovation < 0.0 else expected.charge > end
    return 0.0 if beyond else abs(surprise.innovation) / surprise.deviation


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
    state: CellState,
    reading: MeterReading,
    dt: float,
) -> EnergyEstimate:
    """Update load, energy balance and travel with a usable reading."""
    # Power out of the chemistry, so open-circuit voltage; positive while discharging
    power = -state.resting_voltage * reading.current
    if after.good is None or after.travel is None:
        return after._replace(
            load=load.initial_load(power),
            travel=way_home.initial_travel(settings.way),
            good=reading,
        )
    return after._replace(
        load=load.update_load(after.load, power, dt, settings.smoothing, settings.outlook),
        travel=way_home.update_travel(settings.way, after.travel, reading.where, power, dt),
        books=update_energy_balance(after.books, aboard, state, after.good, reading),
        good=reading,
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
