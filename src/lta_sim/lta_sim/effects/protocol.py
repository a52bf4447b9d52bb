"""
What an effect is: parameters declared as data, and one plain function of scalars and tuples.

The functions are written without arrays, so that the same source runs as plain Python (for
identification), compiled in the kernel, and later on a GPU. They may use `math`, numbers and plain
functions; the kernel takes their source with everything they use. The first statement of a
function unpacks `p`, its effect's parameters, in the order in which the effect declares them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import final, NamedTuple

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Matrix3 = tuple[float, float, float, float, float, float, float, float, float]
Duty = tuple[float, float, float, float]
Wrench = tuple[float, float, float, float, float, float]
Values = tuple[float, ...]

AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')


class Motion(NamedTuple):
    """
    What a wrench effect sees of the vehicle.

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

    """

    position: Vector
    rotation: Matrix3
    velocity: Vector
    rates: Vector
    airspeed: Vector


@final
@dataclass(frozen=True, slots=True)
class Parameter:
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

    """

    name: str
    unit: str
    null: float
    low: float
    high: float
    spread: float
    source: str


def no_check(values: Mapping[str, float]) -> str:
    """Return no objection: the bounds of each parameter say it all."""
    del values
    return ''


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
        `wrench(p, motion, duty) -> (fx, fy, fz, tx, ty, tz)`: body frame, about the hull centre,
        `duty` as the rotors turn after all actuator effects. [N, N m]
    linear_in : tuple of str
        Parameters in which the wrench is jointly linear, the others held.
    check : callable
        Returns why a combination of values is impossible, or ''.

    """

    name: str
    parameters: tuple[Parameter, ...]
    wrench: Callable[[Values, Motion, Duty], Wrench]
    linear_in: tuple[str, ...] = ()
    check: Callable[[Mapping[str, float]], str] = no_check


@final
@dataclass(frozen=True, slots=True)
class ActuatorEffect:
    """
    What becomes of a commanded duty on its way to a rotor; applied in registry order.

    Parameters
    ----------
    name, parameters, check
        As for WrenchEffect.
    memory : tuple of (str, float)
        Names and initial values of its states, for each rotor.
    output : callable
        `output(p, memory, duty) -> duty` of one rotor; `memory` is a tuple.
    rate : callable
        `rate(p, memory, duty) -> tuple`: d/dt of the memory of one rotor. [1/s]

    """

    name: str
    parameters: tuple[Parameter, ...]
    memory: tuple[tuple[str, float], ...]
    output: Callable[[Values, Values, float], float]
    rate: Callable[[Values, Values, float], Values]
    check: Callable[[Mapping[str, float]], str] = no_check


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
    parameters: tuple[Parameter, ...]
    diagonal: Callable[[Values], Wrench]
    check: Callable[[Mapping[str, float]], str] = no_check


Effect = WrenchEffect | ActuatorEffect | InertiaEffect
