"""Compute gains of the cascade from mass, inertia and thrust, for a vehicle without any."""

import math
from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_model import limits
from lta_model.vehicle import Vehicle
from lta_sim.wind_limits import rise_speed
from lta_vehicle.vehicle_estimate import round_digits

LEAN: Final = math.radians(20.0)  # largest tilt under forward thrust


def format_gains(vehicle: Vehicle) -> str:
    """
    Return a file of gains for the cascade, scaled to mass, inertia and thrust.

    The bandwidths (1/s) are those of the hand-tuned gains of GT-MAB and Blimp2b, rounded: 0.65 in
    heave, 2 in yaw, 0.4 in surge. Limits leave each axis a share of the thrust that the others
    keep.
    """
    m, added = vehicle.mass, vehicle.added_mass
    surge, heave = m + added[0], m + added[2]
    turn = float(vehicle.inertia[2, 2]) + added[5]
    columns = [(rotor.column, rotor.full_thrust) for rotor in vehicle.rotors]
    up = sum(max(column[2], 0.0) * full for column, full in columns)
    ahead = sum(max(column[0], 0.0) * full for column, full in columns)
    yaw = sum(abs(column[5]) * full for column, full in columns)
    depth = float(-vehicle.cg[2])
    lowest = max(-rotor.place[2] for rotor in vehicle.rotors)
    # The forward thrust that the righting moment holds at the largest tilt
    level = m * STANDARD_GRAVITY * depth * math.sin(LEAN) / lowest
    push = min(0.5 * ahead, level)
    drag = vehicle.file.aero.quadratic_drag.force.vector[0]
    # Without a motor that holds it down it rises at any speed, so that is no limit
    rise = rise_speed(vehicle) if up else math.inf
    top = min(math.sqrt(push / drag), limits.tumble_speed(vehicle), rise, 2.0)
    lines = [
        'altitude_kp: 0.4',
        'climb_limit: 0.15',
        f'climb: {_format_loop(0.65 * heave, 0.2, 0.65 * up)}',
        'heading_kp: 0.5',
        'yaw_rate_limit: 0.5',
        f'yaw_rate: {_format_loop(2.0 * turn, 0.25, 0.25 * yaw)}',
        f'speed: {_format_loop(0.4 * surge, 0.1, push)}',
        'turn_first: 0.9',
        'drift_gain: 1.0',
        'drift_limit: 0.6',
        f'speed_limit: {round_digits(max(0.9 * top, 0.05))}',
        'rise_limit: 0.4',
        f'swing_gain: {round_digits(0.2 * surge)}',
    ]
    head = (
        f'# Gains of the cascade for {vehicle.file.name}, computed from mass, inertia and thrust '
        'by lta vehicle new: assumed.\n# Tune them with lta tune, and name the new file in '
        'control.gains of the vehicle file.\n'
    )
    return head + '/**/controller:\n  ros__parameters:\n    gains:\n' + ''.join(
        f'      {line}\n' for line in lines
    )  # fmt: skip


def _format_loop(kp: float, integral: float, limit: float) -> str:
    first, second, third = map(round_digits, (kp, integral * kp, limit))
    return f'{{kp: {first}, ki: {second}, kd: 0.0, limit: {third}}}'
