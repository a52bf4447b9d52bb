# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute a vehicle's limits of force, speed and stability from its parameters.

Level flight is a linear programme over the rotor thrusts, forward and reversed, with the collision
of jets as a further unknown below each of them:

    max F_d   subject to   F_across = 0,   F_z = weight less buoyancy,   M_z = 0

with the vehicle upright; the righting moment takes roll and pitch. The speed is where the drag
equals that force. It does not apply to a multirotor, which tilts to fly.

A hull that is wider than long turns across its path (Munk 1924): at the speeds u and w along body
x and z the moment is (A_z - A_x) u w, A the added mass, and the weight rights the pitch p by m g d
p; d is the depth of the centre of gravity. Free to heave, it keeps its vertical momentum, so that
(m + A_z) w = (m + A_x) u p, and without control it tumbles above

    u^2 = m g d (m + A_z) / ((A_z - A_x) (m + A_x))

The effect `munk_moment` removes its share of A_z - A_x in the first factor. Drag is neglected:
that of heave and pitch is quadratic, hence small at small angles.
"""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_model.vehicle import Vehicle
import numpy as np
from scipy.optimize import linprog

LEVEL_AXES = (0, 1, 2, 5)  # surge, sway, heave and yaw of a column


def level_force(vehicle: Vehicle, heading: float = 0.0) -> float:
    """
    Return the largest horizontal force [N] that the rotors can hold in level flight.

    `heading` is the direction of the force, anticlockwise from body x. [rad]

    Raise `BadInput` if no thrusts hold altitude and heading.
    """
    columns, tops = [], []
    for rotor in vehicle.rotors:
        columns.append([rotor.column[axis] for axis in LEVEL_AXES])
        tops.append(rotor.full_thrust)
    # Reversed thrust as further non-negative unknowns
    for rotor in vehicle.rotors:
        columns.append([-rotor.reverse[axis] for axis in LEVEL_AXES])
        tops.append(rotor.full_thrust if rotor.reversible else 0.0)
    together, below = _jet_constraints(vehicle)
    wrench = np.array([*columns, together]).T
    # Force along the heading is maximised, force across it must vanish
    along = np.array([math.cos(heading), math.sin(heading)]) @ wrench[:2]
    across = np.array([-math.sin(heading), math.cos(heading)]) @ wrench[:2]
    weight = vehicle.heaviness * STANDARD_GRAVITY
    # linprog minimises, hence the minus
    solution = linprog(
        -along,
        A_ub=below if len(below) else None,
        b_ub=np.zeros(len(below)) if len(below) else None,
        A_eq=np.array([across, wrench[2], wrench[3]]),
        b_eq=[0.0, weight, 0.0],
        bounds=[*((0.0, top) for top in tops), (0.0, None if len(below) else 0.0)],
    )
    if solution.status != 0 or solution.fun is None:
        raise BadInput(
            f'The rotors of {vehicle.file.name} cannot lift the '
            f'{1e3 * vehicle.heaviness:.1f} g by which it is heavier than air and hold its '
            'heading; reduce trim.heaviness, or use stronger rotors.'
        )
    return float(-solution.fun)


def _jet_constraints(vehicle: Vehicle) -> tuple[list[float], np.ndarray]:
    """Return the column of colliding jets, and the rows that limit it by each rotor's thrust."""
    coupling = vehicle.file.aero.coupling
    count = len(vehicle.rotors)
    if coupling is None:
        return [0.0] * len(LEVEL_AXES), np.zeros((0, 2 * count + 1))
    rows = []
    for i, rotor in enumerate(vehicle.rotors):
        if rotor.name in coupling.rotors:
            row = np.zeros(2 * count + 1)
            # together - thrust_i <= 0: the collision is limited by the weakest rotor
            row[i + (count if coupling.reversed else 0)], row[-1] = -1.0, 1.0
            rows.append(row)
    numbers = coupling.force.vector + coupling.moment.vector
    return [numbers[axis] for axis in LEVEL_AXES], np.array(rows)


def steady_speed(force: float, linear: float, quadratic: float) -> float:
    """
    Return the speed at which linear v + quadratic v^2 equals a force [m/s].

    The force is not negative [N]; one of the coefficients is positive [N s/m, N s2/m2].
    """
    # Rationalised quadratic formula: also valid without quadratic drag
    return 2.0 * force / (linear + math.sqrt(linear * linear + 4.0 * quadratic * force))


def level_speed(vehicle: Vehicle) -> float:
    """Return the largest speed along body x at which altitude and heading are held. [m/s]."""
    effects = vehicle.collect_effects()
    linear, quadratic = effects['linear_drag']['surge'], effects['quadratic_drag']['surge']
    force = level_force(vehicle)
    if linear + quadratic == 0.0:
        raise BadInput(
            f'{vehicle.file.name} has no drag along x, so its top speed is unlimited; add '
            'linear_drag or quadratic_drag to the aero block of the vehicle file.'
        )
    return steady_speed(force, linear, quadratic) if force > 0.0 else 0.0


def tumble_speed(vehicle: Vehicle) -> float:
    """Return the speed along body x above which the weight no longer keeps it upright. [m/s]."""
    m, (along, _, upright, *_) = vehicle.mass, vehicle.added_mass
    righting = -m * STANDARD_GRAVITY * float(vehicle.cg[2])
    if righting <= 0.0:
        return 0.0
    # Unless the added mass upwards is larger, the Munk moment does not pitch the hull up
    share = 1.0 - vehicle.collect_effects().get('munk_moment', {}).get('lost', 0.0)
    if upright <= along or share <= 0.0:
        return math.inf
    return math.sqrt(righting * (m + upright) / (share * (upright - along) * (m + along)))
