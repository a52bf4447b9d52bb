"""
Interface of an effect: declared parameters, and plain functions of scalars and tuples.

The functions use no arrays, so that the same source runs as plain Python (for identification),
compiled in the kernel, and on a GPU. They may use `math`, numbers and plain functions; the kernel
copies their source with everything they use. The first statement of a function unpacks `p`, the
parameters of its effect, in their declared order. An effect whose parameters are all at their
null values changes nothing, and costs one check of a flag.

The kinds follow the path of a command through the vehicle:

    command -> ActuatorEffect: duty to thrust, rotor by rotor, in registry order
    surroundings -> AirEffect: wind at the hull, summed
    both -> WrenchEffect: force and moment on the hull, summed
    BodyEffect, InertiaEffect: the vehicle's mass properties, and the air that moves with it
    MeasurementEffect: errors of a sensor, a tracker or a clock
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import final, NamedTuple

from lta_model.state import ACTUATORS

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Matrix3 = tuple[float, float, float, float, float, float, float, float, float]
Wrench = tuple[float, float, float, float, float, float]
Values = tuple[float, ...]
Names = tuple[tuple[str, float], ...]

AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')


class VehicleMotion(NamedTuple):
    """
    What a wrench effect sees of the vehicle; the layouts are those of `lta_model.state`.

    Parameters
    ----------
    position : 3-tuple
        Hull centre in `map`. [m]
    rotation : 9-tuple
        Rotation matrix body -> map, row by row.
    velocity : 3-tuple
        Velocity over the ground, body frame. [m/s]
    rates : 3-tuple
        Body rates. [rad/s]
    airspeed : 3-tuple
        Velocity relative to the air, body frame. [m/s]
    body : BODY numbers
        What the vehicle is: mass, inertia, displaced air, rotors.
    command : COMMAND numbers
        What it is told.
    surroundings : SURROUNDINGS numbers
        Light on the hull, voltage of the battery; the wind in them is in `airspeed` already.

    """

    position: Vector
    rotation: Matrix3
    velocity: Vector
    rates: Vector
    airspeed: Vector
    body: Values
    command: Values
    surroundings: Values


class AirEffectInput(NamedTuple):
    """
    What an air effect sees.

    Parameters
    ----------
    position : 3-tuple
        Hull centre in `map`. [m]
    velocity : 3-tuple
        Velocity of the hull over the ground, in `map`. [m/s]
    wind : 3-tuple
        Sum of the wind of the surroundings and of the air effects before this one, `map`. [m/s]
    surroundings : SURROUNDINGS numbers
        As in `VehicleMotion`; noise for turbulence.

    """

    position: Vector
    velocity: Vector
    wind: Vector
    surroundings: Values


class RigidBody(NamedTuple):
    """
    What a body effect changes, about the hull centre, body frame.

    Parameters
    ----------
    mass : float
        Of everything solid and of the gas. [kg]
    moment : 3-tuple
        Mass times centre of gravity. [kg m]
    inertia : 6-tuple
        xx yy zz xy xz yz of the tensor. [kg m^2]
    displaced : float
        Mass of the displaced air. [kg]

    """

    mass: float
    moment: Vector
    inertia: Wrench
    displaced: float


@final
@dataclass(frozen=True, slots=True)
class EffectParameter:
    """
    One number of an effect.

    Parameters
    ----------
    name : str
        Name within the effect.
    unit : str
        SI unit; '1' for a pure number.
    null : float
        The value that, with all others of the effect at theirs, makes it change nothing.
    low, high : float
        Bounds for any vehicle; the null value is always allowed.
    spread : float
        Prior standard deviation of a plausible deviation, for identification.
    source : str
        Where bounds and spread come from.
    beside : float, optional
        What it is taken to be where identification tries the other numbers of an effect that a
        vehicle lacks, which alone would do nothing; then it is not tried itself.

    """

    name: str
    unit: str
    null: float
    low: float
    high: float
    spread: float
    source: str
    beside: float | None = None


def no_check(values: Mapping[str, float]) -> str:
    """Return no objection: the bounds of each parameter suffice."""
    del values
    return ''


def no_rate(p: Values, memory: Values, inputs: VehicleMotion | AirEffectInput) -> Values:
    """Return an empty rate, for an effect without memory."""
    del p, memory, inputs
    return ()


@final
@dataclass(frozen=True, slots=True)
class WrenchEffect:
    """
    A force and moment on the vehicle.

    Parameters
    ----------
    name : str
        Name in vehicle files and topics.
    parameters : tuple of Parameter
        Their order is the order of `p`.
    wrench : callable
        `wrench(p, memory, motion, thrust) -> (fx, fy, fz, tx, ty, tz)`: body frame, about the hull
        centre; `thrust` of each rotor after all actuator effects [N]. [N, N m]
    linear_in : tuple of str
        Parameters in which the wrench is jointly linear, the others held.
    memory : tuple of (str, float)
        Names and initial values of its states.
    rate : callable
        `rate(p, memory, motion) -> tuple`: d/dt of the memory. [1/s]
    placed : bool
        Whether it knows places or directions of the map, as walls do.
    check : callable
        Returns why a combination of values is impossible, or ''.

    """

    name: str
    parameters: tuple[EffectParameter, ...]
    wrench: Callable[[Values, Values, VehicleMotion, Values], Wrench]
    linear_in: tuple[str, ...] = ()
    memory: Names = ()
    rate: Callable[[Values, Values, VehicleMotion], Values] = no_rate
    placed: bool = False
    check: Callable[[Mapping[str, float]], str] = no_check


@final
@dataclass(frozen=True, slots=True)
class AirEffect:
    """
    Motion of the air at the hull.

    Parameters
    ----------
    name, parameters, memory, check
        As for WrenchEffect.
    air : callable
        `air(p, memory, place) -> (u, v, w, a_u, a_v, a_w)`: velocity of the air and its
        acceleration DU/Dt, following the air, in `map`. [m/s, m/s^2]
    rate : callable
        `rate(p, memory, place) -> tuple`: d/dt of the memory. [1/s]

    """

    name: str
    parameters: tuple[EffectParameter, ...]
    air: Callable[[Values, Values, AirEffectInput], Wrench]
    memory: Names = ()
    rate: Callable[[Values, Values, AirEffectInput], Values] = no_rate
    check: Callable[[Mapping[str, float]], str] = no_check


def no_rotor_rate(p: Values, memory: Values, value: float, surroundings: Values) -> Values:
    """Return an empty rate, for an effect without memory."""
    del p, memory, value, surroundings
    return ()


@cache
def _expand_rotor_parameters(each: tuple[EffectParameter, ...]) -> tuple[EffectParameter, ...]:
    """Return the parameters of all rotors, parameter by parameter."""
    return tuple(replace(p, name=f'{p.name}_{i}') for p in each for i in range(1, ACTUATORS + 1))


@final
@dataclass(frozen=True, slots=True)
class ActuatorEffect:
    """
    What becomes of a commanded duty on its way to a thrust; applied in registry order.

    A duty goes in at the first and newtons come out of the last. `p` holds the shared parameters
    and then the rotor's own.

    Parameters
    ----------
    name, check
        As for WrenchEffect.
    shared : tuple of Parameter
        Of all rotors alike.
    each : tuple of Parameter
        Of each rotor; in files `<name>_1` to `<name>_8`.
    output : callable
        `output(p, memory, value, surroundings) -> value` of one rotor; `memory` is a tuple.
    memory : tuple of (str, float)
        Names and initial values of its states, for each rotor.
    rate : callable
        `rate(p, memory, value, surroundings) -> tuple`: d/dt of the memory of one rotor. [1/s]

    """

    name: str
    shared: tuple[EffectParameter, ...]
    each: tuple[EffectParameter, ...]
    output: Callable[[Values, Values, float, Values], float]
    memory: Names = ()
    rate: Callable[[Values, Values, float, Values], Values] = no_rotor_rate
    check: Callable[[Mapping[str, float]], str] = no_check

    @property
    def parameters(self) -> tuple[EffectParameter, ...]:
        """All parameters: the shared ones, then those of each rotor, parameter by parameter."""
        return (*self.shared, *_expand_rotor_parameters(self.each))


@final
@dataclass(frozen=True, slots=True)
class InertiaEffect:
    """
    Inertia of the air that moves with the hull.

    Parameters
    ----------
    name, parameters, check
        As for WrenchEffect.
    diagonal : callable
        `diagonal(p) -> 6-tuple` added to the diagonal of the mass matrix; its momentum follows
        the air-relative velocity. [kg, kg m^2]

    """

    name: str
    parameters: tuple[EffectParameter, ...]
    diagonal: Callable[[Values], Wrench]
    check: Callable[[Mapping[str, float]], str] = no_check


@final
@dataclass(frozen=True, slots=True)
class BodyEffect:
    """
    A change of what the vehicle weighs or displaces; mass, inertia, weight and balance follow.

    Parameters
    ----------
    name, parameters, check
        As for WrenchEffect.
    change : callable
        `change(p, rigid) -> rigid`; applied in registry order when a model is built.

    """

    name: str
    parameters: tuple[EffectParameter, ...]
    change: Callable[[Values, RigidBody], RigidBody]
    check: Callable[[Mapping[str, float]], str] = no_check


# Channels of the measurement effects, with the number of values in a reading.
CHANNELS = {
    'rates': 3,  # of the gyroscope, body frame [rad/s]
    'force': 3,  # of the accelerometer, body frame [m/s2]
    'pressure': 1,  # [Pa]
    'range': 1,  # [m]
    'pose': 7,  # of the tracker: position in its frame [m] and quaternion x y z w
    'pose_time': 1,  # flight time at which the reported pose was true [s]
    'command_time': 1,  # flight time of the command that the rotors obey now [s]
    'clock': 1,  # what the vehicle's clock stamps at a flight time [s]
}


@final
@dataclass(frozen=True, slots=True)
class MeasurementEffect:
    """
    What becomes of the truth on its way to a reading; effects of a channel act in registry order.

    Parameters
    ----------
    name, parameters, check
        As for WrenchEffect.
    channel : str
        A key of `CHANNELS`.
    reading : callable
        `reading(p, values, time) -> values`; `time` is that of the flight. [s]

    """

    name: str
    parameters: tuple[EffectParameter, ...]
    channel: str
    reading: Callable[[Values, Values, float], Values]
    check: Callable[[Mapping[str, float]], str] = no_check


# In the kernel, outside of it.
KernelEffect = WrenchEffect | AirEffect | ActuatorEffect
Effect = KernelEffect | InertiaEffect | BodyEffect | MeasurementEffect
