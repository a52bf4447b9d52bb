# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The rules of a flight: one control period of a drone, from sensor readings to duties.

Estimate the motion, choose the setpoint to follow, decide whether the motors may turn, and let the
control law demand forces and allocate them to the rotors. `flight_step` is the whole of it: loops
in one process and batches call it, compiled. In the graph the estimator node calls
`estimate_motion` and the controller node `control_motors`, with messages between them. Nobody else
turns a motor; the safety state machine of a bridge, below, may only stop one.

The motors stay off on the ground, and until the drone is armed and has an estimate and a setpoint
above the floor. They stop for good when it has overturned, when nobody knows its height, and when
a number of estimate or setpoint is not finite. Whenever they are off, the law begins anew.

Plain scalars and tuples with memory in and out, so that all of it compiles
(`lta_config.compilation.flat`).
"""

from enum import IntEnum
import math
from typing import Any, NamedTuple

from lta_control.allocation import is_any_motor_turning, Scratch
from lta_control.estimator import (
    air_relative_velocity,
    estimator_step,
    EstimatorInputs,
    EstimatorModel,
    EstimatorSettings,
    has_height,
    is_plausible_imu_sample,
    is_stuck,
    MotionEstimate,
    SensorWatch,
    watch_sensor,
)
from lta_control.laws.cascade import CascadeLawMemory
from lta_control.laws.protocol import ControlLaw, LawInputs, LawMemory
from lta_control.motion import (
    CascadeMeasurement,
    climb_rate,
    ControlMotion,
    DeadReckonedMotion,
    has_overturned,
    measure_motion,
    Setpoint,
    Vector,
    yaw_from_quaternion,
)

TILT_LIMIT = 1.0  # rad; beyond it the drone counts as overturned
# m below the drone: the setpoint of a slow descent that goes on until the floor
DESCENT_DEPTH = 0.2
FOOT = 0.03  # m above the standing height that still counts as on the floor
STANDING_SPEED = 0.05  # m/s of climb or descent that still count as standing
STANDSTILL = 6.0  # s without sinking after which a landing has ended
SINKING = 0.02  # m below the lowest height; less is no descent
TAKE_OFF_RISE = 0.1  # m above the lowest height; the drone flies again
NO_HEIGHT = 1e6  # m; above all heights
UNTRACKED = ControlMotion()  # without a tracker


class FlightState(IntEnum):
    """What the motors do and why; from `OVERTURNED` on they have stopped for good."""

    OFF = 0  # disarmed, or no estimate or no setpoint has come
    WAITING = 1  # armed, but since then no setpoint above the floor has come
    ON_GROUND = 2
    LANDED = 3  # on the ground, as it no longer sinks although it is to land
    FLYING = 4  # to the setpoint
    HOLDING = 5  # at the height and heading of a setpoint that is old
    LANDING = 6  # without a setpoint to follow
    OVERTURNED = 7
    BLIND = 8  # nobody knows the height
    NOT_FINITE = 9  # a number that steers
    EMERGENCY_STOP = 10  # by a person


class FlightRules(NamedTuple):
    """The limits of a flight."""

    uprightness: float  # cosine of the tilt beyond which the drone has overturned
    standing_height: float  # of the hull centre above the floor, of a drone that stands there [m]
    # Age of a setpoint from which the drone holds height and heading, and from which it lands [s]
    hold_after: float = math.inf
    land_after: float = math.inf


class DroneConstants(NamedTuple):
    """Values that stay constant during a flight."""

    estimator: EstimatorSettings
    body: EstimatorModel
    law: Any  # those of the control law
    rules: FlightRules
    dt: float  # control period [s]


class LandingWatch(NamedTuple):
    """Progress of a landing, which does not depend on an exact height."""

    lowest: float = NO_HEIGHT  # since the landing began, or the drone rose last [m]
    still: float = 0.0  # time since the drone sank or rose last [s]


class FlightWatch(NamedTuple):
    """What the rules remember from step to step."""

    state: int = 0  # a `FlightState`
    flies: bool = False  # whether a setpoint above the floor has come since arming
    height: SensorWatch = SensorWatch()
    landing: LandingWatch = LandingWatch()


class PilotMemory(NamedTuple):
    """State of rules and control law; `law.command` has the newest duties."""

    watch: FlightWatch = FlightWatch()
    law: LawMemory = CascadeLawMemory()  # that of another law begins with its `start`


class DroneMemory(NamedTuple):
    """Full state of a drone between two control periods."""

    estimate: MotionEstimate = MotionEstimate()
    # The estimate as it is measured for the cascade
    measured: CascadeMeasurement = CascadeMeasurement(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    guided: bool = False  # whether there is a setpoint yet
    setpoint: Setpoint = Setpoint(0.0, 0.0, 0.0)
    pilot: PilotMemory = PilotMemory()


class SensorInputs(NamedTuple):
    """Sensor readings of one step; NaN where there is none."""

    rates: Vector  # [rad/s]
    force: Vector  # specific force [m/s2]
    range: float = math.nan  # [m]
    pressure: float = math.nan  # [Pa]
    # By an external tracker, for laws that fly by one, and whether it has seen the drone
    tracked: ControlMotion = UNTRACKED
    is_tracked: bool = False


class ControlInputs(NamedTuple):
    """What a drone is to do, and what is known about it."""

    motion: ControlMotion
    ready: bool  # whether the motion is estimated
    blind: bool  # whether no sensor measures the height any more
    guided: bool  # whether there is a setpoint yet
    setpoint: Setpoint
    age: float  # of the setpoint; infinite if its stamp is in the future [s]
    armed: bool
    must_land: bool  # whether the drone lands whatever its setpoint is
    dt: float  # time since the last step [s]


def flight_step(
    law: ControlLaw,
    drone: DroneConstants,
    memory: DroneMemory,
    sensed: SensorInputs,
    scratch: Scratch,
) -> DroneMemory:
    """
    Return the memory one control period later, with the new duties in it.

    `memory` is that of the last step with the latest setpoint, `scratch` the working array of
    `allocate`.
    """
    # The estimator knows the duties that act until now
    acting = memory.pilot.law.command.duties
    estimate = estimate_motion(
        drone.estimator,
        drone.body,
        memory.estimate,
        EstimatorInputs(sensed.rates, sensed.force, sensed.range, sensed.pressure, acting),
        drone.dt,
    )
    motion, ready, blind = motion_from_estimate(estimate), estimate.ready, not has_height(estimate)
    measured = measure_motion(motion)
    if law.is_tracked:
        pose, velocity = sensed.tracked, sensed.tracked.velocity
        motion = ControlMotion(pose.position, pose.attitude, velocity, estimate.rates)
        # A tracker measures the height too
        ready, blind = ready and sensed.is_tracked, False
    inputs = ControlInputs(
        motion=motion,
        ready=ready,
        blind=blind,
        guided=memory.guided,
        setpoint=memory.setpoint,
        age=0.0,
        armed=True,
        must_land=False,
        dt=drone.dt,
    )
    pilot = control_motors(law, drone.law, drone.rules, memory.pilot, inputs, scratch)
    return DroneMemory(estimate, measured, memory.guided, memory.setpoint, pilot)


def estimate_motion(
    settings: EstimatorSettings,
    body: EstimatorModel,
    estimate: MotionEstimate,
    inputs: EstimatorInputs,
    dt: float,
) -> MotionEstimate:
    """Return the estimate one step later; the same if the IMU sample is impossible."""
    if is_plausible_imu_sample(inputs.rates, inputs.force):
        return estimator_step(settings, body, estimate, inputs, dt)
    return estimate


def motion_from_estimate(estimate: MotionEstimate) -> ControlMotion:
    """Return an estimate as input of a control law."""
    x, y = estimate.position
    return ControlMotion(
        (x, y, estimate.altitude.height),
        estimate.attitude,
        air_relative_velocity(estimate),
        estimate.rates,
    )


def control_motors(
    law: ControlLaw,
    constants: Any,
    rules: FlightRules,
    memory: PilotMemory,
    inputs: ControlInputs,
    scratch: Scratch,
) -> PilotMemory:
    """Return the memory one step later, with the new duties in it; `constants` are the law's."""
    setpoint, state = follow_setpoint(rules, inputs)
    turning = is_any_motor_turning(memory.law.command.duties)
    watch = watch_flight(rules, memory.watch, inputs, setpoint, state, turning)
    if not is_flying(watch.state):
        return PilotMemory(watch, law.start)
    task = LawInputs(inputs.motion, setpoint, inputs.dt)
    return PilotMemory(watch, law.step(constants, memory.law, task, scratch))


