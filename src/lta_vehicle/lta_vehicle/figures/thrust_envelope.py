# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Derive rotor and speed figures: hover, thrust along each axis, and top speeds."""

from collections.abc import Callable, Iterator
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_model import limits, propulsion
from lta_model.electrical.loads import power_demand
from lta_model.vehicle import Vehicle
from lta_sim.wind_limits import rise_speed
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.mass_budget import DEGREES, GRAMS
from lta_vehicle.figures.wrench_limit import (
    solve_wrench_limit,
    terminal_speed,
    time_to_climb,
    WrenchLimit,
)

ROTOR_GROUP, SPEED_GROUP = 'Rotors', 'Speed'
THRUST_BLOCKS = ('rotors', 'thrust_curve', 'aero.thrust_allocation', 'aero.coupling')
CARRIED_BLOCKS = (*THRUST_BLOCKS, 'trim')
DRAG = ('aero.linear_drag', 'aero.quadratic_drag')
RULE = 'largest force or moment while the other axes are held (linear programme)'
AXIS_TITLES = {
    'up': 'up, beyond hover',
    'down': 'down',
    'forward': 'forward',
    'backward': 'backward',
    'left': 'to the left',
    'right': 'to the right',
}
CLIMB_DISTANCE = 1.0  # m


def compute_or_explain(compute: Callable[[], float]) -> tuple[float | None, str]:
    """Return a number and '', or None and the reason."""
    try:
        return compute(), ''
    except BadInput as reason:
        return None, str(reason)


def hover_thrust(vehicle: Vehicle) -> tuple[float, int]:
    """Return the thrust per lifting rotor in hover [N], and the number of these rotors."""
    # `per_newton`: vertical force if each lifting rotor gives 1 N, jet collision included
    rotors, per_newton = propulsion.select_lifting_rotors(
        vehicle.rotors, vehicle.file.aero.coupling
    )
    if not rotors or per_newton <= 0.0:
        return 0.0, 0
    return max(vehicle.heaviness, 0.0) * STANDARD_GRAVITY / per_newton, len(rotors)


def derive_rotor_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    """Yield the figures of the group 'Rotors': hover and the margins on each axis."""
    duty, why = compute_or_explain(lambda: vehicle.hover_duty)
    yield DerivedFigure(
        'hover_duty',
        ROTOR_GROUP,
        'hover duty',
        None if duty is None else 100.0 * duty,
        '%',
        'thrust curve and thrust allocation of the lifting rotors',
        CARRIED_BLOCKS,
        note=why,
    )
    if duty is not None:
        yield from _derive_hover_figures(vehicle)
    for direction, words in AXIS_TITLES.items():
        most, note = _force_margin(vehicle, direction)
        yield DerivedFigure(
            f'push_{direction}',
            ROTOR_GROUP,
            f'largest thrust {words}',
            None if most is None else 1e3 * most,
            'mN',
            RULE,
            CARRIED_BLOCKS,
            0,
            note,
        )
    for direction in ('turn_left', 'turn_right'):
        most, note = _turn_margin(vehicle, direction)
        yield DerivedFigure(
            f'push_{direction}',
            ROTOR_GROUP,
            direction.replace('turn_', 'largest yaw moment to the '),
            None if most is None else 1e3 * most,
            'mN m',
            RULE,
            CARRIED_BLOCKS,
            1,
            note,
        )


def _derive_hover_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    thrust, count = hover_thrust(vehicle)
    power = power_demand(vehicle.loads, [thrust] * count, transmitting=False)
    cell = ('energy', *CARRIED_BLOCKS)
    yield DerivedFigure(
        'hover_power',
        ROTOR_GROUP,
        'power in hover',
        power,
        'W',
        'idle power plus rotor power, affine in thrust',
        cell,
        2,
    )
    # Capacity is in coulombs, so this is in joules
    energy = vehicle.file.energy.battery.capacity.si * NOMINAL
    yield DerivedFigure(
        'hover_time',
        ROTOR_GROUP,
        'hover time on a full battery',
        energy / power / 60.0,
        'min',
        f'capacity at {NOMINAL} V (assumed), without solar power',
        cell,
        0,
        f'{"" if thrust > 0.0 else "floats without thrust; "}without radio '
        f'({1e3 * vehicle.loads.transmitting:.0f} mW) and without what control takes: lta energy '
        'budget flies it',
    )


NOMINAL = 3.7  # V, one lithium cell


def _force_margin(vehicle: Vehicle, direction: str) -> tuple[float | None, str]:
    """Return the force beyond hover [N], and a note."""
    limit, note = find_push_limit(vehicle, direction)
    if limit is None:
        return None, 'the rotors cannot hold the other axes at the same time'
    weight = vehicle.heaviness * STANDARD_GRAVITY
    if direction == 'up':
        # Upwards, the limit is the total force, which includes the carried weight
        beyond = limit.most - weight
        more = GRAMS * beyond / STANDARD_GRAVITY
        short = f'{-more:.1f} g too heavy to hover'
        return beyond, f'could carry {more:.1f} g more' if more >= 0.0 else short
    if direction == 'down':
        return limit.most + weight, 'includes its weight' if weight > 0.0 else note
    return limit.most, note


