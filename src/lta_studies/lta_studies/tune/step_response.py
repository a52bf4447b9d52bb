# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly the step test that gains are rated by: take-off, then altitude, heading and speed steps.

Setpoints are prescribed, so the light link is not used. The drone assumes the vehicle of its file;
the true one has lost lift (`net_lift`), like after a helium loss.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final, Literal, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import parse_quantity, replace_parameter
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.topics import load_topic_table
from lta_control.laws.cascade import CascadeGains
from lta_control.motion import Setpoint
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_model.scenario import load_scenario, Scenario
from lta_model.state import QUATERNION, VELOCITY
from lta_model.vehicle import Vehicle
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Channel = Literal['altitude', 'heading', 'speed', 'course']

TUNING_SCENARIO = 'lamp_room'  # only its air matters
NET_LIFT_PATH = 'effects.net_lift.force'
SAMPLING_PERIODS = 5  # control periods per recorded sample


class SetpointStep(NamedTuple):
    """A setpoint step in one channel, with times in s and values in m, rad or m/s."""

    start: float
    end: float
    channel: Channel
    before: float
    after: float


# A turn at speed is rated by the course: the nose points against the drift on purpose.
# The first 12 s are rest and take-off. Steps are small enough to stay in a room, and long enough
# for a well-tuned vehicle to settle before the next.
SETPOINT_STEPS = (
    SetpointStep(12.0, 20.0, 'altitude', 1.0, 1.4),
    SetpointStep(20.0, 30.0, 'altitude', 1.4, 1.0),
    SetpointStep(30.0, 38.0, 'heading', 0.0, 0.5 * math.pi),
    SetpointStep(38.0, 48.0, 'speed', 0.0, 0.4),
    SetpointStep(48.0, 60.0, 'course', 0.5 * math.pi, 0.0),
)
TAKE_OFF_TIME = 2.1  # s; the bias calibration has ended by then
FLYING_ALTITUDE = 1.0  # m


@final
@dataclass(frozen=True, slots=True)
class TuningCase:
    """Conditions of one test flight: lift lost [kg] and random seed."""

    loss: float
    seed: int


@final
@dataclass(frozen=True, slots=True)
class TuningScene:
    """The vehicle (name or file) and the scenario of all test flights."""

    vehicle: str

    def build_true_vehicle(self, loss: float) -> Vehicle:
        """Return the vehicle with a loss of lift [kg]; a negative loss adds lift."""
        content = load_yaml(find_file('vehicle', self.vehicle))
        if loss:
            own = content.get('effects', {}).get('net_lift', {}).get('force')
            before = (parse_quantity(own) or {'value': 0.0})['value']
            # The net lift points up, so a loss lowers it.
            force = {'value': before - loss * STANDARD_GRAVITY, 'unit': 'N'}
            content = replace_parameter(content, NET_LIFT_PATH, force, 'vehicle')
        file = validate_content(VehicleFile, content, str(find_file('vehicle', self.vehicle)))
        return Vehicle(file, self.scenario.air.density)

    @property
    def nominal_vehicle(self) -> Vehicle:
        """Return the vehicle that the drone assumes: its file, in standard air."""
        # Without a density: the drone does not know the weather.
        return Vehicle(self.build_true_vehicle(0.0).file)

    @property
    def scenario(self) -> Scenario:
        """Scenario of the test flights."""
        return load_scenario(TUNING_SCENARIO)


@final
@dataclass(frozen=True, slots=True)
class StepResponse:
    """True motion in a test flight."""

    # Heading and course through the air are unwrapped and relative to the initial heading; speed
    # is along the body x axis, shape (n,) [s, m, rad, m/s, rad]
    time: Array
    altitude: Array
    heading: Array
    speed: Array
    course: Array
    tilt: Array  # angle between the body's z axis and the vertical, shape (n,) [rad]
    # Duty change per second since the previous sample, mean over the rotors, shape (n,) [1/s]
    work: Array
    stopped: bool  # whether the drone switched its motors off

    def select_channel(self, channel: Channel) -> Array:
        """Return the time series of a channel."""
        table = {
            'altitude': self.altitude,
            'heading': self.heading,
            'speed': self.speed,
            'course': self.course,
        }
        return table[channel]


def fly_steps(
    scene: TuningScene,
    gains: CascadeGains,
    case: TuningCase,
    steps: Sequence[SetpointStep] = SETPOINT_STEPS,
) -> StepResponse:
    """Fly one test flight; the same case gives all gains the same noise."""
    table = load_topic_table()
    dt = table.control_ns * 1e-9
    setpoints = list_setpoints(steps, dt)
    policy = FlightStack(
        find_navigation_strategy('bag'), gains, course=lambda time: setpoints[round(time / dt)]
    )
    world = World(scene.build_true_vehicle(case.loss), scene.scenario, table, case.seed)
    loop = ClosedLoop(world, table, policy, scene.nominal_vehicle, motion_only=True)
    samples: list[tuple[float, ...]] = []
    work, last = 0.0, loop.duties
    for _ in loop.iterate_until(lambda: world.steps == len(setpoints)):
        # Mean change of duty per rotor, summed over the EVERY periods of a sample
        work += sum(abs(a - b) for a, b in zip(loop.duties, last, strict=True)) / len(last)
        last = loop.duties
        if world.steps % SAMPLING_PERIODS == 0:
            samples.append((world.steps * dt, *_measure_state(world.state), work))
            work = 0.0
    time, altitude, yaw, speed, drift, tilt, spent = np.array(samples).T
    heading = np.unwrap(yaw)
    # Relative to the start, and unwrapped, so that it does not jump at 180 degrees.
    heading -= heading[0]
    course, stopped = heading + drift, loop.autopilot.stopped
    return StepResponse(
        time, altitude, heading, speed, course, tilt, spent / (SAMPLING_PERIODS * dt), stopped
    )


def list_setpoints(steps: Sequence[SetpointStep], dt: float) -> list[Setpoint | None]:
    """Return the setpoint of each control period `dt` [s]; None before take-off."""
    # Keyed by control period, because sums of `dt` would miss the start times by rounding.
    changes = {round(step.start / dt): step for step in steps}
    setpoint, setpoints = Setpoint(FLYING_ALTITUDE, 0.0, 0.0), list[Setpoint | None]()
    for tick in range(round(steps[-1].end / dt)):
        if step := changes.get(tick):
            channel = 'heading' if step.channel == 'course' else step.channel
            setpoint = setpoint._replace(**{channel: step.after})
        setpoints.append(setpoint if tick * dt >= TAKE_OFF_TIME else None)
    return setpoints


def _measure_state(state: Array) -> tuple[float, float, float, float, float]:
    """Return altitude, yaw, surge speed, drift angle and tilt [m, rad, m/s, rad, rad]."""
    x, y, z, w = state[QUATERNION].tolist()
    surge, sway, _ = state[VELOCITY].tolist()
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    # Angle between body z and world z; rounding can push the norm above 1.
    tilt = 2.0 * math.asin(min(1.0, math.hypot(x, y)))
    return state.item(2), yaw, surge, math.atan2(sway, surge), tilt