def follow_setpoint(rules: FlightRules, inputs: ControlInputs) -> tuple[Setpoint, int]:
    """Return the setpoint to follow, and whether it flies, holds or lands the drone."""
    # A descent stays below the drone, so that it goes on until the floor
    newest, below = inputs.setpoint, inputs.motion.position[2] - DESCENT_DEPTH
    if inputs.must_land:
        # Whoever sends them, its headings are not followed
        heading = yaw_from_quaternion(inputs.motion.attitude)
        return Setpoint(below, heading, 0.0), FlightState.LANDING
    if inputs.age > rules.land_after:
        return Setpoint(below, newest.heading, 0.0), FlightState.LANDING
    if inputs.age > rules.hold_after:
        return Setpoint(newest.altitude, newest.heading, 0.0), FlightState.HOLDING
    return newest, FlightState.FLYING


def watch_flight(
    rules: FlightRules,
    before: FlightWatch,
    inputs: ControlInputs,
    setpoint: Setpoint,
    plan: int,
    turning: bool,
) -> FlightWatch:
    """
    Return whether the motors may turn, and why not.

    Parameters
    ----------
    setpoint, plan : Setpoint, int
        From `follow_setpoint`.
    turning : bool
        Whether a motor turns now.

    """
    motion, floor = inputs.motion, rules.standing_height
    altitude = motion.position[2]
    down = plan == FlightState.LANDING or setpoint.altitude <= floor
    steered = inputs.ready and inputs.guided
    height = watch_sensor(before.height, altitude, turning, inputs.dt)
    landing = watch_landing(before.landing, altitude, inputs.guided and down, inputs.dt)
    # Arming must not start the motors in the hands of a person, at rest or without a setpoint
    flies = inputs.armed and (before.flies or (steered and not down))
    # Before the first estimate no motor turns
    lost = is_stuck(height) or (inputs.blind and turning)
    state = plan
    if is_stopped(before.state):
        state = before.state
    elif inputs.armed and inputs.ready and has_overturned(motion.attitude, rules.uprightness):
        state = FlightState.OVERTURNED
    elif inputs.armed and lost:
        state = FlightState.BLIND
    elif not (inputs.armed and steered):
        state = FlightState.OFF
    elif not is_control_input_finite(motion, setpoint):
        state = FlightState.NOT_FINITE
    elif not flies:
        state = FlightState.WAITING
    elif has_landed(altitude, climb_rate(motion), setpoint, floor):
        state = FlightState.ON_GROUND
    elif landing.still > STANDSTILL:
        state = FlightState.LANDED
    return FlightWatch(state, flies, height, landing)