def find_turn_limit(vehicle: Vehicle, direction: str) -> tuple[WrenchLimit | None, str]:
    """Return the largest yaw moment and a note; without holding position if that needs it."""
    limit, note = find_push_limit(vehicle, direction)
    # 1e-9 N m: zero within the tolerance of the solver
    if limit is not None and limit.most > 1e-9:
        return limit, note
    away = solve_wrench_limit(vehicle, direction, hold=False, stay=False)
    if away is None or away.most <= 1e-9:
        return limit, note
    # Horizontal force that remains, in mN
    push = 1e3 * math.hypot(*away.wrench[:2])
    return away, f'cannot turn on the spot: a horizontal force of {push:.0f} mN remains'


def _turn_margin(vehicle: Vehicle, direction: str) -> tuple[float | None, str]:
    limit, note = find_turn_limit(vehicle, direction)
    return (None, 'the rotors cannot hold altitude') if limit is None else (limit.most, note)


def find_push_limit(vehicle: Vehicle, direction: str) -> tuple[WrenchLimit | None, str]:
    """Return the largest force or moment and a note; with altitude held if possible."""
    if (limit := solve_wrench_limit(vehicle, direction)) is not None:
        return limit, ''
    if (limit := solve_wrench_limit(vehicle, direction, hold=False)) is not None:
        return limit, 'the rotors cannot hold altitude at the same time'
    return None, ''


def derive_speed_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    """Yield the figures of the group 'Speed'."""
    thrust, why = compute_or_explain(lambda: limits.level_speed(vehicle))
    # Multirotors have no forward thrust while level
    if thrust == 0.0:
        why = 'no horizontal thrust while it is level; it tilts to fly'
    rise = rise_speed(vehicle) if thrust else math.inf
    level = thrust if thrust is None else min(thrust, rise)
    if thrust and rise < thrust:
        why = (
            f'above, its nose rises and it climbs whatever its rotors do; thrust would do for '
            f'{thrust:.2f} m/s. lta wind has its interval'
        )
    yield DerivedFigure(
        'level_speed',
        SPEED_GROUP,
        'top speed in level flight',
        level,
        'm/s',
        'forward thrust against drag, or where the hull rises',
        (*CARRIED_BLOCKS, *DRAG),
        2,
        why,
    )
    effects = vehicle.collect_effects()
    yield from _derive_climb_figures(
        vehicle, effects['linear_drag']['heave'], effects['quadratic_drag']['heave']
    )
    most, note = find_turn_limit(vehicle, 'turn_left')
    rotational = effects['rotational_drag']
    rate = terminal_speed(most.most, rotational['yaw'], rotational['yaw_2']) if most else None
    yield DerivedFigure(
        'yaw_rate',
        SPEED_GROUP,
        'top yaw rate',
        None if rate is None else DEGREES * rate,
        '°/s',
        'yaw moment against damping',
        (*THRUST_BLOCKS, *DRAG),
        0,
        'no damping in yaw is given in the vehicle file' if rate is None else note,
    )


def _derive_climb_figures(
    vehicle: Vehicle, linear: float, quadratic: float
) -> Iterator[DerivedFigure]:
    weight = vehicle.heaviness * STANDARD_GRAVITY
    up = solve_wrench_limit(vehicle, 'up')
    # Force left to climb [N]
    spare = up.most - weight if up else 0.0
    if vehicle.file.hull.shape != 'none':  # else the drag is that of rotors near hover
        lost = 'no drag along z is given in the aero block' if linear + quadratic <= 0.0 else ''
        yield DerivedFigure(
            'climb_speed',
            SPEED_GROUP,
            'top climb rate',
            terminal_speed(spare, linear, quadratic),
            'm/s',
            'upward thrust against drag',
            (*CARRIED_BLOCKS, *DRAG),
            2,
            lost,
        )
        yield DerivedFigure(
            'sink_speed',
            SPEED_GROUP,
            'sink rate with the rotors off',
            terminal_speed(weight, linear, quadratic),
            'm/s',
            'weight minus buoyancy against drag',
            ('trim', *DRAG),
            2,
            lost,
        )
    yield DerivedFigure(
        'climb_time',
        SPEED_GROUP,
        f'time to climb {CLIMB_DISTANCE:g} m from rest',
        time_to_climb(
            CLIMB_DISTANCE, spare, vehicle.mass + vehicle.added_mass[2], linear, quadratic
        ),
        's',
        'upward thrust, drag, mass and added mass',
        (*CARRIED_BLOCKS, *DRAG, 'layers'),
        note='' if spare > 0.0 else 'it cannot climb',
    )
