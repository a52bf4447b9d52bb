# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
BEAVIS: four rotors around the hull push outwards; lift comes only from colliding jets.

The authors (Sharma 2023, arXiv:2308.01385) report a nonlinear controller that regulates the
pressure below the hull and commands all three translations and yaw; their equations and gains
were not available. This law is our own (assumed): the thrusts are a collective T plus offsets o
that sum to zero,

    t_i = T + o_i,   (fx, fy, mz) = A o,   lift = e T + c min_i t_i

where A follows from the rotor columns, e is the lift per newton on every rotor without the
collision (negative: it pulls the hull down), and c that of the collision. Each offset reduces the
lift, because the weakest jet counts, so

    T = (lift - c min(o) * compensation) / (e + c)

restores it. With `compensation` 1 the mixer accounts for the collision; with 0 it assumes full
collective. Altitude has priority: the offsets are scaled down until every rotor stays below full
thrust. The vehicle does not turn first: it pushes along its course at any heading.
"""

from typing import cast, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.settings import setting
from lta_control.allocation import PerRotor, Rotors, Scratch, thrusts_to_duties
from lta_control.laws.cascade import clamp_symmetric, ClimbGains, lift_step, pid_step, PidGains
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.motion import rotate_level_to_world, to_world, wrap_angle, yaw_from_quaternion
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import Vehicle
import numpy as np

FOUR = 4
PLANAR = (0, 1, 5)  # surge, sway, yaw
HEAVE = 2

Four = tuple[float, float, float, float]


class LateralGains(ClimbGains):
    """Gains of the altitude, heading and velocity loops."""

    heading_kp: float = setting(..., '1/s', 0.0, 10.0)
    """Commanded yaw rate per radian of heading error."""
    yaw_rate_limit: float = setting(..., 'rad/s', 0.01, 6.0)
    """Largest commanded yaw rate."""
    yaw_rate: PidGains = setting(...)
    """PID gains: yaw moment (N m) per yaw rate error (rad/s)."""
    velocity: PidGains = setting(...)
    """PID gains: force along x and y (N) per velocity error (m/s)."""
    compensation: float = setting(..., low=0.0, high=1.0)
    """
    Fraction of the lift lost to unequal rotor thrusts that a higher mean thrust makes up for.
    """


class LateralLawConstants(NamedTuple):
    """Gains, rotors, offsets by surge, sway and yaw, lift without and by collision, weight [N]."""

    gains: LateralGains
    rotors: Rotors
    surge: Four
    sway: Four
    yaw: Four
    alone: float
    collision: float
    weight: float


class LateralLawMemory(NamedTuple):
    """The latest command, integrals, and delivered minus demanded outputs."""

    command: LawCommand = LawCommand()
    climb: float = 0.0  # [N]
    yaw_rate: float = 0.0  # [N m]
    surge: float = 0.0  # [N]
    sway: float = 0.0  # [N]
    missing: Four = (0.0, 0.0, 0.0, 0.0)  # lift, yaw, surge, sway


def build_constants(gains: LateralGains, vehicle: Vehicle) -> LateralLawConstants:
    """Return the constants of a flight; raise `BadInput` for an unsuitable vehicle."""
    coupling, columns = vehicle.file.aero.coupling, vehicle.allocation
    if coupling is None or len(columns) != FOUR or len(coupling.rotors) != FOUR:
        raise BadInput(
            'The control law lateral needs four rotors whose jets collide, which '
            f'{vehicle.file.name} does not have. Describe the rotors under aero.coupling of the '
            'vehicle file, or name another law in the vehicle or comparison file.'
        )
    planar = [[column[axis] for column in columns] for axis in PLANAR]
    # Rows: fx, fy, mz, and the sum of the offsets, which must be zero
    matrix = np.array([*planar, [1.0] * FOUR])
    # A singular matrix: the rotor axes do not span surge, sway and yaw.
    if np.linalg.cond(matrix) > 1e6:
        raise BadInput(
            f'The four rotors of {vehicle.file.name} cannot produce forward force, '
            'sideways force and yaw moment independently; change the rotor axes, or '
            'choose another control law.'
        )
    # Columns of the inverse: offsets per newton of surge and sway, and per N m of yaw
    surge, sway, yaw = (cast('Four', tuple(part.tolist())) for part in np.linalg.inv(matrix).T[:3])
    return LateralLawConstants(
        gains,
        build_rotors(vehicle),
        surge,
        sway,
        yaw,
        alone=sum(column[HEAVE] for column in columns),
        collision=coupling.force.vector[HEAVE],
        weight=vehicle.heaviness * STANDARD_GRAVITY,
    )


def step(
    constants: LateralLawConstants, memory: LateralLawMemory, inputs: LawInputs, scratch: Scratch
) -> LateralLawMemory:
    """Return the memory one step later, with the new command in it."""
    gains, motion, setpoint, dt = constants.gains, inputs.motion, inputs.setpoint, inputs.dt
    climb_rate = to_world(motion.attitude, motion.velocity)[2]
    yaw = yaw_from_quaternion(motion.attitude)
    gap = memory.missing
    error = setpoint.altitude - motion.position[2]
    push, climb = lift_step(gains, memory.climb, error, climb_rate, gap[0], dt)
    off = wrap_angle(setpoint.heading - yaw)
    rate = clamp_symmetric(gains.heading_kp * off, gains.yaw_rate_limit)
    turn, yaw_rate = pid_step(
        gains.yaw_rate, memory.yaw_rate, rate - motion.rates[2], 0.0, gap[1], dt
    )
    forward, left = rotate_level_to_world(off, setpoint.speed, 0.0)
    loop = gains.velocity
    fx, surge = pid_step(loop, memory.surge, forward - motion.velocity[0], 0.0, gap[2], dt)
    fy, sway = pid_step(loop, memory.sway, left - motion.velocity[1], 0.0, gap[3], dt)
    # The jets cannot push down
    lift = max(constants.weight + push, 0.0)
    thrusts, share, delivered = mix_thrusts(constants, lift, fx, fy, turn)
    # Negative where the offsets were scaled down: the undelivered part of each demand
    short = share - 1.0
    missing = (delivered - constants.weight - push, short * turn, short * fx, short * fy)
    command = LawCommand(thrusts_to_duties(constants.rotors, thrusts, scratch), UNMOVED)
    return LateralLawMemory(command, climb, yaw_rate, surge, sway, missing)


def mix_thrusts(
    constants: LateralLawConstants, lift: float, fx: float, fy: float, turn: float
) -> tuple[PerRotor, float, float]:
    """Return the thrusts [N], the feasible share of the offsets, and the intended lift [N]."""
    k, p, q = constants.surge, constants.sway, constants.yaw
    o0 = k[0] * fx + p[0] * fy + q[0] * turn
    o1 = k[1] * fx + p[1] * fy + q[1] * turn
    o2 = k[2] * fx + p[2] * fy + q[2] * turn
    o3 = k[3] * fx + p[3] * fy + q[3] * turn
    least, most = min(o0, o1, o2, o3), max(o0, o1, o2, o3)
    together = constants.alone + constants.collision
    full = constants.rotors.high[0]
    lift = min(lift, together * full)
    # Lift lost by the weakest jet, per unit of collective.
    back = constants.gains.compensation * constants.collision * least / together
    reach = most - back
    # Scale the offsets so that the strongest rotor reaches full thrust at most.
    share = min(1.0, (full - lift / together) / reach) if reach > 0.0 else 1.0
    collective = lift / together - share * back
    return (
        clamp_thrust(collective + share * o0, full),
        clamp_thrust(collective + share * o1, full),
        clamp_thrust(collective + share * o2, full),
        clamp_thrust(collective + share * o3, full),
        0.0, 0.0, 0.0, 0.0,
    ), share, lift  # fmt: skip


def clamp_thrust(thrust: float, full: float) -> float:
    """Return the thrust clamped to a rotor that does not reverse [N]."""
    return min(max(thrust, 0.0), full)


LATERAL_LAW = ControlLaw(
    'lateral', LateralGains, Feedback.ESTIMATOR, build_constants, LateralLawMemory(), step
)
