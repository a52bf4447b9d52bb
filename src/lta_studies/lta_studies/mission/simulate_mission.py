"""Build the simulation of a mission for one schedule and one seed."""

from typing import Final

from lta_config.schema.mission_file import LightDay, MissionFile
from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import IrradianceSeries, simulate_irradiance
from lta_energy.mission import MissionSimulation, PerchConfig
from lta_energy.schedule import build_fixed_schedule, Schedule, schedule_by_light
from lta_sim.power_meter import draw_errors, PowerMeterSettings
from lta_studies.mission.flyer import MissionFlyer
from lta_studies.mission.gas import draw_slack, find_brightest_light
from lta_studies.mission.scene import MissionScene
import numpy as np

CRUISE: Final = 2.2  # W, assumed flight power before the first flight
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
    meter = draw_errors(
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
    return CRUISE * lasts, lasts


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
