# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Collect the vehicle data for estimator and controller, from the nominal values of its file."""

from collections.abc import Mapping, Sequence
import math
from typing import cast

from lta_control.allocation import (
    Column,
    Columns,
    EQUAL_WEIGHTS,
    pad_to_slots,
    PerRotor,
    Rotors,
    SLOTS,
    WEIGHTS,
    Wrench,
)
from lta_control.estimator import EstimatorModel
from lta_control.motion import Vector
from lta_control.motion_filters import HullDragModel
from lta_model.propulsion import RotorModel
from lta_model.vehicle import Vehicle

VERTICAL = 0.5  # least vertical component of the axis of a rotor that pushes up or down


def build_rotors(vehicle: Vehicle, weights: Wrench = WEIGHTS) -> Rotors:
    """Return the rotors for the allocation, each with its thrust curve; `weights` by axis."""
    a, b = thrust_curves(vehicle)
    reverse = tuple(_reverse_share(rotor) for rotor in vehicle.rotors)
    # Full duty u = 1 in T = a u^2 + b u
    high = tuple(p + q for p, q in zip(a, b, strict=True))
    low = tuple(
        -full * share if rotor.reversible else 0.0
        for rotor, full, share in zip(vehicle.rotors, high, reverse, strict=False)
    )
    return Rotors(
        number=len(vehicle.allocation),
        allocation=allocation_columns(vehicle),
        low=pad_to_slots(low),
        high=pad_to_slots(high),
        lowest_heave=_lowest_heave(vehicle, low, high),
        a=a,
        b=b,
        reverse=cast('PerRotor', reverse + EQUAL_WEIGHTS[len(reverse) :]),
        weights=weights,
        sink=_heave_per_surge(vehicle),
    )


def _lowest_heave(vehicle: Vehicle, low: Sequence[float], high: Sequence[float]) -> float:
    """Return the strongest downward force of the rotors within 60 degrees of the vertical [N]."""
    force = 0.0
    for column, least, most in zip(vehicle.allocation, low, high, strict=False):
        if abs(column[2]) > VERTICAL:
            # One that points down pushes down by its forward thrust
            force += column[2] * (least if column[2] > 0.0 else most)
    return force


def _heave_per_surge(vehicle: Vehicle) -> float:
    """Return the heave per newton of surge, caused by the forward-pushing rotors [N/N]."""
    # Rotors within 60 degrees of the forward axis
    pushing = [column for column in vehicle.allocation if column[0] > 0.5]
    surge = sum(column[0] for column in pushing)
    return sum(column[2] for column in pushing) / surge if pushing else 0.0


def _reverse_share(rotor: RotorModel) -> float:
    """
    Return the reverse thrust of a rotor as a share of its forward thrust.

    1 where the reversed jet hits the hull: it then changes the direction of the column, which no
    share can express.
    """
    forward, backward = rotor.column, rotor.reverse
    # Projection of the reverse column onto the forward one
    share = sum(p * q for p, q in zip(forward, backward, strict=True))
    share /= sum(p * p for p in forward)
    along = all(
        math.isclose(q, share * p, rel_tol=1e-9, abs_tol=1e-12)
        for p, q in zip(forward, backward, strict=True)
    )
    return share if along and share > 0.0 else 1.0


def allocation_columns(vehicle: Vehicle) -> Columns:
    """Return B, one column per slot; zeros for empty slots."""
    empty: Column = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    columns = tuple(vehicle.allocation)
    return cast('Columns', columns + (empty,) * (SLOTS - len(columns)))


def thrust_curves(vehicle: Vehicle) -> tuple[PerRotor, PerRotor]:
    """Return a and b of the thrust curve T = a u^2 + b u by slot [N]."""
    return pad_to_slots(rotor.a for rotor in vehicle.rotors), pad_to_slots(
        rotor.b for rotor in vehicle.rotors
    )


def surge_drag_coefficients(vehicle: Vehicle) -> tuple[float, float]:
    """Return linear [N s/m] and quadratic [N s2/m2] drag along body x."""
    aero = vehicle.file.aero
    return aero.linear_drag.force.vector[0], aero.quadratic_drag.force.vector[0]


def build_estimator_model(vehicle: Vehicle) -> EstimatorModel:
    """Return hull, motors and sensor positions for the estimator."""
    aero = vehicle.file.aero
    a, b = thrust_curves(vehicle)
    effects = vehicle.collect_effects()
    lag = effects.get('motor_lag', {'up': 0.0, 'down': 0.0})
    sensors = vehicle.file.sensors
    imu_x, imu_y, imu_z = sensors.imu_position.vector
    x, y, z = sensors.range_position.vector
    return EstimatorModel(
        hull=HullDragModel(
            # The hull accelerates the surrounding air with it
            mass=(vehicle.mass + vehicle.added_mass[0], vehicle.mass + vehicle.added_mass[1]),
            linear=(aero.linear_drag.force.vector[0], aero.linear_drag.force.vector[1]),
            quadratic=(aero.quadratic_drag.force.vector[0], aero.quadratic_drag.force.vector[1]),
        ),
        standing_height=vehicle.hull_height_on_floor,
        imu_position=(imu_x, imu_y, imu_z),
        range_position=(x, y, z),
        number=len(vehicle.allocation),
        allocation=allocation_columns(vehicle),
        a=a,
        b=b,
        lag_up=lag['up'],
        lag_down=lag['down'],
        rate_bias=_axis_values(effects.get('gyro_bias', {})),
        force_bias=_axis_values(effects.get('imu_bias', {})),
    )


def _axis_values(values: Mapping[str, float]) -> Vector:
    """Return the x, y and z values of an effect; 0 where missing."""
    return values.get('x', 0.0), values.get('y', 0.0), values.get('z', 0.0)
