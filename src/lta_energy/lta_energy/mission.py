# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate a mission over days: charge on the perch, fly by the schedule, keep the energy totals.

Time on the perch advances in steps of 30 s. Flights are simulated by the `fly` callable. Both use
the same cell (`lta_energy.circuit`).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
import math
from typing import final, NamedTuple

from lta_energy.circuit import (
    add_totals,
    ChargeGauge,
    EnergyTotals,
    NO_ENERGY,
    step_circuit,
    update_gauge,
)
from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import IrradianceSeries, PanelIrradiance
from lta_energy.schedule import Schedule, ScheduleDecision, ScheduleInputs
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import (
    charger_output,
    ChargerModel,
    PowerFlow,
    resting_flow,
    total_stored_energy,
)

# AWAY: landed elsewhere and waiting for pickup; EMPTY: on the perch with an empty cell
PERCHED, ASLEEP, ALOFT, AWAY, EMPTY = range(5)


class MissionFlight(NamedTuple):
    """Log entry of one flight."""

    start: float  # since the first midnight [s]
    duration: float  # time in the air [s]
    visits: int  # number of beacons of the round that were reached
    path: float  # horizontal length [m]
    spent: EnergyTotals
    # True state of charge [1]
    before: float
    after: float
    told: float  # estimated state of charge after the flight [1]
    lowest: float  # minimum voltage [V]
    # 'home', or how the flight failed: 'empty', 'away' (landed elsewhere at the reserve), 'lost'
    # (did not find the next beacon in time), 'escaped', 'stopped'
    ending: str
    # Time since take-off [s], position [m, map] and attitude x y z w; only of the first flights
    track: tuple[tuple[float, ...], ...] = ()


@final
@dataclass(slots=True)
class MissionLog:
    """Log of a mission."""

    flights: list[MissionFlight] = field(default_factory=list)
    time: list[float] = field(default_factory=list)  # sample times, about one per minute [s]
    # True state of charge, its estimate and the estimate's standard deviation [1]
    charge: list[float] = field(default_factory=list)
    told: list[float] = field(default_factory=list)
    deviation: list[float] = field(default_factory=list)
    state: list[int] = field(
        default_factory=list
    )  # `PERCHED`, `ASLEEP`, `ALOFT`, `AWAY` or `EMPTY`
    # Mean powers since the sample before; times the time between, they add up to `spent` [W]
    harvested: list[float] = field(default_factory=list)
    consumed: list[float] = field(default_factory=list)
    lost: list[float] = field(default_factory=list)
    spent: EnergyTotals = NO_ENERGY  # energy totals, flights included [J]
    # Energy stored in the cell at start and end [J]
    begun: float = 0.0
    ended: float = 0.0
    outages: int = 0  # number of times that the cell ran empty on the perch
    dark: int = 0  # number of flights that ended without light on the panel
    grounded: int = 0  # number of flights not flown, as warm gas made the drone too light

    @property
    def imbalance(self) -> float:
        """Residual of the energy balance, relative to the harvested or consumed energy [1]."""
        spent = self.spent
        rest = spent.harvested - spent.consumed - spent.lost - (self.ended - self.begun)
        # The bound [J] avoids 0 / 0 in a mission without light and loads
        return rest / max(spent.harvested, spent.consumed, 1e-9)

    @property
    def failure_count(self) -> int:
        """Return how many flights failed or came home in the dark, plus outages on the perch."""
        return sum(each.ending != 'home' for each in self.flights) + self.dark + self.outages


PERCH_STEP = 30.0  # s on the perch
SECONDS_AN_HOUR = 3600.0
FIRST_DEVIATION = 0.05  # initial standard deviation of the estimated charge


class Departure(NamedTuple):
    """State at take-off: time [s], power path, estimated state of charge, light, flight number."""

    time: float
    store: PowerFlow
    told: float
    light: PanelIrradiance
    number: int


class Landing(NamedTuple):
    """Result of a flight: the power path after it, and the log entry."""

    store: PowerFlow
    flight: MissionFlight


Fly = Callable[[Departure], Landing]


