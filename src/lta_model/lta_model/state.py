# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Layout of the kernel's state, command, surroundings and body arrays.

A state is a float64 array: position of the hull centre in `map` (x y z, m), quaternion from body
to map (x y z w), velocity of the hull centre in the body frame (m/s), body rates (rad/s), then the
memory of the effects that have one, in registry order and within an actuator effect rotor by
rotor.

A command holds the duty of each rotor (-1 to 1, or newtons where the
vehicle's thrust curve is at its null values), then where the moving mass should be (x y z, m, body
frame). Rotors that a vehicle does not have are at 0.

Surroundings are external conditions, constant during a call:
wind from outside the effects (x y z in `map`, m/s), white noise for turbulence (three, of unit
intensity, s^-1/2), irradiance on the hull (W/m2), voltage of the battery (V), and how fast that
wind changes, everywhere alike (x y z in `map`, m/s2).

A body is what the vehicle is: mass (kg), mass times CG (x y z, kg m), inertia about the hull
centre (xx yy zz xy xz yz, kg m2), added mass and inertia (6, kg and kg m2), mass of the displaced
air (kg), then of each rotor its place (x y z, m) and the direction of its thrust (unit vector).
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Rotors that the kernel has room for
ACTUATORS = 8

POSITION = slice(0, 3)
QUATERNION = slice(3, 7)
VELOCITY = slice(7, 10)
RATES = slice(10, 13)
# Numbers of the rigid-body state
RIGID = 13
MEMORY = slice(RIGID, None)

MASS_PLACE = ACTUATORS  # first of three
COMMAND = ACTUATORS + 3

WIND = 0  # first of three
NOISE = 3  # first of three
IRRADIANCE = 6
VOLTAGE = 7
WIND_RATE = 8  # first of three
SURROUNDINGS = 11

MASS = 0
MASS_MOMENT = 1  # first of three
INERTIA = 4  # first of six
ADDED = 10  # first of six
DISPLACED = 16
ROTOR_PLACE = 17  # of the first rotor
ROTOR_AXIS = 20  # of the first rotor
ROTOR = 6  # numbers of each rotor
BODY = ROTOR_PLACE + ROTOR * ACTUATORS


def pack_state(
    position: ArrayLike = (0.0, 0.0, 0.0),
    heading: float = 0.0,
    velocity: ArrayLike = (0.0, 0.0, 0.0),
    rates: ArrayLike = (0.0, 0.0, 0.0),
    memory: ArrayLike = (),
) -> NDArray[np.float64]:
    """
    Return the state of a level vehicle, shape (13 + len(memory),).

    Parameters
    ----------
    position : array_like, shape (3,)
        Hull centre in `map`. [m]
    heading : float
        Direction of the body x axis, anticlockwise from map x. [rad]
    velocity, rates : array_like, shape (3,)
        Velocity over the ground and body rates, body frame. [m/s, rad/s]
    memory : array_like
        Initial memory of the effects, `effects.initial_memory()`.

    """
    # Rotation about the vertical alone
    quaternion = (0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))
    return np.concatenate(
        [
            np.asarray(part, dtype=np.float64)
            for part in (position, quaternion, velocity, rates, memory)
        ]
    )
