"""Live a mission: its files, its light, its flights, one schedule and one seed."""

from typing import Final

from lta_config.schema.light_day_file import LightDay
from lta_config.schema.mission_file import MissionFile
from lta_energy.harvest import Harvest
from lta_energy.light_of_days import light_of, LightOfDays
from lta_energy.mission import Life, Upkeep
from lta_energy.schedule import by_light, fixed, Schedule
from lta_sim.sensors.power import draw, PowerMeterSettings
from lta_studies.mission.flyer import Flyer
from lta_studies.mission.scene import Scenes
import numpy as np

CRUISE: Final = 2.2  # W: what a flight is taken to draw before the first was flown
AWARE, NAIVE, DOZING = 'by light', 'duty cycle', 'duty cycle, asleep'


def schedule_of(name: str, mission: MissionFile) -> Schedule:
    """Return a schedule by its name."""
    return by_light if name == AWARE else fixed(mission.duty.rest, asleep=name == DOZING)


def upkeep_of(mission: MissionFile, scenes: Scenes, seed: int) -> Upkeep:
    """Return what is drawn and kept on the perch, with the meter that the seed draws."""
    vehicle = scenes.vehicle
    meter = draw(PowerMeterSettings(), np.random.default_rng(np.random.SeedSequence([seed, 219])))
    begin, end = mission.work.vector
    return Upkeep(
        vehicle.battery, vehicle.charger, Harvest(vehicle.panel), vehicle.loads.idle,
        mission.asleep.si, (begin, end), mission.reserve.si, mission.charge.si,
        mission.fetched.si, meter.current_gain, meter.current_offset,
    )  # fmt: skip


def guess_of(mission: MissionFile, scenes: Scenes) -> tuple[float, float]:
    """Return what the first flight is taken to need [J] and how long it is to last [s]."""
    places = [scenes.lamp(name).position for name in (mission.perch, *mission.round)]
    way = sum(
        float(np.hypot(a[0] - b[0], a[1] - b[1]))
        for a, b in zip(places, [*places[1:], places[0]], strict=True)
    )
    speed = scenes.policy.mission.speed
    lasts = 20.0 + 1.3 * way / speed + len(mission.round) * mission.dwell.si
    return CRUISE * lasts, lasts


def life_of(
    mission: MissionFile, day: LightDay, scenes: Scenes, schedule: str, days: int, seed: int
) -> tuple[Life, LightOfDays]:
    """Return a mission that is about to begin, and its light."""
    light = light_of(day, days, seed)
    upkeep = upkeep_of(mission, scenes, seed)
    flyer = Flyer(mission, scenes, light, seed, upkeep.gain, upkeep.offset)
    life = Life(
        upkeep, light, schedule_of(schedule, mission), flyer.fly, guess_of(mission, scenes)
    )
    return life, light
