# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the drone's energy from its meters: charge, balance, load, reserve and faults.

For each reading: predict the voltage, run the fault detectors, correct the filter (or only predict
it if the reading is unusable), then update energy balance, load, way home and reserve. The true
state is never used.

Messages that were delayed or repeated do not arrive in ascending order three times in a row, so
three such stamps before the newest one mean a clock that was set back. The newest old reading is
then placed at the time of the first new one, because the time between the two is unknown.
"""

from dataclasses import replace
import math
from typing import Final, NamedTuple

from lta_config.settings import setting
from lta_energy.monitoring import outlook
from lta_energy.monitoring.faults import (
    DetectorStates,
    Latch,
    LONGEST_GAP,
    MeterObservation,
    SWAPPED_INDEX,
    update_detectors,
    update_latch,
)
from lta_energy.monitoring.meters import (
    EnergyBalance,
    MeterReading,
    PowerSystem,
    update_energy_balance,
)
from lta_energy.monitoring.outlook import (
    EnergyReserveSettings,
    LoadEstimate,
    ReserveMargin,
    TravelEstimate,
    WayHomeSettings,
)
from lta_energy.monitoring.soc_ekf import (
    CellState,
    correct_state,
    initialize_from_reading,
    predict_state,
    SocFilterSettings,
    VoltageInnovation,
)
from lta_model.electrical.battery import BatteryModel


class EnergyEstimate(NamedTuple):
    """Energy estimate after a reading."""

    belief: CellState | None = None  # state of the cell; None before the first usable reading
    load: LoadEstimate = LoadEstimate()  # power drawn from the cell's chemistry, losses included
    travel: TravelEstimate | None = None  # power and speed of flight
    stock: ReserveMargin | None = None  # charge compared with reserve and way home
    low: bool = False  # whether the charge has reached the reserve, with hysteresis
    # Whether the reserve counts as reached: by the charge, or because the estimate is unreliable
    reserve: bool = True
    critical: Latch = Latch()  # whether the voltage is so low that the drone must land
    watch: DetectorStates = DetectorStates()  # state of the fault detectors
    surprise: VoltageInnovation | None = None  # innovation of the newest voltage
    gap: float = 0.0  # time since the previous reading [s]
    last: MeterReading | None = None  # the newest reading
    good: MeterReading | None = None  # the newest usable reading
    books: EnergyBalance = EnergyBalance()  # energy balance since the first usable reading
    # Stamps of readings received after `last` that lie before it, in ascending order [ns]
    behind: tuple[int, ...] = ()

    @property
    def charge(self) -> float:
        """State of charge; NaN before the first usable reading [1]."""
        return math.nan if self.belief is None else self.belief.charge

    @property
    def deviation(self) -> float:
        """Return the standard deviation of the state of charge [1]."""
        return math.nan if self.belief is None else self.belief.deviation

    @property
    def is_landing_urgent(self) -> bool:
        """Whether to land at once: no estimate, critical voltage, or unreliable readings."""
        return self.belief is None or self.critical.on or self.watch.is_doubtful


NEW_CLOCK_READINGS: Final = 3  # readings


def append_stamp(before: tuple[int, ...], stamp_ns: int) -> tuple[int, ...]:
    """Append a stamp to an ascending sequence, or start a new sequence [ns]."""
    return (*before, stamp_ns) if before and stamp_ns > before[-1] else (stamp_ns,)


def shift_stamps(estimate: EnergyEstimate, back_ns: int) -> EnergyEstimate:
    """Move the stamps of an estimate back into the new clock [ns]."""
    last, good = _shift_reading(estimate.last, back_ns), _shift_reading(estimate.good, back_ns)
    # `good is last` marks that the newest reading is usable; keep that identity
    return estimate._replace(last=last, good=last if estimate.good is estimate.last else good)


def _shift_reading(reading: MeterReading | None, back_ns: int) -> MeterReading | None:
    return None if reading is None else replace(reading, stamp_ns=reading.stamp_ns - back_ns)


CRITICAL_VOLTAGE = 3.2  # V under load; Bitcraze's low-battery limit
RECOVERED_VOLTAGE = 3.3  # V
CRITICAL_RISE, CRITICAL_FALL = 0.3, 5.0  # s
CHANGE_DEVIATION = 0.3  # standard deviation of the mean current, relative to its change (uniform)
CHART_END = 0.02  # state of charge at either end where cells deviate from the chart
CURRENT_DEVIATION = 1e-3  # A; two counts of the meter and its offset


class MonitorSettings(EnergyReserveSettings):
    """Reserve, smoothing and filter settings of the energy monitor."""

    smoothing: float = setting(5.0, 's', 0.0, 600.0)
    """Time constant with which the displayed power is smoothed."""
    outlook: float = setting(120.0, 's', 0.0, 3600.0)
    """Time constant of the mean power from which the time to empty is predicted."""
    belief: SocFilterSettings = setting(SocFilterSettings())
    """Assumed differences between the real battery cell and the vehicle file."""
    way: WayHomeSettings = setting(WayHomeSettings())
    """Assumptions about the flight home."""


def update_estimate(
    settings: MonitorSettings, aboard: PowerSystem, before: EnergyEstimate, reading: MeterReading
) -> EnergyEstimate:
    """Update the energy estimate with one reading."""
    last, cell, back = before.last, aboard.cell, 0
    # Not newer than the last one: an overtaken or repeated message, or a clock that was set back
    if last is not None and reading.stamp_ns <= last.stamp_ns:
        behind = append_stamp(before.behind, reading.stamp_ns)
        if len(behind) < NEW_CLOCK_READINGS:
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
    another = watch.latches[SWAPPED_INDEX].on and not before.watch.latches[SWAPPED_INDEX].on
    if (belief is None and not watch.is_unusable) or (another and reading.is_usable):
        belief = initialize_from_reading(settings.belief, cell, reading.voltage, reading.current)
    after = before._replace(
        belief=belief,
        watch=watch,
        surprise=surprise,
        gap=dt,
        last=reading,
        behind=(),
        critical=_update_voltage_alarm(before.critical, reading, dt),
    )
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
    if before.good is before.last and reading.is_usable and dt <= LONGEST_GAP:
        current = 0.5 * (before.good.current + reading.current)
        unsure = CHANGE_DEVIATION * abs(reading.current - before.good.current) + CURRENT_DEVIATION
    else:
        current = -before.load.quick / belief.resting_voltage
        unsure = abs(current) + CURRENT_DEVIATION
    return predict_state(settings.belief, cell, belief, current, unsure, dt)


def _normalized_innovation(expected: CellState, surprise: VoltageInnovation) -> float:
    """Return the voltage innovation in standard deviations; 0 beyond the ends of the chart."""
    # A nearly empty cell may fall below the chart and a full one rise above it, without a fault
    end = CHART_END if surprise.innovation < 0.0 else 1.0 - CHART_END
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
            load=outlook.initial_load(power),
            travel=outlook.initial_travel(settings.way),
            good=reading,
        )
    return after._replace(
        load=outlook.update_load(after.load, power, dt, settings.smoothing, settings.outlook),
        travel=outlook.update_travel(settings.way, after.travel, reading.where, power, dt),
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
    stock = outlook.compute_reserve_margin(
        settings, cell, belief, outlook.energy_home(settings.way, travel, away)
    )
    low = outlook.is_reserve_reached(settings, after.low, stock)
    # An uncertain charge counts as a reached reserve, so that the drone errs on the safe side
    doubtful = belief.deviation > settings.doubt
    return after._replace(stock=stock, low=low, reserve=low or doubtful or after.is_landing_urgent)
