"""What the control cores need to know of a vehicle, taken from its file's nominal numbers."""

from lta_control.airspeed import Hull
from lta_control.allocation import Rotors
from lta_control.estimator import Body
from lta_sim.vehicle import Vehicle


def rotors_of(vehicle: Vehicle) -> Rotors:
    """Return the rotors for the allocation."""
    a, b = vehicle.thrust_curve
    full = vehicle.full_thrust
    low = tuple(-full if reversible else 0.0 for reversible in vehicle.reversible)
    lows = zip(vehicle.allocation, low, strict=True)
    return Rotors(
        allocation=vehicle.allocation,
        low=low,
        high=(full,) * len(vehicle.reversible),
        lowest_heave=sum(column[2] * least for column, least in lows if column[2] > 0.5),
        a=a,
        b=b,
    )


def surge_drag_of(vehicle: Vehicle) -> tuple[float, float]:
    """Return linear [N s/m] and quadratic [N s2/m2] drag along body x."""
    aero = vehicle.file.aero
    return aero.linear_drag.force.vector[0], aero.quadratic_drag.force.vector[0]


def body_of(vehicle: Vehicle) -> Body:
    """Return the hull, motors and sensor places for the estimator."""
    aero = vehicle.file.aero
    a, b = vehicle.thrust_curve
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
        allocation=vehicle.allocation,
        a=a,
        b=b,
        lag_up=lag['up'],
        lag_down=lag['down'],
    )
