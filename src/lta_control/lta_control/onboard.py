"""
What the drone does in each control period: estimate, then control.

The estimator and the controller node in one function, for loops without ROS; the arithmetic is
theirs, that of the messages between them included. Plain scalars and tuples, so that it compiles
as it stands (`lta_config.compilation.flat`).
"""

import math
from typing import NamedTuple

from lta_control.allocation import Rotors, Scratch
from lta_control.attitude import up_in_body, Vector
from lta_control.cascade import CascadeGains, CascadeMeasurement, Setpoint
from lta_control.control import control_step, ControlMemory, has_landed
from lta_control.estimator import (
    estimator_step,
    EstimatorInputs,
    EstimatorModel,
    EstimatorSettings,
    MotionEstimate,
)
from lta_control.message_rounding import air_relative_velocity
from lta_control.message_rounding import build_measurement as measured_of
from lta_control.per_rotor import NONE, PerRotor


class DroneConstants(NamedTuple):
    """
    What stays the same during a flight.

    Attributes
    ----------
    estimator : EstimatorSettings
        Of the filters.
    body : Body
        What the estimator knows of the vehicle.
    gains : CascadeGains
        Of all loops.
    rotors : Rotors
        What the rotors can do.
    surge_drag : tuple
        Linear [N s/m] and quadratic [N s2/m2] drag along body x.
    uprightness : float
        Cosine of the tilt beyond which the motors stop.
    dt : float
        Control period. [s]
    fresh : ControlMemory
        What control remembers when it begins.

    """

    estimator: EstimatorSettings
    body: EstimatorModel
    gains: CascadeGains
    rotors: Rotors
    surge_drag: tuple[float, float]
    uprightness: float
    dt: float
    fresh: ControlMemory = ControlMemory()


class SensorInputs(NamedTuple):
    """One step's readings; NaN where nothing has come."""

    rates: Vector  # [rad/s]
    force: Vector  # specific force [m/s2]
    range: float = math.nan  # [m]
    pressure: float = math.nan  # [Pa]


class OnboardMemory(NamedTuple):
    """Everything that the drone's estimator and controller remember."""

    estimate: MotionEstimate = MotionEstimate()
    measured: CascadeMeasurement = CascadeMeasurement(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    guided: bool = False  # whether there is a setpoint yet
    setpoint: Setpoint = Setpoint(0.0, 0.0, 0.0)
    control: ControlMemory = ControlMemory()
    duties: PerRotor = NONE
    stopped: bool = False  # for good: turned over, or something is no number


def onboard_step(
    drone: DroneConstants, memory: OnboardMemory, readings: SensorInputs, scratch: Scratch
) -> OnboardMemory:
    """
    Return the memory one control period later, with the new duties in it.

    Parameters
    ----------
    drone : Drone
        What stays the same.
    memory : Onboard
        From the last step, with the newest setpoint in it.
    heard : Heard
        What the sensors say.
    scratch : sequence of float
        Numbers that the allocation may write on.

    """
    estimate = memory.estimate
    if _is_finite(readings.rates) and _is_finite(readings.force):
        inputs = EstimatorInputs(
            readings.rates, readings.force, readings.range, readings.pressure, memory.duties
        )
        estimate = estimator_step(drone.estimator, drone.body, estimate, inputs, drone.dt)
    height, speed = estimate.altitude.height, air_relative_velocity(estimate)
    measured = measured_of(estimate.attitude, height, speed, estimate.rates)
    stopped = memory.stopped or _must_stop(drone, memory, estimate, measured)
    control, duties = drone.fresh, NONE
    standing = has_landed(measured, memory.setpoint, drone.body.standing_height)
    if estimate.ready and memory.guided and not stopped and not standing:
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
        estimate, measured, memory.guided, memory.setpoint, control, duties, stopped
    )


def _must_stop(
    drone: DroneConstants,
    memory: OnboardMemory,
    estimate: MotionEstimate,
    measured: CascadeMeasurement,
) -> bool:
    """Tell whether the drone has turned over or what it flies by is no number."""
    if not estimate.ready:
        return False
    known = _is_finite((measured.altitude, measured.climb, measured.heading)) and _is_finite(
        (measured.yaw_rate, measured.speed, measured.sway)
    )
    if known:
        upright = up_in_body(estimate.attitude)[2] >= drone.uprightness
        return not upright or (memory.guided and not _is_finite(memory.setpoint))
    return memory.guided


def _is_finite(numbers: Vector) -> bool:
    """Tell whether three numbers are all finite."""
    a, b, c = numbers
    return math.isfinite(a) and math.isfinite(b) and math.isfinite(c)
