# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly along a course and record motion and power at each control step."""

from collections.abc import Callable
from dataclasses import dataclass, replace
import math
from typing import final

from lta_config.topics import load_topic_table
from lta_control.motion import Setpoint, to_world, up_in_body
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec
from lta_model.electrical.loads import rotor_power
from lta_report.json_value import ExactArray
from lta_sim.world import World
import numpy as np

Course = Callable[[float], Setpoint]


def build_course(
    base: float, rise: float, begin: float, departure: float = math.inf, speed: float = 0.0
) -> Course:
    """
    Return the course of take-off, hover and straight flight.

    `base`, `rise`: height at the start, and how far to rise from it [m]. `begin`, `departure`:
    times of take-off and of the straight flight at `speed` [s, m/s].
    """

    def setpoint_at(time: float) -> Setpoint:
        height = base + (rise if time >= begin else 0.0)
        return Setpoint(height, 0.0, speed if time >= departure else 0.0)

    return setpoint_at


@final
@dataclass(frozen=True, slots=True)
class FlightTrack:
    """Recorded flight; every array has one value per control step."""

    time: ExactArray  # time since the start [s]
    height: ExactArray  # height of the hull centre [m]
    speed: ExactArray  # horizontal ground speed [m/s]
    pitch: ExactArray  # pitch, nose up positive [rad]
    rotors: ExactArray  # electrical power of all rotors [W]
    # Terminal voltage of the cell [V], and its state of charge [1]
    voltage: ExactArray
    charge: ExactArray

    def crop(self, begin: float, end: float) -> 'FlightTrack':
        """Return the part of the flight in [begin, end) [s]."""
        # 1e-9 s absorbs rounding of the accumulated time.
        keep = (self.time >= begin - 1e-9) & (self.time < end - 1e-9)
        return FlightTrack(*(getattr(self, name)[keep] for name in self.__slots__))


def build_closed_loop(spec: FlightSpec, course: Course | None, seed: int) -> ClosedLoop:
    """Return the closed loop along a course, or with its own strategy if that is None."""
    vehicle, scenario, policy = build_vehicle_scenario_stack(spec)
    table = load_topic_table()
    # The light board draws power only while a strategy uses it.
    looking = spec.strategy if course is None else ''
    world = World(vehicle, scenario, table, seed, looking)
    return ClosedLoop(world, table, replace(policy, course=course))


def fly_until(loop: ClosedLoop, until: Callable[[ClosedLoop], bool]) -> FlightTrack:
    """Fly until a condition holds and return the recorded flight."""
    world, rows = loop.world, []
    loads = world.vehicle.loads
    for _ in loop.iterate_until(lambda: until(loop)):
        state = world.state.tolist()
        quaternion = (state[3], state[4], state[5], state[6])
        u, v, _ = to_world(quaternion, (state[7], state[8], state[9]))
        power = sum(
            rotor_power(thrust, loads.rotor_offset, loads.rotor_slope) for thrust in world.thrusts
        )
        rows.append(
            (world.elapsed, state[2], math.hypot(u, v), pitch_angle(quaternion), power,
             world.supply.cell_voltage_and_current[0], world.charge)
        )  # fmt: skip
    # The copy makes each column contiguous.
    return FlightTrack(*np.array(rows).T.copy())


def pitch_angle(quaternion: tuple[float, float, float, float]) -> float:
    """Return the pitch, nose up positive [rad]."""
    # x component of the world's up axis in the body frame, clamped against rounding
    return math.asin(max(-1.0, min(1.0, up_in_body(quaternion)[0])))


def stop_after(seconds: float) -> Callable[[ClosedLoop], bool]:
    """Return a condition that ends a flight after a time [s]."""
    return lambda loop: loop.world.elapsed >= seconds - 1e-9