def is_stopped(state: int) -> bool:
    """Return whether the motors have stopped for good."""
    return state >= FlightState.OVERTURNED


def is_flying(state: int) -> bool:
    """Return whether the motors may turn."""
    return FlightState.FLYING <= state <= FlightState.LANDING


def is_control_input_finite(motion: ControlMotion, setpoint: Setpoint) -> bool:
    """Return whether all numbers that steer are finite."""
    x, y, z = motion.position
    a, b, c, d = motion.attitude
    u, v, w = motion.velocity
    p, q, r = motion.rates
    # A sum is finite only if every term is
    moving = x + y + z + a + b + c + d + u + v + w + p + q + r
    return math.isfinite(moving + setpoint.altitude + setpoint.heading + setpoint.speed)


def has_landed(altitude: float, climb: float, setpoint: Setpoint, standing_height: float) -> bool:
    """
    Return whether the drone stands on the floor and its setpoint is no higher.

    `altitude` [m] and `climb` [m/s] are those of the hull centre, `standing_height` its altitude
    when the drone stands. [m]
    """
    down = altitude < standing_height + FOOT and abs(climb) < STANDING_SPEED
    return down and setpoint.altitude <= standing_height


def watch_landing(
    watch: LandingWatch, altitude: float, is_landing: bool, dt: float
) -> LandingWatch:
    """
    Return the progress of a landing `dt` seconds later.

    An estimated height that is some centimetres too high never reaches the floor. The drone
    then stands where it no longer sinks although it `is_landing`. An unknown height counts as no
    descent. In the air a wrong end lasts until the drone sinks again, as its motors are off.
    """
    if not is_landing:
        return LandingWatch(NO_HEIGHT, 0.0)
    if altitude < watch.lowest - SINKING or altitude > watch.lowest + TAKE_OFF_RISE:
        return LandingWatch(altitude, 0.0)
    return LandingWatch(watch.lowest, watch.still + dt)


def reckon_motion(memory: DroneMemory) -> DeadReckonedMotion:
    """Return the drone's estimate of its motion."""
    measured, place = memory.measured, memory.estimate.position
    return DeadReckonedMotion(measured.heading, place[0], place[1], measured.speed, measured.sway)


def guidance_altitude(memory: DroneMemory) -> float:
    """Return the estimated altitude; NaN while the estimator calibrates [m]."""
    return memory.measured.altitude if memory.estimate.ready else math.nan
