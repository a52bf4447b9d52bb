# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the largest force or moment along an axis while the others are held, and the climb.

A linear programme over the forward and reverse thrusts. The strength of the jet collision is a
further unknown, at most the thrust of each rotor in the collision:

    max s F_k   subject to   F_surge = F_sway = 0, F_heave = weight less buoyancy, M_yaw = 0

where axis k itself is free. The righting moment balances roll and pitch, as in
`lta_model.limits`. The vehicle is upright.

For the climb under a constant force F, with the mass M that includes the added mass,

    M v' = F - D1 v - D2 v^2

is integrated. For D1 = 0 the closed form is t = (M / sqrt(F D2)) acosh(exp(D2 h / M)).
"""

from dataclasses import dataclass
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_model.limits import steady_speed
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import linprog

Array = NDArray[np.float64]
HELD_AXES = (0, 1, 2, 5)  # surge, sway, heave and yaw
WRENCH_DIRECTIONS = {
    'up': (2, 1.0),
    'down': (2, -1.0),
    'forward': (0, 1.0),
    'backward': (0, -1.0),
    'left': (1, 1.0),
    'right': (1, -1.0),
    'turn_left': (5, 1.0),
    'turn_right': (5, -1.0),
}


@final
@dataclass(frozen=True, slots=True)
class WrenchLimit:
    """The largest force or moment in one direction."""

    most: float  # force or moment; negative if the held weight outweighs the thrust [N, N m]
    wrench: tuple[float, ...]  # wrench of these thrusts [N, N m]
    thrusts: tuple[float, ...]  # of each rotor; negative if it is reversed [N]


def solve_wrench_limit(
    vehicle: Vehicle, direction: str, hold: bool = True, stay: bool = True
) -> WrenchLimit | None:
    """
    Return the limit in one direction; None if no thrusts hold the other axes.

    `direction`: a key of `WRENCH_DIRECTIONS`. `hold`: whether altitude must be held (unless the
    direction is up or down). `stay`: whether surge and sway must be zero.
    """
    axis, sign = WRENCH_DIRECTIONS[direction]
    wrench, tops = _wrench_columns(vehicle)
    below = _coupling_constraints(vehicle, len(tops))
    weight = vehicle.heaviness * STANDARD_GRAVITY
    # Axes without an equality constraint
    free = (axis, *(() if hold else (2,)), *(() if stay else (0, 1)))
    rows = [k for k in HELD_AXES if k not in free]
    solution = linprog(
        # `linprog` minimises, hence the minus
        -sign * wrench[axis],
        A_ub=below if len(below) else None,
        b_ub=np.zeros(len(below)) if len(below) else None,
        A_eq=wrench[rows] if rows else None,
        b_eq=[weight if k == 2 else 0.0 for k in rows] if rows else None,
        # The last unknown is the collision; without coupling it is fixed at zero
        bounds=[*((0.0, top) for top in tops), (0.0, None if len(below) else 0.0)],
    )
    if solution.status != 0 or solution.fun is None or solution.x is None:
        return None
    forward, reverse = solution.x[:-1].reshape(2, -1)
    return WrenchLimit(
        -float(solution.fun),
        tuple(float(number) for number in wrench @ solution.x),
        tuple(float(number) for number in forward - reverse),
    )


def _wrench_columns(vehicle: Vehicle) -> tuple[Array, list[float]]:
    """Return wrenches per newton, (6, unknowns), and the thrust limits [N]."""
    rotors, coupling = vehicle.rotors, vehicle.file.aero.coupling
    forward = [rotor.column for rotor in rotors]
    # `reverse` multiplies a negative thrust; the unknown here is its magnitude
    reverse = [tuple(-number for number in rotor.reverse) for rotor in rotors]
    together = coupling.force.vector + coupling.moment.vector if coupling else (0.0,) * 6
    tops = [rotor.full_thrust for rotor in rotors]
    # A limit of zero removes reverse thrust of rotors that cannot reverse
    tops += [rotor.full_thrust if rotor.reversible else 0.0 for rotor in rotors]
    return np.array([*forward, *reverse, together]).T, tops


def _coupling_constraints(vehicle: Vehicle, count: int) -> Array:
    """Return the rows that keep the collision below the thrust of each of its rotors."""
    coupling = vehicle.file.aero.coupling
    if coupling is None:
        return np.zeros((0, count + 1))
    rows = []
    for i, rotor in enumerate(vehicle.rotors):
        if rotor.name in coupling.rotors:
            row = np.zeros(count + 1)
            # Row: collision - thrust <= 0; the second half of the columns are the reverse thrusts
            row[i + (count // 2 if coupling.reversed else 0)], row[-1] = -1.0, 1.0
            rows.append(row)
    return np.array(rows)


LONGEST_CLIMB = 600.0  # s; a slower climb is reported as none


def time_to_climb(
    height: float, force: float, mass: float, linear: float, quadratic: float
) -> float | None:
    """
    Return the time to climb a height from rest; None if it exceeds 10 minutes [s].

    Parameters
    ----------
    height : float
        [m]
    force : float
        Upward thrust minus the carried weight. [N]
    mass : float
        Mass of the vehicle plus its added mass. [kg]
    linear, quadratic : float
        Drag coefficients. [N s/m, N s2/m2]

    """
    if force <= 0.0:
        return None

    def slopes(_: float, motion: Array) -> tuple[float, float]:
        speed = float(motion[1])
        return speed, (force - (linear + quadratic * abs(speed)) * speed) / mass

    def missing(_: float, motion: Array) -> float:
        return float(motion[0]) - height

    missing.terminal = True  # type: ignore[attr-defined]
    climb = solve_ivp(
        slopes, (0.0, LONGEST_CLIMB), (0.0, 0.0), events=missing, rtol=1e-9, atol=1e-9
    )
    # 1: the climb ended where nothing was missing, at its last time
    return float(climb.t[-1]) if climb.status == 1 else None


def terminal_speed(force: float, linear: float, quadratic: float) -> float | None:
    """Return the speed or rate at which the drag equals a force; None without drag."""
    if linear + quadratic <= 0.0:
        return None
    return steady_speed(force, linear, quadratic) if force > 0.0 else 0.0
