# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Interface of an effect: declared parameters, and plain functions of scalars and tuples.

The functions use no arrays, so that the same source runs as plain Python (for identification),
compiled in the kernel, and on a GPU. They may use `math`, numbers and plain functions; the kernel
copies their source with everything they use. A function begins by unpacking `p`, the parameters
of its effect, in their declared order, alone or by slices. The docstring of the main one says what
the effect is: equation, source, and what is not modelled. An effect whose parameters are all at
their null values changes nothing, and costs one check of a flag.

The kinds follow the path of a command through the vehicle:

    command -> ActuatorEffect: duty to thrust, rotor by rotor, in registry order
    surroundings -> AirEffect: wind at the hull, summed
    both -> WrenchEffect: force and moment on the hull, summed
    BodyEffect, InertiaEffect: the vehicle's mass properties, and the air that moves with it
    MeasurementEffect: errors of a sensor, a tracker or a clock
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
import inspect
from typing import final, NamedTuple

from lta_model.state import ACTUATORS

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Matrix3 = tuple[float, float, float, float, float, float, float, float, float]
Wrench = tuple[float, float, float, float, float, float]
Values = tuple[float, ...]
Names = tuple[tuple[str, float], ...]

# Six components of a wrench or of a diagonal matrix, in this order
AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')


class VehicleMotion(NamedTuple):
    """State of the vehicle as a wrench effect sees it, in the layouts of `lta_model.state`."""

    position: Vector  # hull centre in `map` [m]
    rotation: Matrix3  # rotation matrix body -> map, row by row
    # Velocity over the ground and body rates, body frame [m/s, rad/s]
    velocity: Vector
    rates: Vector
    airspeed: Vector  # velocity relative to the air, body frame [m/s]
    # Mass properties and rotors; the command
    body: Values
    command: Values
    # Light on the hull, battery voltage; `airspeed` already includes the wind
    surroundings: Values


class AirEffectInput(NamedTuple):
    """
    Input of an air effect, in `map`: hull centre [m], ground velocity and wind [m/s].

    `wind` is the sum of the surroundings' wind and of the air effects before this one.
    """

    position: Vector
    velocity: Vector
    wind: Vector
    surroundings: Values


class RigidBody(NamedTuple):
    """Mass properties that a body effect changes, about the hull centre, body frame."""

    mass: float  # mass of all solid parts and of the gas [kg]
    moment: Vector  # mass times centre of gravity [kg m]
    inertia: Wrench  # xx yy zz xy xz yz of the tensor [kg m^2]
    displaced: float  # mass of the displaced air [kg]


@final
@dataclass(frozen=True, slots=True)
class EffectParameter:
    """One parameter of an effect."""

    name: str
    unit: str  # SI unit; '1' for a pure number
    null: float  # neutral value: with all parameters at theirs, the effect changes nothing
    # Bounds for any vehicle; the null value is always allowed
    low: float
    high: float
    spread: float  # prior standard deviation for identification
    source: str  # source of bounds and spread
    # Value held while identification tries other parameters of an effect that a vehicle lacks and
    # that alone would do nothing; this one is then not tried itself
    beside: float | None = None


def declare_each(
    names: Iterable[str],
    unit: str,
    null: float,
    low: float,
    high: float,
    spread: float,
    source: str,
) -> tuple[EffectParameter, ...]:
    """Return parameters that differ in their names only."""
    return tuple(EffectParameter(name, unit, null, low, high, spread, source) for name in names)


def no_check(values: Mapping[str, float]) -> str:
    """Return no objection: the bounds of each parameter suffice."""
    # The signature is fixed by the protocol
    del values
    return ''


def no_rate(p: Values, memory: Values, inputs: VehicleMotion | AirEffectInput) -> Values:
    """Return an empty rate, for an effect without memory."""
    del p, memory, inputs
    return ()


@final
@dataclass(frozen=True, slots=True)
class WrenchEffect:
    """A force and moment on the vehicle."""

    name: str
    parameters: tuple[EffectParameter, ...]  # in the order of `p`
    # `wrench(p, memory, motion, thrust) -> (fx, fy, fz, tx, ty, tz)`: body frame, about the hull
    # centre [N, N m]; `thrust` of each rotor after all actuator effects [N]
    wrench: Callable[[Values, Values, VehicleMotion, Values], Wrench]
    # Parameters in which the wrench is jointly linear, the others held
    linear_in: tuple[str, ...] = ()
    memory: Names = ()  # names and initial values of its states
    # `rate(p, memory, motion) -> tuple`: d/dt of the memory [1/s]
    rate: Callable[..., Values] = no_rate
    placed: bool = False  # whether it depends on the world pose, as walls do
    # Returns an objection to a combination of values, or ''
    check: Callable[[Mapping[str, float]], str] = no_check


