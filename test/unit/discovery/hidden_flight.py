# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Flights in which something is hidden: flown in process, with dither, seen by a noisy tracker."""

from collections.abc import Mapping
from dataclasses import replace

from lta_config.topics import load_topic_table
from lta_control.motion import Setpoint
from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.model.quaternions import (
    quaternion_exponential,
    quaternion_product,
)
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
POSE_NOISE, TURN_NOISE = 1e-3, 2.5e-3  # m, rad: a tracker of passive markers


def course(seed: int) -> dict[int, Setpoint]:
    """Return setpoints that change every 8 s: climbs, turns, speeds."""
    rng = np.random.default_rng([seed, 7])
    heading, out = 0.0, {}
    for k in range(64):
        heading += rng.uniform(-2.0, 2.0)
        out[k] = Setpoint(rng.uniform(1.0, 2.0), heading, rng.choice([0.0, 0.3, 0.6]))
    return out


def world_of(changes: Mapping[str, object], seed: int) -> tuple[World, ClosedLoop]:
    """Return a GT-MAB in a great empty hall, with changes to its file."""
    made = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    scene = {
        'scenario.room.size': {'value': [60.0, 60.0, 12.0], 'unit': 'm'},
        'scenario.start.position': {'value': [0.0, 0.0], 'unit': 'm'},
    }
    made = made.with_values({**scene, **changes})
    vehicle, scenario, policy = build_vehicle_scenario_stack(made)
    table = load_topic_table()
    plan = course(seed)
    policy = replace(policy, course=lambda t: plan[int(t // 8.0)])
    world = World(vehicle, scenario, table, seed)
    known = Vehicle(
        build_vehicle_scenario_stack(load_spec('gtmab', 'lamp_room', 'bag', 'gtmab'))[0].file
    )
    return world, ClosedLoop(world, table, policy, known)


def flown(
    changes: Mapping[str, object],
    seed: int,
    length: float = 60.0,
) -> FlightStreams:
    """Fly and return what is recorded."""
    world, loop = world_of(changes, seed)
    rng = np.random.default_rng([seed, 9])
    rotors = len(world.vehicle.reversible)
    until, dither = 0.0, np.zeros(rotors)
    pose, rates, force, ranges, pressure, volts, commands = [], [], [], [], [], [], []
    while world.elapsed < length:
        loop.decide()
        told, now = loop.readings, world.elapsed
        assert told.truth is not None
        if now >= until:
            until = now + rng.uniform(0.4, 1.2)
            dither = rng.uniform(-0.25, 0.25, rotors) if now > 4.0 else np.zeros(rotors)
        duties = np.clip(np.array(loop.duties) + dither, 0.0, 1.0)
        pose.append((now, *told.truth[:7]))
        rates.append((now, *told.rates))
        force.append((now, *told.force))
        for stamp, distance in told.ranges:
            ranges.append((now + (stamp - told.stamp_ns) * 1e-9, distance))
        if told.pressure is not None:
            pressure.append((now, told.pressure))
        if told.battery is not None:
            volts.append((now, told.battery[0]))
        commands.append((now, *duties))
        world.advance(duties.tolist())
    seen = _stream(pose)
    values = seen.values
    values[:, :3] += POSE_NOISE * rng.standard_normal((len(values), 3))
    wobble = quaternion_exponential(TURN_NOISE * rng.standard_normal((len(values), 3)))
    values[:, 3:] = quaternion_product(values[:, 3:], wobble)
    others = {
        'rates': _stream(rates), 'force': _stream(force), 'range': _stream(ranges),
        'pressure': _stream(pressure), 'voltage': _stream(volts),
    }  # fmt: skip
    return FlightStreams(seen, _stream(commands), others, floor=0.47)


def nominal() -> tuple[NominalVehicle, list[FreeParameter]]:
    """Return the GT-MAB as its file has it, and its knobs."""
    vehicle = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    return vehicle, list_free_parameters(vehicle)


def _stream(rows: list[tuple[float, ...]]) -> Stream:
    table = np.array(rows)
    return Stream(table[:, 0], table[:, 1:])
