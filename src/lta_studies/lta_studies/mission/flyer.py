# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly one flight of a mission on the compiled model: the round of beacons and back, leg by leg.

The drone turns back when its charge estimate reaches the reserve or a beacon is not found in time.
It lands where it is at half of the reserve. A dock catches it when it passes the perch within the
reach of the dock, at the height of the scene's goal; a beacon counts as visited where the scene's
goal says that it is reached.
"""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.schema.mission_file import LightDay, MissionFile
from lta_control.mission import Phase
from lta_control.strategies.homing import HOMING_STRATEGY
from lta_energy.circuit import EnergyTotals
from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import IrradianceSeries, PanelIrradiance, simulate_irradiance
from lta_energy.mission import Departure, Landing, MissionFlight, MissionSimulation, PerchConfig
from lta_energy.schedule import build_fixed_schedule, Schedule, schedule_by_light
from lta_sim.supply import draw_meter_errors, PowerMeterSettings
from lta_sim.termination import build_goal, is_at_lamp
from lta_studies.mission.gas import draw_slack, find_brightest_light
from lta_studies.mission.leg_state import (
    DONE,
    DWELL,
    EMPTY,
    ESCAPED,
    FLYING,
    GO,
    LAND,
    LATE,
    LegPlan,
    LegState,
    RESERVE,
    STOPPED,
)
from lta_studies.mission.legs import LegPilot
from lta_studies.mission.scene import MissionScene
import numpy as np
from numpy.typing import NDArray

ASSUMED_FLIGHT_POWER: Final = 2.2  # W, assumed flight power before the first flight
AWARE, NAIVE, DOZING = 'by light', 'duty cycle', 'duty cycle, asleep'


def build_schedule(name: str, mission: MissionFile) -> Schedule:
    """Return a schedule by its name."""
    return (
        schedule_by_light
        if name == AWARE
        else build_fixed_schedule(mission.duty.rest, asleep=name == DOZING)
    )


def build_perch_power_config(mission: MissionFile, scenes: MissionScene, seed: int) -> PerchConfig:
    """Return the configuration on the perch, with meter errors and slack drawn from the seed."""
    vehicle = scenes.vehicle
    meter = draw_meter_errors(
        # 219 (the meter is an INA219) only keeps this stream independent of other draws.
        PowerMeterSettings(),
        np.random.default_rng(np.random.SeedSequence([seed, 219])),
    )
    begin, end = mission.work.vector
    return PerchConfig(
        vehicle.battery, vehicle.charger, HarvestCurve.of_energy(vehicle.file.energy),
        vehicle.loads.idle,
        mission.asleep.si, (begin, end), mission.reserve.si, mission.charge.si,
        mission.fetched.si, find_brightest_light(vehicle, draw_slack(seed)),
        meter.current_gain, meter.current_offset,
    )  # fmt: skip


def initial_flight_estimate(mission: MissionFile, scenes: MissionScene) -> tuple[float, float]:
    """Return the assumed energy [J] and duration [s] of the first flight."""
    places = [scenes.lamp(name).position for name in (mission.perch, *mission.round)]
    way = sum(
        float(np.hypot(a[0] - b[0], a[1] - b[1]))
        # Closed tour: perch, beacons in order, and back to the perch
        for a, b in zip(places, [*places[1:], places[0]], strict=True)
    )
    speed = scenes.policy.mission.speed
    # Assumed: 20 s for start and landing, and 30 % detours. The first flight replaces the guess.
    lasts = 20.0 + 1.3 * way / speed + len(mission.round) * mission.dwell.si
    return ASSUMED_FLIGHT_POWER * lasts, lasts


def build_simulation(
    mission: MissionFile, day: LightDay, scenes: MissionScene, schedule: str, days: int, seed: int
) -> tuple[MissionSimulation, IrradianceSeries]:
    """Return a simulation before its start, and its light."""
    light = simulate_irradiance(day, days, seed)
    upkeep = build_perch_power_config(mission, scenes, seed)
    flyer = MissionFlyer(mission, scenes, light, seed, upkeep.gain, upkeep.offset)
    simulation = MissionSimulation(
        upkeep,
        light,
        build_schedule(schedule, mission),
        flyer.fly_round_trip,
        initial_flight_estimate(mission, scenes),
    )
    return simulation, light


SEARCH_TIME = 60.0  # s allowed for a leg, plus three times the direct flight at cruise speed
HOMEWARD = 900.0  # s allowed for the way back
FLIGHT_ENDINGS = {
    EMPTY: 'empty',
    ESCAPED: 'escaped',
    STOPPED: 'stopped',
    RESERVE: 'away',
    LATE: 'lost',
}
MOST_TRACKED_MISSION_FLIGHTS = 8  # first flights of a mission, whose motion is stored for the page
MOST_TRACK_ROWS = 2400  # poses of a flight, two in a second
BEACON_CLEARANCE = 0.3  # m from the lantern of the perch, so that it is in view at the start


@final
@dataclass(slots=True)
class OngoingFlight:
    """State of a flight in progress."""

    memory: LegState
    light: PanelIrradiance
    lux: float
    seed: int
    track: NDArray[np.float64]  # see `leg_state.fly_leg`; NaN where nothing was flown
    visits: int = 0

    def distance_to(self, x: float, y: float) -> float:
        """Return the horizontal distance to a place [m]."""
        return math.hypot(self.memory.flight.state[0] - x, self.memory.flight.state[1] - y)


def list_poses(track: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    """Return the rows of a track that were flown; those of a state that diverged are left out."""
    return tuple(map(tuple, track[np.isfinite(track).all(axis=1)].round(3).tolist()))


@final
class MissionFlyer:
    """
    Flies the flights of one mission.

    `scenes`: vehicle and scene. `light`: light over the days. `gain`, `offset`: errors of the
    current meter: factor, and offset in A.
    """

    def __init__(
        self,
        mission: MissionFile,
        scenes: MissionScene,
        light: IrradianceSeries,
        seed: int,
        gain: float = 1.0,
        offset: float = 0.0,
    ) -> None:
        self._mission, self._scenes, self._light, self._seed = mission, scenes, light, seed
        self._goal = build_goal(scenes.scenario)
        self._leg = LegPlan(GO, 1.0, mission.reserve.si, 0.0, gain, offset)
        flight = scenes.build_beacon_flight(mission.perch, light.at(0.0), 1.0)
        self._pilot = LegPilot(flight, self._leg)
        self._speed = scenes.policy.mission.speed

    def fly_round_trip(self, departure: Departure) -> Landing:
        """Fly the round and back."""
        going = self._start_flight(departure)
        outcome = self._fly_round(going)
        if outcome in (DONE, RESERVE, LATE):
            outcome = self._fly_home(going)
        # Half the reserve is reached or the perch is not found: land on the spot.
        if outcome in (RESERVE, LATE):
            self._fly_leg(going, self._mission.perch, self._leg._replace(kind=LAND, limit=60.0))
        memory, supply = going.memory, going.memory.flight.supply
        flight = MissionFlight(
            departure.time, memory.flight.step * self._pilot.period, going.visits, memory.path,
            EnergyTotals(supply.harvested, 0.0, supply.consumed, supply.lost),
            departure.store.charge, supply.flow.charge, memory.charge, memory.lowest,
            FLIGHT_ENDINGS.get(outcome, 'home'),
            list_poses(going.track),
        )  # fmt: skip
        return Landing(supply.flow, flight)

    def _start_flight(self, departure: Departure) -> OngoingFlight:
        """Place the drone near the perch's lantern, with a random heading."""
        # One independent 32-bit seed per flight of the mission
        seed = int(np.random.SeedSequence([self._seed, departure.number]).generate_state(1)[0])
        heading = 2.0 * math.pi * (seed / 2**32)
        x, y, _ = self._scenes.lamp(self._mission.perch).position
        z = self._scenes.vehicle.hull_height_on_floor
        memory = self._pilot.ground_state(
            (x + BEACON_CLEARANCE, y, z), heading, departure.store, departure.told, seed
        )
        light = departure.light
        sun, lamps, _ = self._light.efficacies
        rows = MOST_TRACK_ROWS if departure.number < MOST_TRACKED_MISSION_FLIGHTS else 0
        track = np.full((rows, 8), np.nan)
        return OngoingFlight(memory, light, light.sun * sun + light.lamps * lamps, seed, track)

    def _fly_round(self, going: OngoingFlight) -> int:
        """Fly to each beacon and dwell there; return the outcome."""
        mission = self._mission
        payload = mission.payload
        # The payload is on during the dwell only. [W]
        payload_power = payload.sensing.si + payload.radio.si if payload else 0.0
        for name in mission.round:
            outcome = self._fly_leg(
                going, name, self._leg._replace(limit=self._leg_time_limit(going, name))
            )
            if outcome != DONE:
                return outcome
            # The drone ends the leg where it believes to be at the beacon
            going.visits += self._is_at_lamp(going, name, self._goal.radius)
            if mission.dwell.si > 0.0:
                dwell = self._leg._replace(
                    kind=DWELL, limit=mission.dwell.si, payload=payload_power
                )
                outcome = self._fly_leg(going, name, dwell)
                if outcome != DONE:
                    return outcome
        return DONE

    def _fly_home(self, going: OngoingFlight) -> int:
        """Fly to the perch until the dock catches the drone; return the outcome."""
        perch, leg = self._mission.perch, self._leg
        left = HOMEWARD
        # Homing may report arrival outside the reach of the dock; then it approaches again.
        while left > 0.0:
            begun = going.memory.flight.step
            going_home = leg._replace(limit=left, reserve=0.5 * leg.reserve)
            outcome = self._fly_leg(going, perch, going_home)
            if outcome != DONE or self._is_at_lamp(going, perch, self._mission.dock.si):
                return outcome
            left -= (going.memory.flight.step - begun) * self._pilot.period
        return LATE

    def _is_at_lamp(self, going: OngoingFlight, name: str, radius: float) -> bool:
        """Return whether the drone is within a radius [m] of a beacon, and at its height."""
        x, y, z = going.memory.flight.state[:3]
        goal = self._goal._replace(radius=radius)
        return is_at_lamp(goal, self._scenes.lamp(name).position, x, y, z)

    def _leg_time_limit(self, going: OngoingFlight, name: str) -> float:
        """Return the time limit of a leg [s]."""
        x, y, _ = self._scenes.lamp(name).position
        return SEARCH_TIME + 3.0 * going.distance_to(x, y) / self._speed

    def _fly_leg(self, going: OngoingFlight, name: str, leg: LegPlan) -> int:
        """Fly one leg and return its outcome."""
        memory = going.memory
        beacon_flight = self._scenes.build_beacon_flight(name, going.light, going.lux)
        mission = memory.flight.mission
        if leg.kind == GO:
            # On the ground it has to climb first; dwelling and landing keep the lamp.
            phase = Phase.SEEK if mission.phase == Phase.ARRIVED else mission.phase
            mission = mission._replace(phase=phase, memory=HOMING_STRATEGY.onward(mission.memory))
        flight = memory.flight._replace(mission=mission)
        begin = memory._replace(flight=flight, outcome=FLYING, first_step=flight.step)
        constants = self._pilot.pack_constants(beacon_flight)
        going.memory = self._pilot.fly_leg(constants, leg, begin, going.seed, going.track)
        return going.memory.outcome
