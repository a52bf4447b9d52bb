# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Multirotor control: velocity to tilt, tilt to rates, rates to moments, moments to thrusts.

The structure is that of the Crazyflie firmware's PID controller (cascaded velocity, attitude and
rate loops, then power distribution). Gains and equations are our own (assumed), because this law
commands newtons and runs once per control period, where the firmware's rate loop runs at 500 Hz
in its own units. A derivative of the measured rates compensates the motor lag. World velocity
needs a tracker, as a Crazyflie needs one or a flow deck.
"""

import math
from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.settings import setting
from lta_control.allocation import deliver_wrench, NO_ROTORS, PerRotor, Rotors, Scratch
from lta_control.laws.cascade import clamp_symmetric, ClimbGains, lift_step, pid_step, PidGains
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.motion import (
    quaternion_from_angles,
    rotate_level_to_world,
    rotation_between,
    to_world,
    up_in_body,
    Vector,
    wrap_angle,
    yaw_from_quaternion,
)
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import Vehicle

# Priority: tilt, altitude, heading. Moments are scaled by an arm of 1 cm, in yaw of 10 cm.
MIXER = (0.0, 0.0, 1.0, 1e4, 1e4, 1e2)
LEAST_TILT_COSINE = 0.5  # smallest cosine of the tilt for which thrust is increased


class QuadrotorGains(ClimbGains):
    """Gains of all loops."""

    velocity: PidGains = setting(...)
    """PID gains: horizontal acceleration (m/s2) per velocity error (m/s)."""
    attitude_kp: float = setting(..., '1/s', 0.0, 50.0)
    """Commanded roll or pitch rate per radian of tilt error."""
    heading_kp: float = setting(..., '1/s', 0.0, 50.0)
    """Commanded yaw rate per radian of heading error."""
    rate_limit: float = setting(..., 'rad/s', 0.01, 50.0)
    """Largest commanded angular rate."""
    rate_kp: float = setting(..., '1/s', 0.0, 500.0)
    """Angular acceleration per roll or pitch rate error."""
    rate_kd: float = setting(..., '1', 0.0, 10.0)
    """Angular acceleration per derivative of the roll or pitch rate."""
    yaw_rate_kp: float = setting(..., '1/s', 0.0, 500.0)
    """Angular acceleration per yaw rate error."""
    slope_time: float = setting(..., 's', 0.0, 1.0)
    """Time constant of the low-pass filter for the derivative of the angular rates."""


class QuadrotorLawConstants(NamedTuple):
    """Gains, rotors, moments of inertia [kg m2], and weight [N]."""

    gains: QuadrotorGains
    rotors: Rotors
    inertia: Vector
    weight: float


class QuadrotorLawMemory(NamedTuple):
    """The latest command, integrals, and the filtered derivatives of the rates."""

    command: LawCommand = LawCommand()
    begun: bool = False
    climb: float = 0.0  # [N]
    east: float = 0.0  # [m/s2]
    north: float = 0.0  # [m/s2]
    rates: Vector = (0.0, 0.0, 0.0)  # [rad/s]
    slopes: tuple[float, float] = (0.0, 0.0)  # [rad/s2]
    missing: float = 0.0  # [N]
    thrusts: PerRotor = NO_ROTORS


def build_constants(gains: QuadrotorGains, vehicle: Vehicle) -> QuadrotorLawConstants:
    """Return the values that stay constant during a flight."""
    x, y, z = (float(vehicle.inertia[axis, axis]) for axis in range(3))
    weight = vehicle.heaviness * STANDARD_GRAVITY
    return QuadrotorLawConstants(gains, build_rotors(vehicle, MIXER), (x, y, z), weight)


def step(
    constants: QuadrotorLawConstants,
    memory: QuadrotorLawMemory,
    inputs: LawInputs,
    scratch: Scratch,
) -> QuadrotorLawMemory:
    """Return the memory one step later, with the new command in it."""
    gains, motion, setpoint, dt = constants.gains, inputs.motion, inputs.setpoint, inputs.dt
    vx, vy, vz = to_world(motion.attitude, motion.velocity)
    error = setpoint.altitude - motion.position[2]
    push, climb = lift_step(gains, memory.climb, error, vz, memory.missing, dt)
    # Divide by the cosine, so that the vertical force survives the tilt.
    upright = max(up_in_body(motion.attitude)[2], LEAST_TILT_COSINE)
    thrust = (constants.weight + push) / upright
    wx, wy = rotate_level_to_world(setpoint.heading, setpoint.speed, 0.0)
    loop = gains.velocity
    ax, east = pid_step(loop, memory.east, wx - vx, 0.0, 0.0, dt)
    ay, north = pid_step(loop, memory.north, wy - vy, 0.0, 0.0, dt)
    yaw = yaw_from_quaternion(motion.attitude)
    forward, left = rotate_level_to_world(-yaw, ax, ay)
    # A tilt whose horizontal thrust gives the wanted acceleration.
    goal = quaternion_from_angles(
        # Positive pitch is nose down, which accelerates forward; positive roll accelerates right
        -math.atan(left / STANDARD_GRAVITY),
        math.atan(forward / STANDARD_GRAVITY),
        yaw,
    )
    mx, my, slopes = tilt_moments(
        constants, memory, rotation_between(motion.attitude, goal), inputs
    )
    yaw_rate = clamp_symmetric(
        gains.heading_kp * wrap_angle(setpoint.heading - yaw), gains.rate_limit
    )
    # Moment = inertia times wanted angular acceleration
    mz = constants.inertia[2] * gains.yaw_rate_kp * (yaw_rate - motion.rates[2])
    wrench = (0.0, 0.0, thrust, mx, my, mz)
    duties, thrusts, delivered = deliver_wrench(constants.rotors, wrench, memory.thrusts, scratch)
    command = LawCommand(duties, UNMOVED)
    return QuadrotorLawMemory(
        command, True, climb, east, north, motion.rates, slopes, delivered[2] - thrust, thrusts
    )


def tilt_moments(
    constants: QuadrotorLawConstants, memory: QuadrotorLawMemory, turn: Vector, inputs: LawInputs
) -> tuple[float, float, tuple[float, float]]:
    """Return the moments that rotate the vehicle by `turn` [N m], and the rate slopes [rad/s2]."""
    gains, dt = constants.gains, inputs.dt
    p, q, _ = inputs.motion.rates
    # On the first step there is no earlier rate: the slope starts at 0.
    before = memory.rates if memory.begun else inputs.motion.rates
    share = dt / (gains.slope_time + dt)
    roll = memory.slopes[0] + share * ((p - before[0]) / dt - memory.slopes[0])
    pitch = memory.slopes[1] + share * ((q - before[1]) / dt - memory.slopes[1])
    wanted_p = clamp_symmetric(gains.attitude_kp * turn[0], gains.rate_limit)
    wanted_q = clamp_symmetric(gains.attitude_kp * turn[1], gains.rate_limit)
    mx = constants.inertia[0] * (gains.rate_kp * (wanted_p - p) - gains.rate_kd * roll)
    my = constants.inertia[1] * (gains.rate_kp * (wanted_q - q) - gains.rate_kd * pitch)
    return mx, my, (roll, pitch)


QUADROTOR_LAW = ControlLaw(
    'quadrotor', QuadrotorGains, Feedback.TRACKER, build_constants, QuadrotorLawMemory(), step
)
