"""What the control cores need to know of a vehicle, taken from its file's nominal numbers."""

from typing import cast

from lta_control.airspeed import Hull
from lta_control.allocation import Column, Columns, Rotors
from lta_control.estimator import Body
from lta_control.per_rotor import PerRotor, SLOTS, slots
from lta_sim.vehicle import Vehicle


def rotors_of(vehicle: Vehicle) -> Rotors:
    """Return the rotors for the allocation."""
    a, b = curves_of(vehicle)
    high = tuple(p + q for p, q in zip(a, b, strict=True))
    reverses = zip(vehicle.reversible, high, strict=False)
    low = tuple(-full if reversible else 0.0 for reversible, full in reverses)
    lows = zip(vehicle.allocation, low, strict=True)
    return Rotors(
        number=len(vehicle.allocation),
        allocation=columns_of(vehicle),
        low=slots(low),
        high=slots(high),
        lowest_heave=sum(column[2] * least for column, least in lows if column[2] > 0.5),
        a=a,
        b=b,
    )


def columns_of(vehicle: Vehicle) -> Columns:
    """Return B, a column a slot; an empty slot's is zero."""
    empty: Column = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    columns = tuple(vehicle.allocation)
    return cast('Columns', columns + (empty,) * (SLOTS - len(columns)))


def curves_of(vehicle: Vehicle) -> tuple[PerRotor, PerRotor]:
    """Return the thrust curve of each slot: a and b of T = a u^2 + b u. [N]"""
    a, b = vehicle.thrust_curve
    count = len(vehicle.allocation)
    return slots((a,) * count), slots((b,) * count)


def surge_drag_of(vehicle: Vehicle) -> tuple[float, float]:
    """Return linear [N s/m] and quadratic [N s2/m2] drag along body x."""
    aero = vehicle.file.aero
    return aero.linear_drag.force.vector[0], aero.quadratic_drag.force.vector[0]


def body_of(vehicle: Vehicle) -> Body:
    """Return the hull, motors and sensor places for the estimator."""
    aero = vehicle.file.aero
    a, b = curves_of(vehicle)
    lag = vehicle.effects().get('motor_lag', {'up': 0.0, 'down': 0.0})
    sensors = vehicle.file.sensors
    imu_x, imu_y, imu_z = sensors.imu_position.vector
    x, y, z = sensors.range_position.vector
    return Body(
        hull=Hull(
            mass=(vehicle.mass + vehicle.added_mass[0], vehicle.mass + vehicle.added_mass[1]),
            linear=(aero.linear_drag.force.vector[0], aero.linear_drag.force.vector[1]),
            quadratic=(aero.quadratic_drag.force.vector[0], aero.quadratic_drag.force.vector[1]),
        ),
        standing_height=vehicle.standing_height,
        imu_position=(imu_x, imu_y, imu_z),
        range_position=(x, y, z),
        number=len(vehicle.allocation),
        allocation=columns_of(vehicle),
        a=a,
        b=b,
        lag_up=lag['up'],
        lag_down=lag['down'],
    )
