"""
The motion of a vehicle: its rate, its future, and what each effect does to it.

Compiled once per content of the effects and kept on disk (`kernel_cache`). States, commands and
surroundings are float64 arrays in the layouts of `lta_model.state`; a shorter command or shorter
surroundings go on with zeros, so that four duties or a wind will do. The functions trust their
input: a `Model` is checked when it is built.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from lta_model.model import Model
from lta_sim import craft
from lta_sim.craft import Craft
import numpy as np
from numpy.typing import ArrayLike, NDArray

State = NDArray[np.float64]
CALM = (0.0, 0.0, 0.0)

LAYOUT = craft.LAYOUT


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


def _fill(what: str, values: ArrayLike, room: State) -> None:
    """
    Write numbers into room that is all zeros; it may be longer.

    Raises
    ------
    ValueError
        If there are more numbers, or not one row of them.

    """
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1 or len(array) > len(room):
        raise ValueError(f'The {what} has shape {array.shape}; it must be at most {room.shape}.')
    room[: len(array)] = array


def _craft(state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike) -> Craft:
    """Return the vehicle with what all functions take."""
    start = np.asarray(state, dtype=np.float64)
    if start.shape != (LAYOUT.size,):
        raise ValueError(f'The state has shape {start.shape}; it must be ({LAYOUT.size},).')
    flown = Craft(model)
    flown.state[:] = start
    _fill('command', command, flown.command)
    _fill('surroundings', surroundings, flown.surroundings)
    return flown


def derivative(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> State:
    """
    Return d/dt of a state.

    Parameters
    ----------
    state : array_like, shape (N,)
        Layout of `lta_model.state`, SI.
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
    flown = _craft(state, model, command, surroundings)
    flown.look()
    return flown.rate.copy()


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
    flown = _craft(state, model, command, surroundings)
    flown.advance(float(dt), int(steps))
    return flown.state.copy()


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
    flown = _craft(state, model, command, surroundings)
    flown.look()
    wrenches = dict(zip(LAYOUT.wrenches, flown.wrenches, strict=True))
    return Look(wrenches, flown.thrusts, flown.wind)


def thrusts(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> State:
    """Return the thrust of each rotor: `look(...).thrusts`. [N]"""
    return look(state, model, command, surroundings).thrusts


def wrenches(
    state: ArrayLike, model: Model, command: ArrayLike, surroundings: ArrayLike = CALM
) -> Mapping[str, State]:
    """Return the wrench of each wrench effect, body frame [N, N m]: `look(...).wrenches`."""
    return look(state, model, command, surroundings).wrenches
