"""
One flight of a mission: round the beacons and home, leg by leg, on the compiled model.

The drone turns home when its own count of the charge comes to the reserve or a beacon is not found
in time, and lands where it is at half of the reserve. At home a dock catches it: whoever passes
the perch within its reach is home.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.mission_file import MissionFile
from lta_control.strategies.homing import reset_for_next_lamp
from lta_energy.circuit import EnergyTotals
from lta_energy.irradiance import IrradianceSeries, PanelIrradiance
from lta_energy.mission import Departure, Landing
from lta_energy.mission_log import MissionFlight
from lta_studies.mission.leg_state import (
    DONE,
    DWELL,
    EMPTY,
    ESCAPED,
    FLYING,
    GO,
    ground_leg_state,
    initial_leg_state,
    LAND,
    LATE,
    LegPlan,
    LegState,
    RESERVE,
    STOPPED,
)
from lta_studies.mission.legs import Array, LegPilot
from lta_studies.mission.scene import MissionScene
import numpy as np

SEARCH = 60.0  # s allowed for a leg beyond three times its straight way at cruise speed
HOMEWARD = 900.0  # s: whoever cannot find home seeks it while the charge lasts
ENDINGS = {EMPTY: 'empty', ESCAPED: 'escaped', STOPPED: 'stopped', RESERVE: 'away', LATE: 'lost'}
BESIDE = 0.3  # m beside its lantern, so that the drone sees it as it stands


@final
@dataclass(slots=True)
class OngoingFlight:
    """A flight under way."""

    memory: LegState
    state: Array
    light: PanelIrradiance
    lux: float
    seed: int
    visits: int = 0

    def distance_to(self, x: float, y: float) -> float:
        """Return the horizontal distance to a place. [m]"""
        return math.hypot(float(self.state[0]) - x, float(self.state[1]) - y)


@final
class MissionFlyer:
    """
    Flies the flights of one mission.

    Parameters
    ----------
    mission : MissionFile
        The mission.
    scenes : Scenes
        What it flies in.
    light : LightOfDays
        Over the days.
    seed : int
        Of all chance.
    gain, offset : float
        Errors of the current's meter: factor, and A.

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
        length, width, height = scenes.scenario.room.size.vector
        self._leg = LegPlan(
            GO, 1.0, mission.reserve.si, 0.0, gain, offset, length / 2, width / 2, height
        )
        made = scenes.build_flight(mission.perch, light.at(0.0), 1.0)
        self._pilot = LegPilot(made, self._leg)
        self._speed = scenes.policy.mission.speed

    def compile_kernel(self) -> None:
        """Have compiled what flies, which takes up to a minute where it is not kept on disk."""
        made = self._scenes.build_flight(self._mission.perch, self._light.at(0.0), 1.0)
        over = initial_leg_state(1.0, 1.0)._replace(outcome=DONE)
        state = self._pilot.ground_state(0.0, 0.0, 0.0, 0.0, 0)
        self._pilot.fly_leg(self._pilot.pack_constants(made), self._leg, over, state, 0)

    def fly_mission(self, departure: Departure) -> Landing:
        """Fly the round and home."""
        going = self._start_flight(departure)
        outcome = self._fly_round(going)
        if outcome in (DONE, RESERVE, LATE):
            outcome = self._fly_home(going)
        if outcome in (RESERVE, LATE):
            self._fly_leg(going, self._mission.perch, self._leg._replace(kind=LAND, limit=60.0))
        memory, supply = going.memory, going.memory.supply
        flight = MissionFlight(
            departure.time, memory.step * 0.01, going.visits, memory.path,
            EnergyTotals(supply.harvested, 0.0, supply.consumed, supply.lost),
            departure.store.charge, supply.flow.charge, memory.charge, memory.lowest,
            ENDINGS.get(outcome, 'home'),
        )  # fmt: skip
        return Landing(supply.flow, flight)

    def _start_flight(self, departure: Departure) -> OngoingFlight:
        """Return a drone beside its lantern, its nose wherever the seed points it."""
        seed = int(np.random.SeedSequence([self._seed, departure.number]).generate_state(1)[0])
        heading = 2.0 * math.pi * (seed / 2**32)
        x, y, _ = self._scenes.lamp(self._mission.perch).position
        z = self._scenes.vehicle.height_on_floor
        state = self._pilot.ground_state(x + BESIDE, y, z, heading, seed)
        memory = ground_leg_state(departure.store, departure.told)
        light = departure.light
        sun, lamps, _ = self._light.efficacies
        return OngoingFlight(memory, state, light, light.sun * sun + light.lamps * lamps, seed)

    def _fly_round(self, going: OngoingFlight) -> int:
        """Fly to each beacon and dwell there; return how that ended."""
        mission = self._mission
        payload = mission.payload
        drawn = payload.sensing.si + payload.radio.si if payload else 0.0
        for name in mission.round:
            outcome = self._fly_leg(
                going, name, self._leg._replace(limit=self._leg_time_limit(going, name))
            )
            if outcome != DONE:
                return outcome
            going.visits += 1
            if mission.dwell.si > 0.0:
                dwell = self._leg._replace(kind=DWELL, limit=mission.dwell.si, payload=drawn)
                outcome = self._fly_leg(going, name, dwell)
                if outcome != DONE:
                    return outcome
        return DONE

    def _fly_home(self, going: OngoingFlight) -> int:
        """Fly to the perch until the dock catches the drone; return how that ended."""
        perch, leg = self._mission.perch, self._leg
        x, y, _ = self._scenes.lamp(perch).position
        left = HOMEWARD
        while left > 0.0:
            begun = going.memory.step
            going_home = leg._replace(limit=left, reserve=0.5 * leg.reserve)
            outcome = self._fly_leg(going, perch, going_home)
            if outcome != DONE or going.distance_to(x, y) <= self._mission.dock.si:
                return outcome
            left -= (going.memory.step - begun) * 0.01
        return LATE

    def _leg_time_limit(self, going: OngoingFlight, name: str) -> float:
        """Return how long a leg may last. [s]"""
        x, y, _ = self._scenes.lamp(name).position
        return SEARCH + 3.0 * going.distance_to(x, y) / self._speed

    def _fly_leg(self, going: OngoingFlight, name: str, leg: LegPlan) -> int:
        """Fly one leg; return its outcome."""
        memory = going.memory
        made = self._scenes.build_flight(name, going.light, going.lux)
        homing = reset_for_next_lamp(memory.homing) if leg.kind == GO else memory.homing
        begin = memory._replace(outcome=FLYING, begun=memory.step, homing=homing)
        going.memory, going.state = self._pilot.fly_leg(
            self._pilot.pack_constants(made), leg, begin, going.state, going.seed
        )
        return going.memory.outcome
