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
from lta_sim.effects import EFFECTS
from lta_sim.effects.protocol import WrenchEffect
from lta_sim.kernel_cache import load
from lta_sim.model import Model
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


def _floats(values: ArrayLike) -> State:
    """Return a contiguous float64 array, itself if it is one."""
    return np.ascontiguousarray(values, dtype=np.float64)


def derivative(state: State, model: Model, duty: ArrayLike, wind: ArrayLike = CALM) -> State:
    """
    Return d/dt of a state.

    Parameters
    ----------
    state : ndarray, shape (N,)
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

    """
    out = np.empty_like(state)
    _kernel().derivative(
        state, model.parameters, model.body, model.inverse, _floats(duty), _floats(wind), out
    )
    return out


def advance(
    state: State, model: Model, duty: ArrayLike, wind: ArrayLike, dt: float, steps: int
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
    out = np.empty_like(state)
    _kernel().advance(
        state,
        model.parameters,
        model.body,
        model.inverse,
        _floats(duty),
        _floats(wind),
        float(dt),
        int(steps),
        out,
    )
    return out


def wrenches(
    state: State, model: Model, duty: ArrayLike, wind: ArrayLike = CALM
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
    names = _wrench_effects()
    out = np.empty((len(names), 6))
    _kernel().wrenches(state, model.parameters, _floats(duty), _floats(wind), out)
    return dict(zip(names, out, strict=True))