@final
@dataclass(frozen=True, slots=True)
class AirEffect:
    """Motion of the air at the hull; other fields as in `WrenchEffect`."""

    name: str
    parameters: tuple[EffectParameter, ...]
    # `air(p, memory, place) -> (u, v, w, a_u, a_v, a_w)`: velocity of the air and its material
    # acceleration DU/Dt in `map` [m/s, m/s^2]
    air: Callable[[Values, Values, AirEffectInput], Wrench]
    memory: Names = ()
    # `rate(p, memory, place) -> tuple`: d/dt of the memory [1/s]
    rate: Callable[[Values, Values, AirEffectInput], Values] = no_rate
    check: Callable[[Mapping[str, float]], str] = no_check


def no_rotor_rate(p: Values, memory: Values, value: float, surroundings: Values) -> Values:
    """Return an empty rate, for an effect without memory."""
    del p, memory, value, surroundings
    return ()


# Registry and kernel read the same tuple many times
@cache
def _expand_rotor_parameters(each: tuple[EffectParameter, ...]) -> tuple[EffectParameter, ...]:
    # Parameter by parameter, not rotor by rotor: the layout of the parameter vector
    return tuple(replace(p, name=f'{p.name}_{i}') for p in each for i in range(1, ACTUATORS + 1))


@final
@dataclass(frozen=True, slots=True)
class ActuatorEffect:
    """
    A stage from commanded duty to thrust; applied in registry order.

    The first stage takes a duty, the last returns newtons. `p` holds the shared parameters and
    then those of the rotor. Other fields as in `WrenchEffect`.
    """

    name: str
    # Of all rotors alike, and of each rotor: in files `<name>_1` to `<name>_8`
    shared: tuple[EffectParameter, ...]
    each: tuple[EffectParameter, ...]
    # `output(p, memory, value, surroundings) -> value` of one rotor
    output: Callable[[Values, Values, float, Values], float]
    memory: Names = ()  # names and initial values of its states, for each rotor
    # `rate(p, memory, value, surroundings) -> tuple`: d/dt of the memory of one rotor [1/s]
    rate: Callable[[Values, Values, float, Values], Values] = no_rotor_rate
    check: Callable[[Mapping[str, float]], str] = no_check

    @property
    def parameters(self) -> tuple[EffectParameter, ...]:
        """All parameters: the shared ones, then those of each rotor, parameter by parameter."""
        return (*self.shared, *_expand_rotor_parameters(self.each))


@final
@dataclass(frozen=True, slots=True)
class InertiaEffect:
    """Inertia of the air that moves with the hull; other fields as in `WrenchEffect`."""

    name: str
    parameters: tuple[EffectParameter, ...]
    # `diagonal(p) -> 6-tuple` added to the diagonal of the mass matrix; its momentum follows the
    # air-relative velocity [kg, kg m^2]
    diagonal: Callable[[Values], Wrench]
    check: Callable[[Mapping[str, float]], str] = no_check


@final
@dataclass(frozen=True, slots=True)
class BodyEffect:
    """
    A change of the mass properties or the displaced air; other fields as in `WrenchEffect`.

    `change(p, rigid) -> rigid` is applied in registry order when a model is built.
    """

    name: str
    parameters: tuple[EffectParameter, ...]
    change: Callable[[Values, RigidBody], RigidBody]
    check: Callable[[Mapping[str, float]], str] = no_check


# Channels of the measurement effects, with the number of values in a reading.
CHANNEL_SIZES = {
    'rates': 3,  # of the gyroscope, body frame [rad/s]
    'force': 3,  # of the accelerometer, body frame [m/s2]
    'pressure': 1,  # [Pa]
    'range': 1,  # [m]
    'pose': 7,  # of the tracker: position in its frame [m] and quaternion x y z w
    'pose_time': 1,  # flight time at which the reported pose was true [s]
    'command_time': 1,  # flight time of the command that the rotors obey now [s]
    'command_wrench': 6,  # commanded force and moment, body frame [N, N m]
    'clock': 1,  # what the vehicle's clock stamps at a flight time [s]
}


@final
@dataclass(frozen=True, slots=True)
class MeasurementEffect:
    """
    A stage from the true value to a reading; effects of a channel act in registry order.

    `channel` is a key of `CHANNEL_SIZES`; `reading(p, values, time) -> values` gets the flight
    time [s]. Other fields as in `WrenchEffect`.
    """

    name: str
    parameters: tuple[EffectParameter, ...]
    channel: str
    reading: Callable[[Values, Values, float], Values]
    check: Callable[[Mapping[str, float]], str] = no_check


# In the kernel, outside of it.
KernelEffect = WrenchEffect | AirEffect | ActuatorEffect
Effect = KernelEffect | InertiaEffect | BodyEffect | MeasurementEffect


def describe_effect(effect: Effect) -> str:
    """Return the first sentence about an effect: that of its main function, without its period."""
    name = {
        AirEffect: 'air',
        ActuatorEffect: 'output',
        WrenchEffect: 'wrench',
        InertiaEffect: 'diagonal',
        BodyEffect: 'change',
        MeasurementEffect: 'reading',
    }[type(effect)]
    # Up to the first blank line
    text = ' '.join((inspect.getdoc(getattr(effect, name)) or '').split('\n\n')[0].split())
    return text.rstrip('.')
