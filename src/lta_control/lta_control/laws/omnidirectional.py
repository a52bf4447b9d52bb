# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Skye: position and attitude in all six degrees of freedom, each with its own PID.

Burri 2013 holds the attitude of a nearly neutral sphere that four swivelling thrusters push in
any direction. Its gains and its mixer were not available, so both are our own (assumed): PID on
position with weight and drag fed forward, PD on attitude, and weighted least-squares allocation
within the limits of the eight rotors that represent the thrusters. The goal is a point that moves
with the commanded velocity. The pose comes from a tracker (assumed).
"""

from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.settings import setting, Settings
from lta_control.allocation import deliver_wrench, NO_ROTORS, PerRotor, Rotors, Scratch
from lta_control.laws.cascade import clamp_symmetric
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.motion import (
    drag_force,
    quaternion_from_angles,
    rotate_level_to_world,
    rotation_between,
    to_body,
    to_world,
    Vector,
)
from lta_control.vehicle_parameters import build_rotors, surge_drag_coefficients
from lta_model.vehicle import Vehicle

# Equal weights: the lever is near 1 m, so N and N m are comparable
ALL_ALIKE = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0)


class OmnidirectionalGains(Settings):
    """Gains of position and attitude."""

    position_kp: float = setting(..., 'N/m', 0.0, 1e3)
    """Force per position error."""
    position_ki: float = setting(..., 'N/(m s)', 0.0, 1e3)
    """Force per integrated position error."""
    position_kd: float = setting(..., 'N s/m', 0.0, 1e3)
    """Force per velocity error."""
    reach: float = setting(..., 'm', 0.01, 100.0)
    """Position errors are limited to this value."""
    integral_limit: float = setting(..., 'N', 0.0, 1e3)
    """Largest force from the integrated position error."""
    attitude_kp: float = setting(..., 'N m', 0.0, 1e3)
    """Moment per attitude error."""
    attitude_kd: float = setting(..., 'N m s', 0.0, 1e3)
    """Moment per angular rate."""


class OmnidirectionalLawConstants(NamedTuple):
    """Gains, rotors, drag (linear, quadratic), and weight [N]."""

    gains: OmnidirectionalGains
    rotors: Rotors
    drag: tuple[float, float]
    weight: float


class OmnidirectionalLawMemory(NamedTuple):
    """The latest command, the moving goal, and the integrals."""

    command: LawCommand = LawCommand()
    begun: bool = False
    goal: tuple[float, float] = (0.0, 0.0)  # [m]
    integral: Vector = (0.0, 0.0, 0.0)  # world [N]
    thrusts: PerRotor = NO_ROTORS


def build_constants(gains: OmnidirectionalGains, vehicle: Vehicle) -> OmnidirectionalLawConstants:
    """Return the values that stay constant during a flight."""
    weight = vehicle.heaviness * STANDARD_GRAVITY
    return OmnidirectionalLawConstants(
        gains, build_rotors(vehicle, ALL_ALIKE), surge_drag_coefficients(vehicle), weight
    )


def step(
    constants: OmnidirectionalLawConstants,
    memory: OmnidirectionalLawMemory,
    inputs: LawInputs,
    scratch: Scratch,
) -> OmnidirectionalLawMemory:
    """Return the memory one step later, with the new command in it."""
    gains, motion, setpoint, dt = constants.gains, inputs.motion, inputs.setpoint, inputs.dt
    px, py, pz = motion.position
    vx, vy, vz = to_world(motion.attitude, motion.velocity)
    # The goal starts at the drone's own position.
    gx, gy = memory.goal if memory.begun else (px, py)
    wx, wy = rotate_level_to_world(setpoint.heading, setpoint.speed, 0.0)
    gx, gy = gx + dt * wx, gy + dt * wy
    # A bounded error limits the force when the vehicle falls behind its goal
    ex, ey = clamp_symmetric(gx - px, gains.reach), clamp_symmetric(gy - py, gains.reach)
    ez = clamp_symmetric(setpoint.altitude - pz, gains.reach)
    # Clamped integrals prevent wind-up while the error is limited by `reach`.
    ix = clamp_symmetric(memory.integral[0] + dt * gains.position_ki * ex, gains.integral_limit)
    iy = clamp_symmetric(memory.integral[1] + dt * gains.position_ki * ey, gains.integral_limit)
    iz = clamp_symmetric(memory.integral[2] + dt * gains.position_ki * ez, gains.integral_limit)
    drag = drag_force(constants.drag[0], constants.drag[1], setpoint.speed)
    dx, dy = rotate_level_to_world(setpoint.heading, drag, 0.0)
    kp, kd = gains.position_kp, gains.position_kd
    fx, fy, fz = to_body(
        motion.attitude,
        (
            kp * ex + ix + kd * (wx - vx) + dx,
            kp * ey + iy + kd * (wy - vy) + dy,
            # The commanded vertical velocity is zero
            kp * ez + iz - kd * vz + constants.weight,
        ),
    )
    tx, ty, tz = rotation_between(
        motion.attitude, quaternion_from_angles(0.0, 0.0, setpoint.heading)
    )
    kp, kd = gains.attitude_kp, gains.attitude_kd
    p, q, r = motion.rates
    wrench = (fx, fy, fz, kp * tx - kd * p, kp * ty - kd * q, kp * tz - kd * r)
    duties, thrusts, _ = deliver_wrench(constants.rotors, wrench, memory.thrusts, scratch)
    command = LawCommand(duties, UNMOVED)
    return OmnidirectionalLawMemory(command, True, (gx, gy), (ix, iy, iz), thrusts)


OMNIDIRECTIONAL_LAW = ControlLaw(
    'omnidirectional',
    OmnidirectionalGains,
    Feedback.TRACKER,
    build_constants,
    OmnidirectionalLawMemory(),
    step,
)
