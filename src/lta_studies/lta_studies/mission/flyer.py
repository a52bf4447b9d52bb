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
from lta_control.strategies.homing import onward
from lta_energy.circuit import Spent
from lta_energy.diary import Flight
from lta_energy.light_of_days import Light, LightOfDays
from lta_energy.mission import Departure, Landing
from lta_studies.mission.aloft import (
    Aloft,
    at_rest,
    DONE,
    DWELL,
    EMPTY,
    ESCAPED,
    FLYING,
    GO,
    LAND,
    LATE,
    Leg,
    RESERVE,
    standing,
    STOPPED,
)
from lta_studies.mission.legs import Array, Pilot
from lta_studies.mission.scene import Scenes
import numpy as np

SEARCH = 60.0  # s allowed for a leg beyond three times its straight way at cruise speed
HOMEWARD = 900.0  # s: whoever cannot find home seeks it while the charge lasts
ENDINGS = {EMPTY: 'empty', ESCAPED: 'escaped', STOPPED: 'stopped', RESERVE: 'away', LATE: 'lost'}
BESIDE = 0.3  # m beside its lantern, so that the drone sees it as it stands


@final
@dataclass(slots=True)
class Going:
    """A flight under way."""

    memory: Aloft
    state: Array
    light: Light
    lux: float
    seed: int
    visits: int = 0

    def away(self, x: float, y: float) -> float:
        """Return the horizontal distance to a place. [m]"""
        return math.hypot(float(self.state[0]) - x, float(self.state[1]) - y)


@final
class Flyer:
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
        scenes: Scenes,
        light: LightOfDays,
        seed: int,
        gain: float = 1.0,
        offset: float = 0.0,
    ) -> None:
        self._mission, self._scenes, self._light, self._seed = mission, scenes, light, seed
        length, width, height = scenes.scenario.room.size.vector
        self._leg = Leg(
            GO, 1.0, mission.reserve.si, 0.0, gain, offset, length / 2, width / 2, height
        )
        made = scenes.made(mission.perch, light.at(0.0), 1.0)
        self._pilot = Pilot(made, self._leg)
        self._speed = scenes.policy.mission.speed

    def compile(self) -> None:
        """Have compiled what flies, which takes up to a minute where it is not kept on disk."""
        made = self._scenes.made(self._mission.perch, self._light.at(0.0), 1.0)
        over = at_rest(1.0, 1.0)._replace(outcome=DONE)
        state = self._pilot.standing(0.0, 0.0, 0.0, 0.0, 0)
        self._pilot.fly(self._pilot.constants(made), self._leg, over, state, 0)

    def fly(self, departure: Departure) -> Landing:
        """Fly the round and home."""
        going = self._begin(departure)
        outcome = self._round(going)
        if outcome in (DONE, RESERVE, LATE):
            outcome = self._home(going)
        if outcome in (RESERVE, LATE):
            self._fly(going, self._mission.perch, self._leg._replace(kind=LAND, limit=60.0))
        memory, supply = going.memory, going.memory.supply
        flight = Flight(
            departure.time, memory.step * 0.01, going.visits, memory.path,
            Spent(supply.harvested, 0.0, supply.consumed, supply.lost), departure.store.charge,
            supply.flow.charge, memory.charge, memory.lowest, ENDINGS.get(outcome, 'home'),
        )  # fmt: skip
        return Landing(supply.flow, flight)

    def _begin(self, departure: Departure) -> Going:
        """Return a drone beside its lantern, its nose wherever the seed points it."""
        seed = int(np.random.SeedSequence([self._seed, departure.number]).generate_state(1)[0])
        heading = 2.0 * math.pi * (seed / 2**32)
        x, y, _ = self._scenes.lamp(self._mission.perch).position
        z = self._scenes.vehicle.standing_height
        state = self._pilot.standing(x + BESIDE, y, z, heading, seed)
        memory = standing(departure.store, departure.told)
        light = departure.light
        sun, lamps, _ = self._light.efficacies
        return Going(memory, state, light, light.sun * sun + light.lamps * lamps, seed)

    def _round(self, going: Going) -> int:
        """Fly to each beacon and dwell there; return how that ended."""
        mission = self._mission
        payload = mission.payload
        drawn = payload.sensing.si + payload.radio.si if payload else 0.0
        for name in mission.round:
            outcome = self._fly(going, name, self._leg._replace(limit=self._limit(going, name)))
            if outcome != DONE:
                return outcome
            going.visits += 1
            if mission.dwell.si > 0.0:
                dwell = self._leg._replace(kind=DWELL, limit=mission.dwell.si, payload=drawn)
                outcome = self._fly(going, name, dwell)
                if outcome != DONE:
                    return outcome
        return DONE

    def _home(self, going: Going) -> int:
        """Fly to the perch until the dock catches the drone; return how that ended."""
        perch, leg = self._mission.perch, self._leg
        x, y, _ = self._scenes.lamp(perch).position
        left = HOMEWARD
        while left > 0.0:
            begun = going.memory.step
            going_home = leg._replace(limit=left, reserve=0.5 * leg.reserve)
            outcome = self._fly(going, perch, going_home)
            if outcome != DONE or going.away(x, y) <= self._mission.dock.si:
                return outcome
            left -= (going.memory.step - begun) * 0.01
        return LATE

    def _limit(self, going: Going, name: str) -> float:
        """Return how long a leg may last. [s]"""
        x, y, _ = self._scenes.lamp(name).position
        return SEARCH + 3.0 * going.away(x, y) / self._speed

    def _fly(self, going: Going, name: str, leg: Leg) -> int:
        """Fly one leg; return its outcome."""
        memory = going.memory
        made = self._scenes.made(name, going.light, going.lux)
        homing = onward(memory.homing) if leg.kind == GO else memory.homing
        begin = memory._replace(outcome=FLYING, begun=memory.step, homing=homing)
        going.memory, going.state = self._pilot.fly(
            self._pilot.constants(made), leg, begin, going.state, going.seed
        )
        return going.memory.outcome
