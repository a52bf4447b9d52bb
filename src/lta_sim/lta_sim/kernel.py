"""
The motion of a vehicle: its rate, its future, and the wrench of each effect.

Compiled once per content of the effects and kept on disk (`kernel_cache`). States are float64
arrays in the layout of `lta_sim.state`; `duty` has four numbers from -1 to 1; `wind` is the steady
velocity of the air in `map`, m/s. The functions trust their input: a `Model` is checked when it is
built.
"""

from collections.abc import Mapping
from functools import cache
from types import ModuleType

from lta_sim.compose import kernel_source
from lta_sim.effects import EFFECTS, initial_memory
from lta_sim.effects.protocol import WrenchEffect
from lta_sim.kernel_cache import load
from lta_sim.model import Model
from lta_sim.state import ACTUATORS, RIGID
import numpy as np
from numpy.typing import ArrayLike, NDArray

State = NDArray[np.float64]
CALM = (0.0, 0.0, 0.0)


@cache
def _kernel() -> ModuleType:
    """Return the kernel of all effects."""
    return load(kernel_source(EFFECTS))


@cache
def _wrench_effects() -> tuple[str, ...]:
    """Return the names of the effects that `wrenches` reports."""
    return tuple(name for name, effect in EFFECTS.items() if isinstance(effect, WrenchEffect))


@cache
def _size() -> int:
    """Return the length of a state."""
    return RIGID + len(initial_memory())


def _floats(what: str, values: ArrayLike, count: int) -> State:
    """Return a contiguous float64 array of that many numbers, itself if it is one."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.shape != (count,):
        # Compiled code does not look: it would read what lies behind the array.
        raise ValueError(f'The {what} has shape {array.shape}; it must be ({count},).')
    return array


def _input(
    state: ArrayLike, duty: ArrayLike, wind: ArrayLike
) -> tuple[State, NDArray[np.float64], NDArray[np.float64]]:
    """Return what all functions take, as the kernel takes it."""
    return (
        _floats('state', state, _size()),
        _floats('duty', duty, ACTUATORS),
        _floats('wind', wind, 3),
    )


def derivative(state: ArrayLike, model: Model, duty: ArrayLike, wind: ArrayLike = CALM) -> State:
    """
    Return d/dt of a state.

    Parameters
    ----------
    state : array_like, shape (N,)
        Layout of `lta_sim.state`, SI.
    model : Model
        The vehicle.
    duty : array_like, shape (4,)
        Commanded duty of each rotor, -1 to 1.
    wind : array_like, shape (3,)
        Steady uniform velocity of the air in `map`. [m/s]

    Returns
    -------
    ndarray, shape (N,)
        Rate of each element. [1/s]

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    start, command, air = _input(state, duty, wind)
    out = np.empty_like(start)
    _kernel().derivative(start, model.parameters, model.body, model.inverse, command, air, out)
    return out


def advance(
    state: ArrayLike, model: Model, duty: ArrayLike, wind: ArrayLike, dt: float, steps: int
) -> State:
    """
    Return the state after `steps` classical Runge-Kutta steps under a constant command.

    Parameters
    ----------
    state, model, duty, wind
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
    start, command, air = _input(state, duty, wind)
    out = np.empty_like(start)
    _kernel().advance(
        start,
        model.parameters,
        model.body,
        model.inverse,
        command,
        air,
        float(dt),
        int(steps),
        out,
    )
    return out


def wrenches(
    state: ArrayLike, model: Model, duty: ArrayLike, wind: ArrayLike = CALM
) -> Mapping[str, NDArray[np.float64]]:
    """
    Return the wrench of each wrench effect.

    Parameters
    ----------
    state, model, duty, wind
        As for `derivative`.

    Returns
    -------
    mapping of str to ndarray, shape (6,)
        Force and moment about the hull centre, body frame, by effect. [N, N m]

    """
    start, command, air = _input(state, duty, wind)
    names = _wrench_effects()
    out = np.empty((len(names), 6))
    _kernel().wrenches(start, model.parameters, command, air, out)
    return dict(zip(names, out, strict=True))
