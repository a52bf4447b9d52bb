"""
Draw the manufacturing tolerances of a vehicle and the sensor errors of a flight.

The standard deviations are defined here independently of the tolerances that discovery assumes.
"""

from dataclasses import replace
import math
from typing import Final

from lta_discovery.model.nominal import NominalVehicle
import numpy as np

Draw = np.random.Generator

# Standard deviations of a vehicle; relative unless a unit is given
MASS: Final = 0.01
INERTIA: Final = 0.04
DRAG: Final = 0.05
AIR: Final = 0.05  # added mass and inertia
THRUST: Final = 0.03  # common to all rotors
ROTOR: Final = 0.02  # each rotor
LAG: Final = 0.006  # s
DELAY: Final = 0.005  # s
TOE: Final = math.radians(0.5)  # rad; misalignment of a rotor axis
DEPTH: Final = 0.003  # m; height of the centre of gravity
BESIDE: Final = 0.0005  # m; horizontal position of the centre of gravity
# Standard deviations of a flight
LIFT: Final = 0.0006  # N
GYRO: Final = math.radians(0.5)  # rad/s; bias
SCALE: Final = 0.006  # scale error of the gyroscope
FORCE: Final = 0.05  # m/s2; bias of the accelerometer
RANGE: Final = 0.008  # m
DRIFT: Final = 0.002  # Pa/s; drift of the pressure sensor


def _scale_effect(nominal: NominalVehicle, effect: str, part: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with a relative error in each parameter of an effect."""
    for name, value in nominal.effect_parameters.get(effect, {}).items():
        factor = 1.0 + part * float(draw.standard_normal())
        # Coefficients such as drag must not change their sign
        nominal = nominal.with_value(effect, name, value * max(factor, 0.0))
    return nominal


def _perturb_drag(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with drag errors."""
    for axis in ('surge', 'sway', 'heave'):
        factor = 1.0 + DRAG * wide * float(draw.standard_normal())
        # One factor per axis: effects that share a coefficient must stay consistent
        for effect in ('linear_drag', 'quadratic_drag', 'cross_flow'):
            if axis in nominal.effect_parameters.get(effect, {}):
                now = nominal.parameter_value(effect, axis)
                nominal = nominal.with_value(effect, axis, now * factor)
    return _scale_effect(nominal, 'rotational_drag', DRAG * wide, draw)


def _perturb_mass(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with errors of mass and inertia; it is trimmed, so its lift follows."""
    more = nominal.mass * MASS * wide * float(draw.standard_normal())
    factors = np.sqrt(np.maximum(1.0 + INERTIA * wide * draw.standard_normal(3), 0.5))
    return replace(
        nominal,
        mass=nominal.mass + more,
        # The vehicle is trimmed: more mass is compensated by more lift
        displaced=nominal.displaced + more,
        # Scaling with an outer product keeps the matrix symmetric and positive definite
        inertia=nominal.inertia * np.outer(factors, factors),
    )


def _perturb_rotors(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with errors of thrust, rotor axes, lag and delay."""
    for i in range(1, len(nominal.rotors) + 1):
        factor = 1.0 + ROTOR * wide * float(draw.standard_normal())
        for c in ('a', 'b'):
            now = nominal.parameter_value('thrust_curve', f'{c}_{i}')
            nominal = nominal.with_value('thrust_curve', f'{c}_{i}', now * factor)
        for turn in ('first', 'second'):
            tilt = TOE * wide * float(draw.standard_normal())
            nominal = _add_to_parameter(nominal, 'rotor_misalignment', f'{turn}_{i}', tilt)
    nominal = _add_to_parameter(
        nominal, 'thrust_scale', 'factor', THRUST * wide * draw.standard_normal()
    )
    lag = LAG * wide * float(draw.standard_normal())
    for way in ('up', 'down'):
        # A vehicle without a motor lag gets none, since the lag could become negative
        if nominal.parameter_value('motor_lag', way) > 0.0:
            nominal = _add_to_parameter(nominal, 'motor_lag', way, lag)
    # A delay cannot be negative
    return _add_to_parameter(
        nominal, 'command_delay', 'delay', abs(DELAY * wide * draw.standard_normal())
    )


def _add_to_parameter(
    nominal: NominalVehicle, effect: str, name: str, more: float
) -> NominalVehicle:
    """Return a vehicle with an offset of a parameter."""
    return nominal.with_value(effect, name, nominal.parameter_value(effect, name) + float(more))


def perturb_vehicle(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """
    Return a vehicle with random errors within its tolerances.

    `nominal`: vehicle of the file, possibly with hidden effects. `wide`: factor on all standard
    deviations.
    """
    nominal = _perturb_rotors(
        _perturb_drag(_perturb_mass(nominal, wide, draw), wide, draw), wide, draw
    )
    for effect in ('added_mass', 'added_inertia'):
        nominal = _scale_effect(nominal, effect, AIR * wide, draw)
    nominal = _add_to_parameter(nominal, 'cg_height', 'z', DEPTH * wide * draw.standard_normal())
    for axis in 'xy':
        nominal = _add_to_parameter(
            nominal, 'cg_offset', axis, BESIDE * wide * draw.standard_normal()
        )
    return nominal


def apply_flight_errors(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with the errors of one flight: lift and sensor biases."""
    nominal = _add_to_parameter(nominal, 'net_lift', 'force', LIFT * wide * draw.standard_normal())
    for axis in 'xyz':
        nominal = _add_to_parameter(
            nominal, 'gyro_bias', axis, GYRO * wide * draw.standard_normal()
        )
        nominal = _add_to_parameter(
            nominal, 'gyro_scale', axis, SCALE * wide * draw.standard_normal()
        )
        nominal = _add_to_parameter(
            nominal, 'imu_bias', axis, FORCE * wide * draw.standard_normal()
        )
    nominal = _add_to_parameter(
        nominal, 'range_offset', 'offset', RANGE * wide * draw.standard_normal()
    )
    return _add_to_parameter(
        nominal, 'pressure_drift', 'rate', DRIFT * wide * draw.standard_normal()
    )
