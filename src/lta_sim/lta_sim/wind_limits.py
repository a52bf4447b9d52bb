# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the wind that a vehicle can hold against, from its parameters alone.

The limit is the speed at which the drag equals the thrust that remains after holding height and
heading, in the best heading. A vehicle with a hull stays level; one without a hull, or with a
moving mass for pitch, uses the pitch at which it is fastest:

    find the largest v for which some pitch p and some thrusts (a linear programme) give
    F_x(thrust) + F_x(air, v, p) >= 0,   F_z(thrust) + F_z(air, v, p) = weight less buoyancy

in the map, with no yaw moment, and no moment at all where nothing rights the vehicle. The vehicle
must also not tumble (`limits.tumble_speed`) or rise (`rise_speed`). Control, turbulence and eddies
behind obstacles reduce the limit further; only a simulated flight shows by how much.
"""

from collections.abc import Callable
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_model import limits
from lta_model.effects import initial_memory
from lta_model.effects.air import WIND_PROFILE
from lta_model.effects.protocol import AirEffectInput, Wrench
from lta_model.model import VehicleModel
from lta_model.state import pack_state, QUATERNION, SURROUNDINGS
from lta_model.vehicle import Vehicle
from lta_sim.kernels import kernel
from lta_sim.scene_model import vehicle_reach
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

CLEAR_HEIGHT = 1e3  # m above the floor, outside any ground effect
FASTEST_WIND = 60.0  # m/s; bound of the winds
SPEED_TOLERANCE = 1e-4  # m/s
WIND_HEADINGS = tuple(math.radians(15 * k) for k in range(24))
PITCHES = tuple(math.radians(3 * k) for k in range(-27, 28))
# Pitch angles of a freely hanging hull
LEANS = tuple(math.radians(0.5 * k) for k in range(-60, 61))
NOT_AIR = ('weight_and_buoyancy', 'net_lift', 'helium_leak', 'superheat', 'moving_mass')
Array = NDArray[np.float64]


def air_wrench(
    model: VehicleModel, speed: float, heading: float = 0.0, pitch: float = 0.0
) -> Array:
    """Return the aerodynamic wrench on a vehicle that flies level with its rotors at rest."""
    c, s = math.cos(pitch), math.sin(pitch)
    x, y = speed * math.cos(heading), speed * math.sin(heading)
    # Level velocity expressed in the pitched body axes
    state = pack_state(
        (0.0, 0.0, CLEAR_HEIGHT), velocity=(x * c, y, x * s), memory=initial_memory()
    )
    state[QUATERNION] = (0.0, math.sin(0.5 * pitch), 0.0, math.cos(0.5 * pitch))
    acting = kernel.effect_wrenches(state, model, (0.0,))
    # Only aerodynamic effects count; weight and buoyancy are in the balance
    total = sum((w for name, w in acting.items() if name not in NOT_AIR), start=np.zeros(6))
    return _to_level_axes(total, pitch)


def _to_level_axes(wrench: Array, pitch: float) -> Array:
    """Rotate a wrench from body axes to level axes."""
    c, s = math.cos(pitch), math.sin(pitch)
    turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.concatenate([turn @ wrench[:3], turn @ wrench[3:]])


def thrust_speed(vehicle: Vehicle) -> float:
    """
    Return the largest airspeed that the rotors can hold at constant height and heading [m/s].

    Infinite if the known drag allows more than `FASTEST`.

    Raise `BadInput` if no thrusts hold height and heading.
    """
    model = vehicle.build_model()
    if vehicle.file.hull.shape == 'none' or vehicle.file.moving_mass:
        return _pitched_speed_limit(vehicle, model)
    return max(_level_speed_limit(vehicle, model, heading) for heading in WIND_HEADINGS)


def _level_speed_limit(vehicle: Vehicle, model: VehicleModel, heading: float) -> float:
    """Return the largest airspeed in one direction, upright."""
    force = limits.level_force(vehicle, heading)

    def holds(speed: float) -> bool:
        x, y, *_ = air_wrench(model, speed, heading)
        return bool(force + x * math.cos(heading) + y * math.sin(heading) >= 0.0)

    return 0.0 if force <= 0.0 else _bisect_speed(holds, 0.0, FASTEST_WIND)


def _pitched_speed_limit(vehicle: Vehicle, model: VehicleModel) -> float:
    """Return the largest airspeed along body x at any pitch."""

    def holds(speed: float) -> bool:
        return any(_is_balanced(vehicle, model, speed, pitch) for pitch in PITCHES)

    # What holds need not be monotonic: lift may carry a heavy vehicle only at speed
    grid = [0.0, *np.geomspace(0.1, FASTEST_WIND, 60).tolist()]
    # From the fastest down: only the highest held speed matters, and each test is costly.
    held = next((k for k in reversed(range(len(grid))) if holds(grid[k])), None)
    if held is None:
        raise BadInput(
            f'{vehicle.file.name} cannot fly level at any speed or pitch; bring '
            'trim.heaviness closer to 0, or use stronger rotors.'
        )
    if held == len(grid) - 1:
        return math.inf
    return _bisect_speed(holds, grid[held], grid[held + 1], 0.01)


def _bisect_speed(
    holds: Callable[[float], bool],
    low: float,
    high: float,
    fine: float = SPEED_TOLERANCE,
) -> float:
    """Return the speed between two at which a condition ceases to hold."""
    if holds(high):
        return math.inf
    while high - low > fine:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def rise_speed(vehicle: Vehicle) -> float:
    """
    Return the airspeed along body x above which a freely hanging hull rises [m/s].

    Forward thrust below the hull pitches its nose up until the weight and the Munk moment of the
    inclined hull balance it. The rotors then also push upwards, which only the excess weight can
    counter. Infinite where nothing rises, and with colliding jets (`aero.coupling`), where it is
    unknown.
    """
    if vehicle.file.hull.shape == 'none' or vehicle.file.moving_mass or vehicle.file.aero.coupling:
        return math.inf
    model = vehicle.build_model()

    latest = 0.0  # lean that balanced last: near it, the search for the next ends soonest

    def holds(speed: float) -> bool:
        nonlocal latest
        for lean in sorted(LEANS, key=lambda each: abs(each - latest)):
            if _is_balanced(vehicle, model, speed, lean, free=True):
                latest = lean
                return True
        return False

    # From the slowest up: faster than it tumbles, a hull can balance again on its way over
    grid = np.linspace(0.0, min(thrust_speed(vehicle), FASTEST_WIND), 21).tolist()
    end = next((k for k in range(1, len(grid)) if not holds(grid[k])), None)
    return math.inf if end is None else _bisect_speed(holds, grid[end - 1], grid[end], 0.005)


def _hanging_moment(vehicle: Vehicle, speed: float, pitch: float) -> float:
    """
    Return the nose-down moment of weight and added mass at a pitch [N m].

    The added-mass part is the Munk moment (Munk 1924), (A_z - A_x) u w, with A the added mass.
    """
    x, _, z = vehicle.cg
    along, _, upright, *_ = vehicle.added_mass
    c, s = math.cos(pitch), math.sin(pitch)
    # Weight acts at the centre of gravity; buoyancy has no moment about the hull centre
    weight = vehicle.mass * STANDARD_GRAVITY
    return float(weight * (c * x + s * z) + (upright - along) * speed * speed * s * c)


def _is_balanced(
    vehicle: Vehicle, model: VehicleModel, speed: float, pitch: float, *, free: bool = False
) -> bool:
    """Return whether some thrusts hold a speed at a pitch; `free` lets the hull hang freely."""
    columns, tops = [], []
    for rotor in vehicle.rotors:
        columns.append(_to_level_axes(np.array(rotor.column), pitch))
        tops.append(rotor.full_thrust)
        if rotor.reversible:
            # Reverse thrust is a separate non-negative variable of the linear programme
            columns.append(-_to_level_axes(np.array(rotor.reverse), pitch))
            tops.append(rotor.full_thrust)
    air = air_wrench(model, speed, 0.0, pitch)
    # Thrust must cancel the air's wrench and carry the excess weight
    balance = -air
    balance[2] += vehicle.heaviness * STANDARD_GRAVITY
    # Weight or a moving mass balances roll and pitch; a small bank balances sway.
    axes = [1, 2, 3, 4, 5] if vehicle.file.hull.shape == 'none' else [2, 5]
    if free:
        balance[4] -= _hanging_moment(vehicle, speed, pitch)
        axes = [2, 4, 5]
    wrench = np.array(columns).T
    return _most_forward_thrust(wrench, axes, balance, tops) >= float(balance[0])


def _most_forward_thrust(
    wrench: Array, axes: list[int], balance: Array, tops: list[float]
) -> float:
    """Return the largest forward force subject to balance on `axes`; -inf if none balances [N]."""
    bounds = [(0.0, top) for top in tops]
    # linprog minimises
    solution = linprog(-wrench[0], A_eq=wrench[axes], b_eq=balance[axes], bounds=bounds)
    return -math.inf if solution.status or solution.fun is None else float(-solution.fun)


def static_wind_limit(vehicle: Vehicle) -> float:
    """Return the largest uniform wind that thrust and balance allow [m/s]."""
    speed = thrust_speed(vehicle)
    if vehicle.file.hull.shape == 'none':
        return speed  # its rotors keep it upright, at any speed
    return min(speed, limits.tumble_speed(vehicle), rise_speed(vehicle))


def wind_share_at_hull(
    vehicle: Vehicle, height: float, reference: float, roughness: float
) -> float:
    """Return the ratio of the wind at the hull's height to a reference wind, by the log law."""
    half = vehicle_reach(vehicle)[1] if vehicle.file.hull.shape != 'none' else 0.0
    still = (0.0, 0.0, 0.0)
    place = AirEffectInput((0.0, 0.0, height), still, still, (0.0,) * SURROUNDINGS)
    wind: Wrench = WIND_PROFILE.air(
        # Unit reference wind along x, so that the result is the ratio
        (1.0, 0.0, reference, roughness, half),
        (),
        place,
    )
    return wind[0]
