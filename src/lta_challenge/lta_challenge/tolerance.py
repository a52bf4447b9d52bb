"""
How far a vehicle is off from its file without anything being wrong with it.

Written down here and not taken from the model under test, whose own list says what it believes.
"""

from dataclasses import replace
import math
from typing import Final

from lta_discovery.model.nominal import NominalVehicle
import numpy as np

Draw = np.random.Generator

# Standard deviations: parts of 1, else SI.
MASS: Final = 0.01
INERTIA: Final = 0.04
DRAG: Final = 0.05
AIR: Final = 0.05  # that moves with the hull
THRUST: Final = 0.03
ROTOR: Final = 0.02
LAG: Final = 0.006
DELAY: Final = 0.005
TOE: Final = math.radians(0.5)
DEPTH: Final = 0.003
BESIDE: Final = 0.0005
# Of each flight anew.
LIFT: Final = 0.0006
GYRO: Final = math.radians(0.5)
SCALE: Final = 0.006
FORCE: Final = 0.05
RANGE: Final = 0.008
DRIFT: Final = 0.002


def _scale_effect(nominal: NominalVehicle, effect: str, part: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with each number of an effect off by a part of itself."""
    for name, value in nominal.given.get(effect, {}).items():
        factor = 1.0 + part * float(draw.standard_normal())
        nominal = nominal.with_value(effect, name, value * max(factor, 0.0))
    return nominal


def _perturb_drag(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with its drag off; the coefficients that two effects share stay one."""
    for axis in ('surge', 'sway', 'heave'):
        factor = 1.0 + DRAG * wide * float(draw.standard_normal())
        for effect in ('linear_drag', 'quadratic_drag', 'cross_flow'):
            if axis in nominal.given.get(effect, {}):
                now = nominal.parameter_value(effect, axis)
                nominal = nominal.with_value(effect, axis, now * factor)
    return _scale_effect(nominal, 'rotational_drag', DRAG * wide, draw)


def _perturb_mass(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with mass (trimmed all the same) and inertia off."""
    more = nominal.mass * MASS * wide * float(draw.standard_normal())
    factors = np.sqrt(np.maximum(1.0 + INERTIA * wide * draw.standard_normal(3), 0.5))
    return replace(
        nominal,
        mass=nominal.mass + more,
        displaced=nominal.displaced + more,
        inertia=nominal.inertia * np.outer(factors, factors),
    )


def _perturb_rotors(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle with thrust, toe, lag and delay of its rotors off."""
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
        if nominal.parameter_value('motor_lag', way) > 0.0:
            nominal = _add_to_parameter(nominal, 'motor_lag', way, lag)
    return _add_to_parameter(
        nominal, 'command_delay', 'delay', abs(DELAY * wide * draw.standard_normal())
    )


def _add_to_parameter(
    nominal: NominalVehicle, effect: str, name: str, more: float
) -> NominalVehicle:
    """Return a vehicle with something added to a parameter."""
    return nominal.with_value(effect, name, nominal.parameter_value(effect, name) + float(more))


def perturb_vehicle(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """
    Return a vehicle that is off from its file as vehicles are.

    Parameters
    ----------
    nominal : Nominal
        As its file has it, or with something hidden.
    wide : float
        Factor on all deviations.
    draw : Generator
        Where chance comes from.

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


def perturb_flight(nominal: NominalVehicle, wide: float, draw: Draw) -> NominalVehicle:
    """Return a vehicle on one day: its lift and the biases of its sensors."""
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
