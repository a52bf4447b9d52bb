"""
When to fly: the naive duty cycle, and one that reckons with light, charge and the night.

A schedule is a plain function of what the drone can know. Both ask `is_flight_safe` before a
take-off, so that they differ in when they fly, not in what they dare.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

from lta_config.schema.light_day_file import DAY
from lta_energy.gauge import ChargeGauge
from lta_energy.irradiance import IrradianceSeries, PanelIrradiance
from lta_model.electrical.battery import BatteryModel, stored_energy

SURE = 2.0  # standard deviations of charge and of a flight's need that a take-off allows for
LOOK = 300.0  # s between two looks of the energy-aware schedule while it waits
STEP = 600.0  # s of the forecast
NIGHT = 1.3  # of the energy that the night is reckoned to take, so much is kept for it


class ScheduleInputs(NamedTuple):
    """
    What a schedule may look at.

    Attributes
    ----------
    time : float
        Since the first midnight. [s]
    gauge : Gauge
        Charge as the drone knows it.
    cell : Battery
        As the drone believes it.
    income : callable
        What the charger can give in some light. [W]
    light : LightOfDays
        Of which only `expected` is looked at.
    seen : float
        Light by what was to be expected, over the last hour by day. [1]
    awake, asleep : float
        What is drawn on the perch. [W]
    work : tuple of float
        Times of the day between which it may fly. [s]
    reserve : float
        State of charge that a flight must leave.
    need, spread : float
        Energy of a flight, as flown so far, and its standard deviation. [J]
    flight : float
        How long one lasts. [s]
    landed, lasted : float
        When the last flight ended, and how long it was; `landed` is -inf before the first. [s]

    """

    time: float
    gauge: ChargeGauge
    cell: BatteryModel
    income: Callable[[PanelIrradiance], float]
    light: IrradianceSeries
    seen: float
    awake: float
    asleep: float
    work: tuple[float, float]
    reserve: float
    need: float
    spread: float
    flight: float
    landed: float
    lasted: float


class ScheduleDecision(NamedTuple):
    """What to do next: fly, or rest until a time, asleep or awake."""

    fly: bool
    until: float = 0.0
    asleep: bool = False


Schedule = Callable[[ScheduleInputs], ScheduleDecision]


def is_within_hours(inputs: ScheduleInputs) -> bool:
    """Tell whether a flight that starts now is back within the hours of work."""
    clock = inputs.time % DAY
    begin, end = inputs.work
    if begin <= end:
        return begin <= clock and clock + 1.5 * inputs.flight <= end
    return clock >= begin or clock + 1.5 * inputs.flight <= end


def next_work_start(inputs: ScheduleInputs) -> float:
    """Return when work begins next. [s]"""
    today = inputs.time - inputs.time % DAY + inputs.work[0]
    return today if today > inputs.time else today + DAY


def next_work_end(inputs: ScheduleInputs) -> float:
    """Return when work ends next. [s]"""
    today = inputs.time - inputs.time % DAY + inputs.work[1]
    return today if today >= inputs.time else today + DAY


def reserve_energy(inputs: ScheduleInputs) -> float:
    """Return the energy that a cell which is surely above the reserve holds. [J]"""
    sure = inputs.reserve + SURE * inputs.gauge.deviation
    return stored_energy(min(sure, 1.0), inputs.cell.capacity)


def estimate_cell_energy(inputs: ScheduleInputs) -> float:
    """Return what the cell holds, as the drone knows it. [J]"""
    return stored_energy(inputs.gauge.charge, inputs.cell.capacity)


def is_flight_safe(inputs: ScheduleInputs) -> bool:
    """Tell whether the charge suffices for a flight."""
    return estimate_cell_energy(inputs) - inputs.need - SURE * inputs.spread >= reserve_energy(
        inputs
    )


def build_fixed_schedule(rest: float, *, asleep: bool = False) -> Schedule:
    """Return the naive schedule: rest so many times the flight [1], awake in the hours of work."""

    def decide(inputs: ScheduleInputs) -> ScheduleDecision:
        if not is_within_hours(inputs):
            return ScheduleDecision(False, next_work_start(inputs), True)
        ready = inputs.landed + rest * inputs.lasted
        if inputs.time < ready:
            return ScheduleDecision(False, ready, asleep)
        return (
            ScheduleDecision(True)
            if is_flight_safe(inputs)
            else ScheduleDecision(False, inputs.time + LOOK, asleep)
        )

    return decide


def schedule_by_light(inputs: ScheduleInputs) -> ScheduleDecision:
    """
    Return what the energy-aware schedule wants.

    It flies when the charge is safe and either the night is provided for without what the flight
    takes, or the cell would be full before dark and light be wasted. Otherwise it sleeps.
    """
    if not is_within_hours(inputs):
        return ScheduleDecision(False, next_work_start(inputs), True)
    if not is_flight_safe(inputs):
        return ScheduleDecision(False, inputs.time + LOOK, True)
    full, dusk = forecast_charge(inputs)
    if full or dusk - inputs.need >= night_energy(inputs):
        return ScheduleDecision(True)
    return ScheduleDecision(False, inputs.time + LOOK, True)


def forecast_charge(inputs: ScheduleInputs) -> tuple[bool, float]:
    """Tell whether the cell would be full by the end of work, and what it would hold then. [J]"""
    energy, most = estimate_cell_energy(inputs), stored_energy(1.0, inputs.cell.capacity)
    full, time = False, inputs.time
    # Not `is_within_hours` of each step: a break shorter than a step is stepped over, and work
    # never ends.
    last = next_work_end(inputs) - 1.5 * inputs.flight
    while time <= last:
        energy += (forecast_harvest(inputs, time) - inputs.asleep) * STEP
        if energy >= most:
            full, energy = True, most
        time += STEP
    return full, energy


def night_energy(inputs: ScheduleInputs) -> float:
    """Return what the cell must hold at the end of work to reach the next morning. [J]"""
    time = next_work_end(inputs)
    end, needed, taken = time + DAY, 0.0, 0.0
    while time < end and forecast_harvest(inputs, time) < inputs.asleep:
        taken += (inputs.asleep - forecast_harvest(inputs, time)) * STEP
        needed = max(needed, taken)
        time += STEP
    return reserve_energy(inputs) + NIGHT * needed


def forecast_harvest(inputs: ScheduleInputs, time: float) -> float:
    """Return the harvest that is to be expected at a time, as cloudy as it is now. [W]"""
    light = inputs.light.forecast(time)
    # The sky as it is now says little about the sky in some hours.
    weight = math.exp(-(time - inputs.time) / 7200.0)
    seen = 1.0 + weight * (inputs.seen - 1.0)
    return inputs.income(light._replace(sun=seen * light.sun))
