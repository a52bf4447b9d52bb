# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
SBlimp: push along the wanted velocity change at any heading, and let the hull swing.

The authors (Xu 2023) command linear velocity directly, without an attitude loop, and rely on the
balloon to keep the vehicle upright, according to their abstract. Gains and mixer are our own
(assumed): a PI loop on each world axis with the weight fed forward; the force is rotated into the
body frame and allocated to the tilted rotors. Yaw is only damped. World velocity needs a tracker,
as in the publication.

The rotors push sideways only by the tilt of their lift. `height_weight` sets the priority of
vertical over lateral force when both cannot be delivered.
"""

from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.settings import setting
from lta_control.allocation import deliver_wrench, NO_ROTORS, PerRotor, Rotors, Scratch
from lta_control.laws.cascade import ClimbGains, lift_step, pid_step, PidGains
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.motion import drag_force, rotate_level_to_world, to_body, to_world, Vector
from lta_control.vehicle_parameters import build_rotors, surge_drag_coefficients
from lta_model.vehicle import Vehicle

YAW_WEIGHT = 1000.0  # N m against N, with an arm of 3 cm; only shares thrust evenly


class VelocityGains(ClimbGains):
    """Gains of altitude and velocity."""

    velocity: PidGains = setting(...)
    """PID gains: force along world x and y (N) per velocity error (m/s)."""
    yaw_damping: float = setting(..., 'N m s', 0.0, 1.0)
    """Damping yaw moment per yaw rate."""
    height_weight: float = setting(..., low=0.01, high=1e4)
    """Weight of vertical force relative to lateral force in the rotor allocation."""


class VelocityLawConstants(NamedTuple):
    """Gains, rotors, lateral drag (linear, quadratic), and weight [N]."""

    gains: VelocityGains
    rotors: Rotors
    drag: tuple[float, float]
    weight: float


class VelocityLawMemory(NamedTuple):
    """The latest command, integrals by axis, and delivered minus demanded force."""

    command: LawCommand = LawCommand()
    climb: float = 0.0  # [N]
    east: float = 0.0  # [N]
    north: float = 0.0  # [N]
    missing: Vector = (0.0, 0.0, 0.0)  # world [N]
    thrusts: PerRotor = NO_ROTORS


def build_constants(gains: VelocityGains, vehicle: Vehicle) -> VelocityLawConstants:
    """Return the values that stay constant during a flight."""
    weights = (1.0, 1.0, gains.height_weight, 0.0, 0.0, YAW_WEIGHT)
    weight = vehicle.heaviness * STANDARD_GRAVITY
    return VelocityLawConstants(
        gains, build_rotors(vehicle, weights), surge_drag_coefficients(vehicle), weight
    )


def step(
    constants: VelocityLawConstants, memory: VelocityLawMemory, inputs: LawInputs, scratch: Scratch
) -> VelocityLawMemory:
    """Return the memory one step later, with the new command in it."""
    gains, motion, setpoint, dt = constants.gains, inputs.motion, inputs.setpoint, inputs.dt
    vx, vy, vz = to_world(motion.attitude, motion.velocity)
    gap = memory.missing
    error = setpoint.altitude - motion.position[2]
    up, climb = lift_step(gains, memory.climb, error, vz, gap[2], dt)
    wx, wy = rotate_level_to_world(setpoint.heading, setpoint.speed, 0.0)
    loop = gains.velocity
    fx, east = pid_step(loop, memory.east, wx - vx, 0.0, gap[0], dt)
    fy, north = pid_step(loop, memory.north, wy - vy, 0.0, gap[1], dt)
    drag = drag_force(constants.drag[0], constants.drag[1], setpoint.speed)
    dx, dy = rotate_level_to_world(setpoint.heading, drag, 0.0)
    # World axes, with drag and weight fed forward
    force = (fx + dx, fy + dy, up + constants.weight)
    bx, by, bz = to_body(motion.attitude, force)
    wrench = (bx, by, bz, 0.0, 0.0, -gains.yaw_damping * motion.rates[2])
    duties, thrusts, delivered = deliver_wrench(constants.rotors, wrench, memory.thrusts, scratch)
    # Back to the world frame, in which the integrals live.
    gx, gy, gz = to_world(motion.attitude, (delivered[0], delivered[1], delivered[2]))
    missing = (gx - force[0], gy - force[1], gz - force[2])
    command = LawCommand(duties, UNMOVED)
    return VelocityLawMemory(command, climb, east, north, missing, thrusts)


VELOCITY_LAW = ControlLaw(
    'velocity', VelocityGains, Feedback.TRACKER, build_constants, VelocityLawMemory(), step
)
