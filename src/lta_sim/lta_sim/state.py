"""
The layout of a vehicle's state, in one place.

A state is a float64 array: position of the hull centre in `map` (x y z, m), quaternion from body
to map (x y z w), velocity of the hull centre in the body frame (m/s), body rates (rad/s), then the
memory of the effects that have one, in registry order and within an effect rotor by rotor.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

ACTUATORS = 4

POSITION = slice(0, 3)
QUATERNION = slice(3, 7)
VELOCITY = slice(7, 10)
RATES = slice(10, 13)
RIGID = 13
MEMORY = slice(RIGID, None)


def pack(
    position: ArrayLike = (0.0, 0.0, 0.0),
    heading: float = 0.0,
    velocity: ArrayLike = (0.0, 0.0, 0.0),
    rates: ArrayLike = (0.0, 0.0, 0.0),
    memory: ArrayLike = (),
) -> NDArray[np.float64]:
    """
    Return the state of a level vehicle.

    Parameters
    ----------
    position : array_like, shape (3,)
        Hull centre in `map`. [m]
    heading : float
        Direction of the body x axis, anticlockwise from map x. [rad]
    velocity : array_like, shape (3,)
        Velocity over the ground, in the body frame. [m/s]
    rates : array_like, shape (3,)
        Body rates. [rad/s]
    memory : array_like
        Initial memory of the effects, `effects.initial_memory()`.

    Returns
    -------
    ndarray, shape (13 + len(memory),)
        The state.

    """
    quaternion = (0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))
    return np.concatenate(
        [
            np.asarray(part, dtype=np.float64)
            for part in (position, quaternion, velocity, rates, memory)
        ]
    )
