# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
RGBlimp: the moving mass sets the pitch, both propellers the speed, their difference the yaw.

Cheng 2023 (arXiv:2306.04079) shifts a mass to glide and turns by differential thrust, in open
loop in the published flights; the loops here are our own (assumed). The wings carry the weight
that the gas does not, but only in flight. Below

    v^2 = 2 weight / (rho A C_L)

no reachable pitch holds the altitude; this is a limit of the vehicle, not of the loops. Velocity
comes from a tracker, as in the publication.
"""

import math
from typing import NamedTuple

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_control.allocation import Rotors, Scratch, thrusts_to_duties
from lta_control.laws.cascade import clamp_symmetric, pid_step, PidGains
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs
from lta_control.motion import to_world, up_in_body, Vector, wrap_angle, yaw_from_quaternion
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import Vehicle

TWO_COLUMNS = 2


class GlideGains(Settings):
    """Gains of altitude, pitch, speed and yaw."""

    altitude_kp: float = setting(..., '1/s', 0.0, 10.0)
    """Commanded climb rate per metre of altitude error."""
    climb_limit: float = setting(..., 'm/s', 0.01, 2.0)
    """Largest commanded climb rate."""
    climb: PidGains = setting(...)
    """PID gains: nose-up pitch angle (rad) per climb rate error (m/s)."""
    pitch: PidGains = setting(...)
    """PID gains: backward position of the moving mass (m) per pitch error (rad)."""
    speed: PidGains = setting(...)
    """PID gains: thrust (N) per speed error (m/s)."""
    heading_kp: float = setting(..., '1/s', 0.0, 10.0)
    """Commanded yaw rate per radian of heading error."""
    yaw_rate_limit: float = setting(..., 'rad/s', 0.01, 6.0)
    """Largest commanded yaw rate."""
    yaw_rate: PidGains = setting(...)
    """PID gains: yaw moment (N m) per yaw rate error (rad/s)."""


class GlideLawConstants(NamedTuple):
    """Gains, rotors, lever of the differential thrust [m], rest and limits of the mass [m]."""

    gains: GlideGains
    rotors: Rotors
    lever: float
    rest: Vector
    low: float
    high: float


class GlideLawMemory(NamedTuple):
    """The latest command, integrals, and the delivered minus demanded outputs."""

    command: LawCommand = LawCommand()
    climb: float = 0.0  # [rad]
    pitch: float = 0.0  # [m]
    speed: float = 0.0  # [N]
    yaw_rate: float = 0.0  # [N m]
    missing: Vector = (0.0, 0.0, 0.0)  # mass position [m], thrust [N], yaw moment [N m]


def build_constants(gains: GlideGains, vehicle: Vehicle) -> GlideLawConstants:
    """Return the constants of a flight; raise `BadInput` for an unsuitable vehicle."""
    mass, columns = vehicle.file.moving_mass, vehicle.allocation
    if mass is None or mass.low is None or mass.high is None or len(columns) != TWO_COLUMNS:
        raise BadInput(
            "The control law 'glide' needs two propellers and a moving mass with the keys 'low' "
            f"and 'high', but {vehicle.file.name} lacks one of these; name another law in the "
            'vehicle or comparison file.'
        )
    x, y, z = mass.position.vector
    # Yaw moment per newton of differential thrust: half the difference of the columns' mz
    lever = 0.5 * (columns[1][5] - columns[0][5])
    low, high = mass.low.vector[0], mass.high.vector[0]
    return GlideLawConstants(gains, build_rotors(vehicle), lever, (x, y, z), low, high)


def step(
    constants: GlideLawConstants, memory: GlideLawMemory, inputs: LawInputs, scratch: Scratch
) -> GlideLawMemory:
    """Return the memory one step later, with the new command in it."""
    gains, motion, setpoint, dt = constants.gains, inputs.motion, inputs.setpoint, inputs.dt
    rising = to_world(motion.attitude, motion.velocity)[2]
    gap = memory.missing
    error = setpoint.altitude - motion.position[2]
    climb_target = clamp_symmetric(gains.altitude_kp * error, gains.climb_limit)
    # The climb loop commands pitch, which the mass then realises.
    nose, climb = pid_step(gains.climb, memory.climb, climb_target - rising, 0.0, 0.0, dt)
    # Nose-up pitch; the clamp protects asin from rounding
    pitch = math.asin(clamp_symmetric(up_in_body(motion.attitude)[0], 1.0))
    # The rate about body y is nose down.
    back, tilt = pid_step(gains.pitch, memory.pitch, nose - pitch, -motion.rates[1], gap[0], dt)
    # Moving the mass backwards (-x) raises the nose
    place = min(max(constants.rest[0] - back, constants.low), constants.high)
    along = motion.velocity[0]
    thrust, speed = pid_step(gains.speed, memory.speed, setpoint.speed - along, 0.0, gap[1], dt)
    off = wrap_angle(setpoint.heading - yaw_from_quaternion(motion.attitude))
    rate = clamp_symmetric(gains.heading_kp * off, gains.yaw_rate_limit)
    turn, yaw_rate = pid_step(
        gains.yaw_rate, memory.yaw_rate, rate - motion.rates[2], 0.0, gap[2], dt
    )
    # The turn has priority; each propeller gives 0 to full thrust.
    full = constants.rotors.high[0]
    half = clamp_symmetric(0.5 * turn / constants.lever, 0.5 * full)
    middle = min(max(0.5 * thrust, abs(half)), full - abs(half))
    left, right = middle - half, middle + half
    # Anti-windup: what the actuators could not deliver.
    missing = (
        constants.rest[0] - place - back,
        2.0 * middle - thrust,
        2.0 * half * constants.lever - turn,
    )
    thrusts = (left, right, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    command = LawCommand(
        thrusts_to_duties(constants.rotors, thrusts, scratch),
        (place, constants.rest[1], constants.rest[2]),
    )
    return GlideLawMemory(command, climb, tilt, speed, yaw_rate, missing)


GLIDE_LAW = ControlLaw(
    'glide', GlideGains, Feedback.TRACKER, build_constants, GlideLawMemory(), step, moves_mass=True
)