@final
@dataclass(frozen=True, slots=True)
class PerchConfig:
    """Cell, charger, loads and rules of operation on the perch."""

    cell: BatteryModel
    charger: ChargerModel
    harvest: HarvestCurve
    # Load on the perch [W]
    awake: float
    asleep: float
    work: tuple[float, float]  # start and end of the working hours [s of the day]
    reserve: float  # state of charge that a flight must leave [1]
    charge: float  # state of charge at the first midnight [1]
    fetched: float  # time until a drone that landed elsewhere is brought back [s]
    brightest: float = math.inf  # light above which its warm gas makes it too light to fly [W/m2]
    # Scale factor [1] and offset [A] of the current meter
    gain: float = 1.0
    offset: float = 0.0


@final
class MissionSimulation:
    """
    Simulate one mission.

    `light`: light on the perch. `fly`: simulates one flight. `guess`: energy [J] and duration [s]
    assumed for a flight before the first one.
    """

    def __init__(
        self,
        upkeep: PerchConfig,
        light: IrradianceSeries,
        schedule: Schedule,
        fly: Fly,
        guess: tuple[float, float],
    ) -> None:
        self._upkeep, self._light, self._schedule, self._fly = upkeep, light, schedule, fly
        self._guess = guess
        self.now = 0.0
        # The true state of the cell; the schedule only ever receives the gauge
        self._store = resting_flow(upkeep.charge)
        self._gauge = ChargeGauge(upkeep.charge, FIRST_DEVIATION)
        self._seen = 1.0
        self._out = False
        self._logged = NO_ENERGY
        self.diary = MissionLog(begun=total_stored_energy(upkeep.cell, self._store))
        self.diary.ended = self.diary.begun

    def run(self, on_progress: Callable[[float], None] = lambda _: None) -> MissionLog:
        """Simulate all days and return the log; `on_progress` receives the simulated time [s]."""
        while self.now < self._light.end:
            wish = self._schedule(self._collect_schedule_inputs())
            if self._out:
                self._charge_until(self.now + PERCH_STEP, 0.0, EMPTY)
            elif wish.fly and self._is_too_light():
                # The time of the flight passes on the perch
                self.diary.grounded += 1
                self._rest_on_perch(wish._replace(until=self.now + self._flight_time()))
            elif wish.fly:
                self._fly_once()
            else:
                self._rest_on_perch(wish)
            on_progress(self.now)
        self.diary.ended = total_stored_energy(self._upkeep.cell, self._store)
        # A flight or a pickup at the end has logged it already
        if self.diary.time[-1] < self.now:
            self._append_sample(self.diary.state[-1], self.now, self.diary.spent)
        return self.diary

    def _is_too_light(self) -> bool:
        """Return whether light on the hull makes the drone too light to take off now."""
        light = self._light.at(self.now)
        return light.sun + light.lamps > self._upkeep.brightest

    def _flight_time(self) -> float:
        """Return the time that a flight takes: the last one's, at first the assumed one [s]."""
        return self.diary.flights[-1].duration if self.diary.flights else self._guess[1]

    def _collect_schedule_inputs(self) -> ScheduleInputs:
        """Collect what a schedule may use, with the flight statistics so far."""
        # Flights that failed say nothing about the need of a complete one
        flights = [f for f in self.diary.flights if f.ending == 'home'][-20:]
        needs = [f.spent.consumed + f.spent.lost - f.spent.harvested for f in flights]
        # Before the first flight: assume a standard deviation of 10 %
        need, spread, lasts = self._guess[0], 0.1 * self._guess[0], self._guess[1]
        if needs:
            need = sum(needs) / len(needs)
            # The lower bound of 5 % covers one or two flights, whose scatter is zero or accidental
            spread = max(math.sqrt(sum((n - need) ** 2 for n in needs) / len(needs)), 0.05 * need)
            lasts = max(f.duration for f in flights)
        last = self.diary.flights[-1] if self.diary.flights else None
        up = self._upkeep
        return ScheduleInputs(
            self.now,
            self._gauge,
            up.cell,
            self._charger_output,
            self._light,
            self._seen,
            up.awake,
            up.asleep,
            up.work,
            up.reserve,
            need,
            spread,
            lasts,
            last.start + last.duration if last else -math.inf,
            last.duration if last else 0.0,
        )

    def _fly_once(self) -> None:
        """Simulate one flight, and the pickup if the drone does not come home."""
        diary, begin, before = self.diary, self.now, self.diary.spent
        light = self._light.at(begin)
        number = len(diary.flights)
        landing = self._fly(Departure(begin, self._store, self._gauge.charge, light, number))
        flight = landing.flight
        self._store = landing.store
        # The deviation grows by 0.3 % of the charge that was counted in flight
        deviation = self._gauge.deviation + abs(flight.before - flight.after) * 0.003
        self._gauge = ChargeGauge(flight.told, deviation)
        diary.flights.append(flight)
        diary.spent = add_totals(diary.spent, flight.spent)
        self.now = begin + flight.duration
        # A straight line in the trace between take-off and landing
        self._record_state(ALOFT, begin, before)
        self._record_state(ALOFT, self.now, diary.spent)
        if not sum(self._light.forecast_irradiance(self.now)[:3]) > 0.0:
            diary.dark += 1
        if flight.ending != 'home':
            self._wait_for_pickup(self.now + self._upkeep.fetched)

    def _wait_for_pickup(self, until: float) -> None:
        """Wait switched off and in the dark until the drone is fetched."""
        self._record_state(AWAY, self.now, self.diary.spent)
        self.now = min(until, self._light.end)
        self._record_state(AWAY, self.now, self.diary.spent)

    def _rest_on_perch(self, wish: ScheduleDecision) -> None:
        """Stay on the perch as long as the schedule asks, but at least one minute."""
        up = self._upkeep
        # A schedule that asks for no rest must not stop the time
        until = max(wish.until, self.now + 2 * PERCH_STEP)
        load = up.asleep if wish.asleep else up.awake
        self._charge_until(min(until, self._light.end), load, ASLEEP if wish.asleep else PERCHED)

    def _charge_until(self, until: float, load: float, state: int) -> None:
        """Charge until a time, or until the cell runs empty."""
        up = self._upkeep
        # The tolerance absorbs the rounding of a sum of steps [s]
        while self.now < until - 1e-6:
            dt = min(PERCH_STEP, until - self.now)
            light, before = self._light.at(self.now), self.diary.spent
            self._store, self.diary.spent = step_circuit(
                up.cell, up.charger, self._store, before, up.harvest(light), load, dt
            )
            store = self._store
            # The gauge counts what the imperfect meter reads
            metered = up.gain * store.current + up.offset
            self._gauge = update_gauge(up.cell, self._gauge, store.voltage, metered, dt)
            self._track_clearness(light, dt)
            self._record_state(state, self.now, before)
            self.now += dt
            # Count an outage once, when the supply fails
            if not (self._out or store.fed):
                self._out, self.diary.outages = True, self.diary.outages + 1
                return
        self._out = not self._store.fed

    def _charger_output(self, light: PanelIrradiance) -> float:
        """Return the charger's maximum output in some light [W]."""
        return charger_output(self._upkeep.charger, self._upkeep.harvest(light))

    def _track_clearness(self, light: PanelIrradiance, dt: float) -> None:
        """Update the mean ratio of sunlight to its forecast."""
        due = self._light.forecast_irradiance(self.now).sun
        # By night, and at dawn below 1 W/m2, the ratio is meaningless
        if due > 1.0:
            # First-order filter with a time constant of one hour
            self._seen += (light.sun / due - self._seen) * min(dt / SECONDS_AN_HOUR, 1.0)

    def _record_state(self, state: int, time: float, spent: EnergyTotals) -> None:
        """
        Record the trace once a minute, at every change and at both ends of a flight.

        `spent` are the energy totals up to `time`.
        """
        diary = self.diary
        same = bool(diary.state) and diary.state[-1] == state
        if same and state != ALOFT and time - diary.time[-1] < 60.0:
            return
        self._append_sample(state, time, spent)

    def _append_sample(self, state: int, time: float, spent: EnergyTotals) -> None:
        diary, logged = self.diary, self._logged
        lasted = time - diary.time[-1] if diary.time else 0.0
        # Two samples at one time mark a change of state, between which nothing is spent
        for name in ('harvested', 'consumed', 'lost'):
            energy = getattr(spent, name) - getattr(logged, name)
            getattr(diary, name).append(energy / lasted if lasted > 0.0 else 0.0)
        self._logged = spent
        diary.time.append(time)
        diary.charge.append(self._store.charge)
        diary.told.append(self._gauge.charge)
        diary.deviation.append(self._gauge.deviation)
        diary.state.append(state)
