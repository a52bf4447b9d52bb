# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Validate compiled legs against the full loop with the same vehicle, scene, start and charge.

Each flight lasts from rest until homing reports its arrival, once as a compiled leg and once in
`lta_flight.closed_loop` with ADC blocks. Their noise differs, so medians over some seeds are
compared.
"""

from collections.abc import Iterator
from dataclasses import replace
import math
from typing import NamedTuple

from lta_config.quantity import Quantity
from lta_config.topics import load_topic_table
from lta_control.mission import Phase
from lta_energy.irradiance import NO_IRRADIANCE
from lta_flight.closed_loop import ClosedLoop
from lta_model.electrical.mppt_charger import resting_flow
from lta_sim.world import World
from lta_studies.mission.leg_state import GO, LegPlan
from lta_studies.mission.legs import Array, LegPilot
from lta_studies.mission.scene import MissionScene
import numpy as np

LIMIT = 200.0  # s, of a flight


class LegStart(NamedTuple):
    """Start position [m], heading [rad] and state of charge [1]."""

    x: float
    y: float
    heading: float
    charge: float


def iterate_starts(count: int, lamp: tuple[float, float, float]) -> Iterator[LegStart]:
    """Yield starts 3 to 8 m from the lamp, in all directions."""
    for k in range(count):
        # Multiples of irrational numbers modulo 1 spread evenly for any count.
        # 0.618 is the golden ratio - 1, and 0.414 is sqrt(2) - 1.
        away, side = 3.0 + 5.0 * ((k * 0.618) % 1.0), 2.0 * math.pi * ((k * 0.414) % 1.0)
        x, y = lamp[0] + away * math.cos(side), lamp[1] + away * math.sin(side)
        # Towards the lamp, within 0.5 rad
        heading = side + math.pi + 0.5 * math.sin(2.0 * k)
        yield LegStart(x, y, heading, 0.4 + 0.55 * ((k * 0.733) % 1.0))


def measure_leg(
    scenes: MissionScene, beacon: str, start: LegStart, seed: int
) -> tuple[float, float]:
    """Return the energy consumed [J] and the time [s] of a compiled leg."""
    made = scenes.build_beacon_flight(beacon, NO_IRRADIANCE, 1.0)
    leg = LegPlan(GO, LIMIT, 0.0, 0.0, 1.0, 0.0)
    pilot = LegPilot(made, leg)
    place = (start.x, start.y, scenes.vehicle.hull_height_on_floor)
    store = resting_flow(start.charge)
    ground = pilot.ground_state(place, start.heading, store, start.charge, seed)
    flight = pilot.fly_leg(pilot.pack_constants(made), leg, ground, seed).flight
    return flight.supply.consumed, flight.step * pilot.period


def build_full_loop(scenes: MissionScene, beacon: str, start: LegStart, seed: int) -> ClosedLoop:
    """Build the full loop of the same flight."""
    begin = scenes.scenario.start.model_copy(
        update={
            'position': Quantity(value=(start.x, start.y), unit='m'),
            'heading': Quantity(value=start.heading, unit='rad'),
            'heading_spread': Quantity(value=0.0, unit='rad'),
            'charge': Quantity(value=start.charge, unit='1'),
        }
    )
    lamp, policy = scenes.scenario.lamps[beacon], scenes.policy
    scene = scenes.scenario.model_copy(
        update={'several': {beacon: lamp}, 'alone': None, 'route': (), 'start': begin}
    )
    # The leg homes on the brightness of this beacon; give the full loop the same one.
    known = scenes.build_beacon_flight(beacon, NO_IRRADIANCE, 1.0).craft.mission.homing.brightness
    homing = policy.mission.homing.model_copy(update={'brightness': known})
    policy = replace(
        policy,
        mission=policy.mission.model_copy(update={'homing': homing}),
        demodulation=policy.demodulation.model_copy(update={'frequency': lamp.frequency.si}),
        # Without a reserve the loop does not return early, like the leg.
        energy=policy.energy.model_copy(update={'reserve': 0.0, 'hysteresis': 0.0}),
    )
    world = World(scenes.vehicle, scene, load_topic_table(), seed, policy.strategy.name)
    return ClosedLoop(world, load_topic_table(), policy)


def measure_loop(
    scenes: MissionScene, beacon: str, start: LegStart, seed: int
) -> tuple[float, float]:
    """Return the energy [J] and the time [s] of the full loop."""
    loop = build_full_loop(scenes, beacon, start, seed)
    while loop.mission.phase is not Phase.ARRIVED and loop.world.elapsed < LIMIT:
        loop.step()
    return loop.world.supply.energy_totals.consumed, loop.world.elapsed


def compare_leg_with_loop(
    scenes: MissionScene, beacon: str, count: int, seeds: int
) -> Iterator[tuple[LegStart, Array, Array]]:
    """Yield the start, and energy and time of leg and loop, each of shape (seeds, 2)."""
    for start in iterate_starts(count, scenes.lamp(beacon).position):
        yield (
            start,
            # Column 0 is the energy [J], column 1 the time [s].
            np.array([measure_leg(scenes, beacon, start, seed) for seed in range(seeds)]),
            np.array([measure_loop(scenes, beacon, start, seed) for seed in range(seeds)]),
        )
