"""
Run one control period of the drone: estimate, then control.

One function with the arithmetic of the estimator and the controller node, including the rounding
of the messages between them, for loops without ROS. Plain scalars and tuples, so that it compiles
(`lta_config.compilation.flat`).
"""

import math
from typing import NamedTuple

from lta_control.allocation import Rotors, Scratch
from lta_control.altitude import is_stuck, SensorWatch, watch_sensor
from lta_control.attitude import Vector
from lta_control.cascade import CascadeGains, CascadeMeasurement, Setpoint
from lta_control.control import (
    control_step,
    ControlMemory,
    has_landed,
    has_overturned,
    is_control_input_finite,
    LandingWatch,
    STANDSTILL,
    watch_landing,
)
from lta_control.estimator import (
    estimator_step,
    EstimatorInputs,
    EstimatorModel,
    EstimatorSettings,
    has_height,
    is_any_motor_turning,
    is_plausible_imu_sample,
    MotionEstimate,
)
from lta_control.message_rounding import air_relative_velocity, build_measurement
from lta_control.per_rotor import NONE, PerRotor
from lta_control.sighting import DeadReckonedMotion


class DroneConstants(NamedTuple):
    """Values that stay constant during a flight."""

    estimator: EstimatorSettings
    body: EstimatorModel
    gains: CascadeGains
    rotors: Rotors
    surge_drag: tuple[float, float]  # linear [N s/m] and quadratic [N s2/m2] drag along body x
    uprightness: float  # cosine of the tilt beyond which the motors stop
    dt: float  # control period [s]
    fresh: ControlMemory = ControlMemory()  # initial state of the controller


class SensorInputs(NamedTuple):
    """Sensor readings of one step; NaN where there is none."""

    rates: Vector  # [rad/s]
    force: Vector  # specific force [m/s2]
    range: float = math.nan  # [m]
    pressure: float = math.nan  # [Pa]


class OnboardMemory(NamedTuple):
    """Full state of the drone's estimator and controller."""

    estimate: MotionEstimate = MotionEstimate()
    measured: CascadeMeasurement = CascadeMeasurement(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    guided: bool = False  # whether there is a setpoint yet
    setpoint: Setpoint = Setpoint(0.0, 0.0, 0.0)
    control: ControlMemory = ControlMemory()
    duties: PerRotor = NONE
    stopped: bool = False  # for good: overturned, a value is not finite, or the height unknown
    landing: LandingWatch = LandingWatch()
    height: SensorWatch = SensorWatch()


def onboard_step(
    drone: DroneConstants, memory: OnboardMemory, readings: SensorInputs, scratch: Scratch
) -> OnboardMemory:
    """
    Return the memory one control period later, with the new duties in it.

    `memory` is that of the last step with the latest setpoint, `scratch` the working array of
    `allocate`.
    """
    estimate, measured = estimate_motion(drone, memory, readings)
    height = watch_sensor(
        memory.height, measured.altitude, is_any_motor_turning(memory.duties), drone.dt
    )
    unknown = is_stuck(height) or not has_height(estimate)
    stopped = memory.stopped or unknown or _must_stop(drone, memory, estimate, measured)
    # The controller restarts from its initial state whenever the motors are off.
    control, duties = drone.fresh, NONE
    floor = drone.body.standing_height
    down = memory.guided and memory.setpoint.altitude <= floor
    landing = watch_landing(memory.landing, measured.altitude, down, drone.dt)
    landed = landing.still > STANDSTILL or has_landed(measured, memory.setpoint, floor)
    if estimate.ready and memory.guided and not stopped and not landed:
        duties, control = control_step(
            drone.gains,
            drone.rotors,
            drone.surge_drag,
            memory.control,
            measured,
            memory.setpoint,
            drone.dt,
            scratch,
        )
    return OnboardMemory(
        estimate,
        measured,
        memory.guided,
        memory.setpoint,
        control,
        duties,
        stopped,
        landing,
        height,
    )


def estimate_motion(
    drone: DroneConstants, memory: OnboardMemory, readings: SensorInputs
) -> tuple[MotionEstimate, CascadeMeasurement]:
    """Return the estimate after one more set of readings, and the input of the cascade."""
    estimate = memory.estimate
    if is_plausible_imu_sample(readings.rates, readings.force):
        inputs = EstimatorInputs(
            readings.rates, readings.force, readings.range, readings.pressure, memory.duties
        )
        estimate = estimator_step(drone.estimator, drone.body, estimate, inputs, drone.dt)
    height, speed = estimate.altitude.height, air_relative_velocity(estimate)
    return estimate, build_measurement(estimate.attitude, height, speed, estimate.rates)


def reckon_motion(memory: OnboardMemory) -> DeadReckonedMotion:
    """Return the drone's estimate of its motion."""
    measured, place = memory.measured, memory.estimate.position
    return DeadReckonedMotion(measured.heading, place[0], place[1], measured.speed, measured.sway)


def guidance_altitude(memory: OnboardMemory) -> float:
    """Return the estimated altitude; NaN while the estimator calibrates. [m]"""
    return memory.measured.altitude if memory.estimate.ready else math.nan


def _must_stop(
    drone: DroneConstants,
    memory: OnboardMemory,
    estimate: MotionEstimate,
    measured: CascadeMeasurement,
) -> bool:
    """Return whether the drone has overturned or its state or setpoint is not finite."""
    if not estimate.ready:
        return False
    # Unknown values stop the motors only once the drone flies by setpoints
    unknown = memory.guided and not is_control_input_finite(measured, memory.setpoint)
    return unknown or has_overturned(estimate.attitude, drone.uprightness)
