"""
The motion of a vehicle: its rate, its future, and what each effect does to it.

Compiled once per content of the effects and kept on disk (`kernel_cache`). States, commands and
surroundings are float64 arrays in the layouts of `lta_sim.state`; a shorter command or shorter
surroundings go on with zeros, so that four duties or a wind will do. The functions trust their
input: a `Model` is checked when it is built.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import final

from lta_sim.compose import kernel_source, layout_of
from lta_sim.effects import EFFECTS
from lta_sim.kernel_cache import load
from lta_sim.model import Model
from lta_sim.state import ACTUATORS, COMMAND, SURROUNDINGS
import numpy as np
from numpy.typing import ArrayLike, NDArray

State = NDArray[np.float64]
CALM = (0.0, 0.0, 0.0)

LAYOUT = layout_of(EFFECTS)


@final
@dataclass(frozen=True, slots=True)
class Look:
    """
    What acts on a vehicle at one instant.

    Attributes
    ----------
    wrenches : mapping of str to ndarray, shape (6,)
        Force and moment about the hull centre, body frame, by wrench effect. [N, N m]
    thrusts : ndarray, shape (ACTUATORS,)
        Of each rotor. [N]
    wind : ndarray, shape (3,)
        Velocity of the air at the hull, `map`. [m/s]

    """

    wrenches: Mapping[str, State]
    thrusts: State
    wind: State


@cache
def _kernel() -> ModuleType:
    """Return the kernel of all effects."""
    return load(kernel_source(EFFECTS))


def filled(what: str, values: ArrayLike, count: int) -> State:
    """
    Return a contiguous float64 array of that many numbers, zeros behind those given.

    Raises
    ------
    ValueError
        If there are more numbers, or not one row of them.

    """
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.shape == (count,):
        return array
    if array.ndim != 1 or len(array) > count:
        # Compiled code does not look: it would read what lies behind the array.
        raise ValueError(f'The {what} has shape {array.shape}; it must be at most ({count},).')
    full = np.zeros(count)
    full[: len(array)] = array
    return full


def _input(
    state: ArrayLike, command: ArrayLike, surroundings: ArrayLike
) -> tuple[State, State, State]:
    """Return what all functions take, as the kernel takes it."""
    start = np.ascontiguousarray(state, dtype=np.float64)
    if start.shape != (LAYOUT.size,):
        raise ValueError(f'The state has shape {start.shape}; it must be ({LAYOUT.size},).')
    return (
        start,
        filled('command', command, COMMAND),
        filled('surroundings', surroundings, SURROUNDINGS),
    )


def derivative(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> State:
    """
    Return d/dt of a state.

    Parameters
    ----------
    state : array_like, shape (N,)
        Layout of `lta_sim.state`, SI.
    model : Model
        The vehicle.
    command : array_like, shape (up to COMMAND,)
        Commanded duty of each rotor, -1 to 1, and the place of the moving mass.
    surroundings : array_like, shape (up to SURROUNDINGS,)
        Wind, noise, irradiance, voltage, rate of the wind.

    Returns
    -------
    ndarray, shape (N,)
        Rate of each element. [1/s]

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    start, orders, air = _input(state, command, surroundings)
    out = np.empty_like(start)
    _kernel().derivative(
        start, model.parameters, model.on, model.body, model.inverse, orders, air, out
    )
    return out


def advance(
    state: ArrayLike,
    model: Model,
    command: ArrayLike,
    surroundings: ArrayLike,
    dt: float,
    steps: int,
) -> State:
    """
    Return the state after `steps` classical Runge-Kutta steps under a constant command.

    Parameters
    ----------
    state, model, command, surroundings
        As for `derivative`.
    dt : float
        Length of a step; below about 2.7 times the shortest time constant. [s]
    steps : int
        Number of steps.

    Returns
    -------
    ndarray, shape (N,)
        The later state, its quaternion normalised after each step.

    """
    start, orders, air = _input(state, command, surroundings)
    out = np.empty_like(start)
    _kernel().advance(
        start,
        model.parameters,
        model.on,
        model.body,
        model.inverse,
        orders,
        air,
        float(dt),
        int(steps),
        out,
    )
    return out


def look(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> Look:
    """
    Return what acts on a vehicle.

    Parameters
    ----------
    state, model, command, surroundings
        As for `derivative`.

    """
    start, orders, air = _input(state, command, surroundings)
    names = LAYOUT.wrenches
    out, thrusts, wind = np.empty((len(names), 6)), np.empty(ACTUATORS), np.empty(3)
    _kernel().look(start, model.parameters, model.on, model.body, orders, air, out, thrusts, wind)
    return Look(dict(zip(names, out, strict=True)), thrusts, wind)


def thrusts(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> State:
    """Return the thrust of each rotor: `look(...).thrusts`, without the rest. [N]"""
    start, orders, air = _input(state, command, surroundings)
    out, wind = np.empty(ACTUATORS), np.empty(3)
    rows = _rows()  # written, not read
    _kernel().look(start, model.parameters, model.on, model.body, orders, air, rows, out, wind)
    return out


@cache
def _rows() -> State:
    """Return room for the wrench of each wrench effect."""
    return np.empty((len(LAYOUT.wrenches), 6))


def wrenches(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> Mapping[str, State]:
    """Return the wrench of each wrench effect: `look(...).wrenches`."""
    return look(state, model, command, surroundings).wrenches
