"""Flights in which something is hidden: flown in process, with dither, seen by a noisy tracker."""

from collections.abc import Mapping
from dataclasses import replace

from lta_config.topics import load_topic_table
from lta_control.cascade import Setpoint
from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.model.quaternions import (
    quaternion_exponential,
    quaternion_product,
    rotation_matrix,
)
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim.scene_model import build_scene_model
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

from .unknown_physics import Kind, Seen

Array = NDArray[np.float64]
POSE_NOISE, TURN_NOISE = 1e-3, 2.5e-3  # m, rad: a tracker of passive markers


def course(seed: int, turn: float = 0.0) -> dict[int, Setpoint]:
    """Return setpoints that change every 8 s: climbs, turns, speeds; round and round by `turn`."""
    rng = np.random.default_rng([seed, 7])
    heading, out = 0.0, {}
    for k in range(64):
        heading += rng.uniform(-2.0, 2.0) if turn == 0.0 else turn + rng.uniform(-0.4, 0.4)
        out[k] = Setpoint(rng.uniform(1.0, 2.0), heading, rng.choice([0.0, 0.3, 0.6]))
    return out


def world_of(
    changes: Mapping[str, object], seed: int, turn: float = 0.0
) -> tuple[World, ClosedLoop]:
    """Return a GT-MAB in a great empty hall, with changes to its file."""
    made = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    scene = {
        'scenario.room.size': {'value': [60.0, 60.0, 12.0], 'unit': 'm'},
        'scenario.start.position': {'value': [0.0, 0.0], 'unit': 'm'},
    }
    made = made.with_values({**scene, **changes})
    vehicle, scenario, policy = build_vehicle_scenario_stack(made)
    table = load_topic_table()
    plan = course(seed, turn)
    policy = replace(policy, course=lambda t: plan[int(t // 8.0)])
    world = World(vehicle, scenario, table, seed)
    known = Vehicle(
        build_vehicle_scenario_stack(load_spec('gtmab', 'lamp_room', 'bag', 'gtmab'))[0].file
    )
    return world, ClosedLoop(world, table, policy, known)


class Pushed:
    """A world in which something pushes, half before a period and half after it."""

    def __init__(self, world: World, kind: Kind | None) -> None:
        self.world, self.kind = world, kind
        model = build_scene_model(world.vehicle, world.scenario)
        self._inverse = np.array(model.inverse).reshape(6, 6)
        self._arm = np.array(world.vehicle.file.sensors.imu_position.vector)
        self._before = world.state[7:13].copy()
        self._period = load_topic_table().control_ns * 1e-9
        self.felt = np.zeros(3)  # by the accelerometer, m/s2

    def advance(self, duties: Array) -> None:
        """Fly one control period."""
        if self.kind is None:
            self.world.advance(duties.tolist())
            return
        state, period = self.world.state, self._period
        change = (state[7:13] - self._before) / period
        self._before = state[7:13].copy()
        seen = Seen(
            self.world.elapsed, state[:3].copy(), rotation_matrix(state[3:7]), state[7:10].copy(),
            state[10:13].copy(), change, duties, period,
        )  # fmt: skip
        answer = self._inverse @ self.kind(seen)
        self.felt = answer[:3] + np.cross(answer[3:], self._arm)
        state[7:13] += 0.5 * period * answer
        self.world.advance(duties.tolist())
        state[7:13] += 0.5 * period * answer


def flown(
    changes: Mapping[str, object],
    seed: int,
    length: float = 60.0,
    kind: Kind | None = None,
    turn: float = 0.0,
) -> FlightStreams:
    """Fly and return what is recorded; `kind` pushes as no effect does."""
    world, loop = world_of(changes, seed, turn)
    pushed = Pushed(world, kind)
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
        force.append((now, *(np.array(told.force) + pushed.felt)))
        for stamp, distance in told.ranges:
            ranges.append((now + (stamp - told.stamp_ns) * 1e-9, distance))
        if told.pressure is not None:
            pressure.append((now, told.pressure))
        if told.battery is not None:
            volts.append((now, told.battery[0]))
        commands.append((now, *duties))
        pushed.advance(duties)
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
