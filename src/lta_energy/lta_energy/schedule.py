# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Decide when to fly: a fixed duty cycle, or a schedule that accounts for light, charge and night.

A schedule is a pure function of what the drone can know. Both call `is_flight_safe` before
take-off, so that they take the same risk and differ only in when they fly.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

from lta_config.schema.mission_file import DAY
from lta_energy.circuit import ChargeGauge
from lta_energy.irradiance import IrradianceSeries, PanelIrradiance
from lta_model.electrical.battery import BatteryModel, stored_energy

# Margin at take-off, in standard deviations of charge and of a flight's energy
MARGIN_DEVIATIONS = 2.0
DECISION_PERIOD = 300.0  # s between two decisions while waiting
FORECAST_STEP = 600.0  # s; time step of the forecast
NIGHT_FACTOR = 1.3  # safety factor on the predicted energy for the night


class ScheduleInputs(NamedTuple):
    """What a schedule may use."""

    time: float  # since the first midnight [s]
    gauge: ChargeGauge  # estimated state of charge
    cell: BatteryModel  # nominal cell
    income: Callable[[PanelIrradiance], float]  # maps light to the charger's maximum output [W]
    light: IrradianceSeries  # only its `forecast` is used
    seen: float  # ratio of measured to forecast sunlight over the last hour of daylight [1]
    # Load on the perch [W]
    awake: float
    asleep: float
    work: tuple[float, float]  # start and end of the working hours [s of the day]
    reserve: float  # state of charge that a flight must leave [1]
    # Mean energy of a flight so far, and its standard deviation [J]
    need: float
    spread: float
    flight: float  # duration of a flight [s]
    # End and duration of the last flight; `landed` is -inf before the first [s]
    landed: float
    lasted: float


class ScheduleDecision(NamedTuple):
    """Whether to fly now; otherwise until when to rest, and whether asleep."""

    fly: bool
    until: float = 0.0
    asleep: bool = False


Schedule = Callable[[ScheduleInputs], ScheduleDecision]


def is_within_working_hours(inputs: ScheduleInputs) -> bool:
    """Return whether a flight that starts now ends within the working hours."""
    clock = inputs.time % DAY
    begin, end = inputs.work
    if begin <= end:
        # Half a flight's duration is added as a margin
        return begin <= clock and clock + 1.5 * inputs.flight <= end
    # Working hours over midnight
    return clock >= begin or clock + 1.5 * inputs.flight <= end


def next_work_start(inputs: ScheduleInputs) -> float:
    """Return the next start of the working hours [s]."""
    today = inputs.time - inputs.time % DAY + inputs.work[0]
    return today if today > inputs.time else today + DAY


def next_work_end(inputs: ScheduleInputs) -> float:
    """Return the next end of the working hours [s]."""
    today = inputs.time - inputs.time % DAY + inputs.work[1]
    return today if today >= inputs.time else today + DAY


def reserve_energy(inputs: ScheduleInputs) -> float:
    """Return the energy of the reserve plus the margin for the uncertain charge [J]."""
    sure = inputs.reserve + MARGIN_DEVIATIONS * inputs.gauge.deviation
    return stored_energy(min(sure, 1.0), inputs.cell.capacity)


def estimate_cell_energy(inputs: ScheduleInputs) -> float:
    """Return the estimated energy in the cell [J]."""
    return stored_energy(inputs.gauge.charge, inputs.cell.capacity)


def is_flight_safe(inputs: ScheduleInputs) -> bool:
    """Return whether the charge suffices for a flight, with margins."""
    return estimate_cell_energy(
        inputs
    ) - inputs.need - MARGIN_DEVIATIONS * inputs.spread >= reserve_energy(inputs)


def build_fixed_schedule(rest: float, *, asleep: bool = False) -> Schedule:
    """Return a schedule that rests `rest` times as long as the last flight, in working hours."""

    def decide_next_flight(inputs: ScheduleInputs) -> ScheduleDecision:
        if not is_within_working_hours(inputs):
            return ScheduleDecision(False, next_work_start(inputs), True)
        ready = inputs.landed + rest * inputs.lasted
        if inputs.time < ready:
            return ScheduleDecision(False, ready, asleep)
        return (
            ScheduleDecision(True)
            if is_flight_safe(inputs)
            else ScheduleDecision(False, inputs.time + DECISION_PERIOD, asleep)
        )

    return decide_next_flight


def schedule_by_light(inputs: ScheduleInputs) -> ScheduleDecision:
    """
    Decide by light, charge and night.

    Fly when the charge is safe and either the night remains covered after the flight, or the cell
    would be full before dark and light would be wasted. Otherwise sleep.
    """
    if not is_within_working_hours(inputs):
        return ScheduleDecision(False, next_work_start(inputs), True)
    if not is_flight_safe(inputs):
        return ScheduleDecision(False, inputs.time + DECISION_PERIOD, True)
    full, dusk = forecast_charge(inputs)
    if full or dusk - inputs.need >= night_energy(inputs):
        return ScheduleDecision(True)
    return ScheduleDecision(False, inputs.time + DECISION_PERIOD, True)


def forecast_charge(inputs: ScheduleInputs) -> tuple[bool, float]:
    """Return whether the cell fills before the end of work, and its energy then [J]."""
    energy, most = estimate_cell_energy(inputs), stored_energy(1.0, inputs.cell.capacity)
    full, time = False, inputs.time
    # Not `is_within_working_hours` of each step: a break shorter than a step is stepped over,
    # and work never ends.
    last = next_work_end(inputs) - 1.5 * inputs.flight
    while time <= last:
        # Assume that the drone sleeps until then
        energy += (forecast_harvest(inputs, time) - inputs.asleep) * FORECAST_STEP
        if energy >= most:
            full, energy = True, most
        time += FORECAST_STEP
    return full, energy


def night_energy(inputs: ScheduleInputs) -> float:
    """Return the energy needed at the end of work to last until the next morning [J]."""
    time = next_work_end(inputs)
    end, needed, used = time + DAY, 0.0, 0.0
    # Until the morning light covers the load of the sleeping drone; a day at most
    while time < end and forecast_harvest(inputs, time) < inputs.asleep:
        used += (inputs.asleep - forecast_harvest(inputs, time)) * FORECAST_STEP
        needed = max(needed, used)
        time += FORECAST_STEP
    # The factor covers a forecast that is too optimistic about the next morning
    return reserve_energy(inputs) + NIGHT_FACTOR * needed


def forecast_harvest(inputs: ScheduleInputs, time: float) -> float:
    """Forecast the harvest at a time, starting from the present cloudiness [W]."""
    light = inputs.light.forecast_irradiance(time)
    # Decay from the present cloudiness to the mean, with a time constant of two hours [s]
    weight = math.exp(-(time - inputs.time) / 7200.0)
    seen = 1.0 + weight * (inputs.seen - 1.0)
    return inputs.income(light._replace(sun=seen * light.sun))
