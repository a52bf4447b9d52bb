"""
How hard the rotors can push along each axis while they hold the others.

A linear programme over the thrusts, forward and reversed, with the collision of jets as a further
unknown below the thrust of each rotor that meets:

    max s F_k   subject to   F_surge = F_sway = 0, F_heave = weight less buoyancy, M_yaw = 0

where the row of k itself is free. Roll and pitch are left to the righting moment, as in
`lta_model.limits`, which asks the same of a heading. The vehicle is upright.
"""

from dataclasses import dataclass
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

Array = NDArray[np.float64]
HELD = (0, 1, 2, 5)  # surge, sway, heave and yaw
DIRECTIONS = {
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
    """
    The most that rotors give in one direction.

    Attributes
    ----------
    most : float
        Force or moment along it; 0 or more, less where the held weight pulls back. [N, N m]
    wrench : 6-tuple
        All that these thrusts give. [N, N m]

    """

    most: float
    wrench: tuple[float, ...]


def solve_wrench_limit(
    vehicle: Vehicle, direction: str, hold: bool = True, stay: bool = True
) -> WrenchLimit | None:
    """
    Return the most in one direction.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    direction : str
        A key of `DIRECTIONS`.
    hold : bool
        Whether altitude must be held (where the direction is not up or down).
    stay : bool
        Whether it must not be pushed sideways.

    Returns
    -------
    Reach or None
        None where no thrusts hold the others.

    """
    axis, sign = DIRECTIONS[direction]
    wrench, tops = _wrench_columns(vehicle)
    below = _coupling_constraints(vehicle, len(tops))
    weight = vehicle.heaviness * STANDARD_GRAVITY
    free = (axis, *(() if hold else (2,)), *(() if stay else (0, 1)))
    rows = [k for k in HELD if k not in free]
    found = linprog(
        -sign * wrench[axis],
        A_ub=below if len(below) else None,
        b_ub=np.zeros(len(below)) if len(below) else None,
        A_eq=wrench[rows] if rows else None,
        b_eq=[weight if k == 2 else 0.0 for k in rows] if rows else None,
        bounds=[*((0.0, top) for top in tops), (0.0, None if len(below) else 0.0)],
    )
    if found.status != 0 or found.fun is None or found.x is None:
        return None
    return WrenchLimit(-float(found.fun), tuple(float(number) for number in wrench @ found.x))


def _wrench_columns(vehicle: Vehicle) -> tuple[Array, list[float]]:
    """Return wrenches per newton, (6, unknowns): forward, reversed, together; and their tops."""
    rotors, coupling = vehicle.rotors, vehicle.file.aero.coupling
    forward = [rotor.column for rotor in rotors]
    reverse = [tuple(-number for number in rotor.reverse) for rotor in rotors]
    together = coupling.force.vector + coupling.moment.vector if coupling else (0.0,) * 6
    tops = [rotor.full_thrust for rotor in rotors]
    tops += [rotor.full_thrust if rotor.reversible else 0.0 for rotor in rotors]
    return np.array([*forward, *reverse, together]).T, tops


def _coupling_constraints(vehicle: Vehicle, count: int) -> Array:
    """Return the rows that keep the collision below each rotor that meets."""
    coupling = vehicle.file.aero.coupling
    if coupling is None:
        return np.zeros((0, count + 1))
    rows = []
    for i, rotor in enumerate(vehicle.rotors):
        if rotor.name in coupling.rotors:
            row = np.zeros(count + 1)
            row[i + (count // 2 if coupling.reversed else 0)], row[-1] = -1.0, 1.0
            rows.append(row)
    return np.array(rows)
