# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate a flight in process and return what a recording would hold.

A tracker of passive markers measures the pose.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final, Literal

from lta_config.topics import load_topic_table
from lta_discovery.flights.measured_flight import (
    FlightStreams,
    MeasuredFlight,
    resample_flight,
    Stream,
)
from lta_discovery.lab_tests.rehearsal import POSE_NOISE, TURN_NOISE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
from lta_discovery.replay.replay import FlightReplay
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import FlightSpec
from lta_flight.flight_stack import FlightStack
from lta_model.effects.commands import find_command, WRENCH_GAIN
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Sensors = Literal['all', 'imu', 'pose', 'wrench']

CLEAR: Final = 0.05  # m above the standing height; below it the vehicle may touch the floor
KEPT: Final[dict[str, tuple[str, ...]]] = {
    'all': ('rates', 'force', 'range', 'pressure', 'voltage'),
    'imu': ('rates', 'force'),
    'pose': (),
    'wrench': (),
}


def with_course(spec: FlightSpec, course: Mapping[str, Any], length: float) -> FlightSpec:
    """Return a flight specification with a course and a time limit [s]."""
    scene = spec.contents['scenario']
    goal = {**scene['goal'], 'time_limit': {'value': length, 'unit': 's'}}
    scene = {**scene, 'goal': goal, 'course': course}
    return replace(spec, contents={**spec.contents, 'scenario': scene})


def simulate_flight(
    vehicle: Vehicle, scenario: Scenario, policy: FlightStack, seed: int
) -> FlightStreams:
    """Simulate a flight in this process, whose controller has the true vehicle file."""
    table = load_topic_table()
    world = World(vehicle, scenario, table, seed)
    loop = ClosedLoop(world, table, policy, Vehicle(vehicle.file))
    rows: dict[str, list[tuple[float, ...]]] = {
        name: [] for name in ('pose', 'commands', *KEPT['all'])
    }
    for outcome in loop.iterate_steps():
        if outcome is not FlightOutcome.FLYING:
            break
        _record_step(loop, rows)
    streams = {name: _build_stream(samples) for name, samples in rows.items() if samples}
    pose, commands = streams.pop('pose'), streams.pop('commands')
    seen = _add_tracker_noise(pose, np.random.default_rng([seed, 9]))
    return FlightStreams(seen, commands, streams, vehicle.hull_height_on_floor + CLEAR)


def _record_step(loop: ClosedLoop, rows: dict[str, list[tuple[float, ...]]]) -> None:
    readings, now = loop.readings, loop.world.elapsed
    if readings.truth is not None:
        rows['pose'].append((now, *readings.truth[:7]))
    rows['rates'].append((now, *readings.rates))
    rows['force'].append((now, *readings.force))
    for stamp, distance in readings.ranges:
        # The rangefinder has its own stamps: convert to the time of the loop
        rows['range'].append((now + (stamp - readings.stamp_ns) * 1e-9, distance))
    if readings.pressure is not None:
        rows['pressure'].append((now, readings.pressure))
    if readings.battery is not None:
        rows['voltage'].append((now, readings.battery[0]))
    rows['commands'].append((now, *loop.duties))


def _build_stream(rows: list[tuple[float, ...]]) -> Stream:
    table = np.array(rows)
    return Stream(table[:, 0], table[:, 1:])


def _add_tracker_noise(pose: Stream, rng: np.random.Generator) -> Stream:
    values = pose.values.copy()
    values[:, :3] += POSE_NOISE * rng.standard_normal((len(values), 3))
    # Small random rotation in the body frame
    wobble = quaternion_exponential(TURN_NOISE * rng.standard_normal((len(values), 3)))
    values[:, 3:] = quaternion_product(values[:, 3:], wobble)
    return Stream(pose.time, values)


def select_sensors(streams: FlightStreams, sensors: Sensors) -> FlightStreams:
    """Return a recording with the pose and the readings of some sensors."""
    others = {name: streams.others[name] for name in KEPT[sensors] if name in streams.others}
    return replace(streams, others=others)


def measure_rehearsal(
    streams: FlightStreams, vehicle: Vehicle, sensors: Sensors = 'all'
) -> MeasuredFlight:
    """
    Return a simulated flight as a recording of it would be read.

    For `wrench` data, the command is the rotor wrench by the gains of the vehicle file, and the
    duties are unknown.
    """
    streams = select_sensors(streams, sensors)
    flight = resample_flight(streams)
    if sensors != 'wrench':
        return flight
    nominal = NominalVehicle.from_vehicle(vehicle)
    wrench = _rotor_wrench(vehicle, flight, nominal)
    law = [nominal.parameter_value('wrench_gain', one.name) for one in WRENCH_GAIN.parameters]
    # An axis without a gain shows nothing, whatever was commanded
    commands = find_command(tuple(law), tuple(wrench.values.T))
    wrench = replace(wrench, values=np.stack(commands, axis=-1))
    silent = Stream(streams.commands.time[:1], 0.0 * streams.commands.values[:1])
    return replace(flight, commands=silent, wrench=wrench)


def _rotor_wrench(vehicle: Vehicle, flight: MeasuredFlight, nominal: NominalVehicle) -> Stream:
    """Return force and moment of the rotors about the hull centre, body frame."""
    replay = FlightReplay(flight, np.zeros(1, dtype=np.int64), 1, vehicle.pack_command(()))
    thrusts = replay.mean_thrusts(nominal.build_replay_rows())
    each = [np.concatenate([axis, np.cross(place, axis)]) for place, axis in nominal.rotors]
    time = flight.time[0] + replay.dt * np.arange(len(thrusts))
    return Stream(time, thrusts[:, : len(each)] @ np.array(each))
