"""What the control cores need to know of a vehicle, taken from its file's nominal numbers."""

from collections.abc import Mapping
import math
from typing import cast

from lta_control.airspeed import HullDragModel
from lta_control.allocation import ALIKE, Column, Columns, Rotors, WEIGHTS, Wrench
from lta_control.attitude import Vector
from lta_control.estimator import EstimatorModel
from lta_control.per_rotor import pad_to_slots, PerRotor, SLOTS
from lta_model.propulsion import RotorUnit
from lta_model.vehicle import Vehicle


def build_rotors(vehicle: Vehicle, weights: Wrench = WEIGHTS) -> Rotors:
    """
    Return the rotors for the allocation.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle, each rotor by its own thrust curve.
    weights : tuple of float
        What gives way first where the rotors cannot do everything, see `allocate`.

    """
    a, b = thrust_curves(vehicle)
    reverse = tuple(_reverse_share(rotor) for rotor in vehicle.rotors)
    high = tuple(p + q for p, q in zip(a, b, strict=True))
    low = tuple(
        -full * share if rotor.reversible else 0.0
        for rotor, full, share in zip(vehicle.rotors, high, reverse, strict=False)
    )
    lows = zip(vehicle.allocation, low, strict=True)
    return Rotors(
        number=len(vehicle.allocation),
        allocation=allocation_columns(vehicle),
        low=pad_to_slots(low),
        high=pad_to_slots(high),
        lowest_heave=sum(column[2] * least for column, least in lows if column[2] > 0.5),
        a=a,
        b=b,
        reverse=cast('PerRotor', reverse + ALIKE[len(reverse) :]),
        weights=weights,
        sink=_heave_per_surge(vehicle),
    )


def _heave_per_surge(vehicle: Vehicle) -> float:
    """Return the heave that comes with a newton of surge from the rotors that push on. [N/N]"""
    pushing = [column for column in vehicle.allocation if column[0] > 0.5]
    surge = sum(column[0] for column in pushing)
    return sum(column[2] for column in pushing) / surge if pushing else 0.0


def _reverse_share(rotor: RotorUnit) -> float:
    """
    Return how much a rotor pushes reversed, as a share of forward; 1 where its jet tells.

    A thrust that is not the same in reverse stands in the column: the same direction, less of it.
    A jet that meets the hull turns the column, which no share can say.
    """
    forward, backward = rotor.column, rotor.reverse
    share = sum(p * q for p, q in zip(forward, backward, strict=True))
    share /= sum(p * p for p in forward)
    along = all(
        math.isclose(q, share * p, rel_tol=1e-9, abs_tol=1e-12)
        for p, q in zip(forward, backward, strict=True)
    )
    return share if along and share > 0.0 else 1.0


def allocation_columns(vehicle: Vehicle) -> Columns:
    """Return B, a column a slot; an empty slot's is zero."""
    empty: Column = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    columns = tuple(vehicle.allocation)
    return cast('Columns', columns + (empty,) * (SLOTS - len(columns)))


def thrust_curves(vehicle: Vehicle) -> tuple[PerRotor, PerRotor]:
    """Return the thrust curve of each slot: a and b of T = a u^2 + b u. [N]"""
    return pad_to_slots(rotor.a for rotor in vehicle.rotors), pad_to_slots(
        rotor.b for rotor in vehicle.rotors
    )


def surge_drag_coefficients(vehicle: Vehicle) -> tuple[float, float]:
    """Return linear [N s/m] and quadratic [N s2/m2] drag along body x."""
    aero = vehicle.file.aero
    return aero.linear_drag.force.vector[0], aero.quadratic_drag.force.vector[0]


def build_estimator_model(vehicle: Vehicle) -> EstimatorModel:
    """Return the hull, motors and sensor places for the estimator."""
    aero = vehicle.file.aero
    a, b = thrust_curves(vehicle)
    effects = vehicle.collect_effects()
    lag = effects.get('motor_lag', {'up': 0.0, 'down': 0.0})
    sensors = vehicle.file.sensors
    imu_x, imu_y, imu_z = sensors.imu_position.vector
    x, y, z = sensors.range_position.vector
    return EstimatorModel(
        hull=HullDragModel(
            mass=(vehicle.mass + vehicle.added_mass[0], vehicle.mass + vehicle.added_mass[1]),
            linear=(aero.linear_drag.force.vector[0], aero.linear_drag.force.vector[1]),
            quadratic=(aero.quadratic_drag.force.vector[0], aero.quadratic_drag.force.vector[1]),
        ),
        standing_height=vehicle.height_on_floor,
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
    """Return what a file tells of each axis, 0 where it tells nothing."""
    return values.get('x', 0.0), values.get('y', 0.0), values.get('z', 0.0)
