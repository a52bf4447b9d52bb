# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Propagate small changes of the state, and what the sensors read of them.

Along a trajectory they follow the variational equation

    d/dt x = F x + g

x is the change of position (map), attitude (rotation vector in the body), body velocity and body
rates. F and g are finite differences of the model's rates at the states of the trajectory. Because
rates, not trajectories, are differenced, parameters that can be scaled together without changing
the motion (thrust, mass, drag, inertia) cancel to rounding at every step. Differences of long
trajectories would leave spurious evidence.
"""

from collections.abc import Mapping
from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
from lta_discovery.replay.sensing import (
    apply_sensor_effects,
    body_vertical,
    CHANNEL_READINGS,
    cross_matrix,
    SensorPlaces,
)
from lta_model.measurement_chain import Chain
from lta_model.sensors.pressure import EXPONENT, LAPSE, SEA_TEMPERATURE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STATE_WIDTH: Final = 12
NUDGE: Final = np.array([1e-4] * 3 + [1e-5] * 3 + [1e-5] * 3 + [1e-5] * 3)  # m, rad, m/s, rad/s


def apply_state_changes(states: Array, change: Array) -> Array:
    """Apply changes, shape (..., 12), to states, shape (..., 13)."""
    # Multiply from the right: the rotation vector is in the body frame
    turned = quaternion_product(states[..., 3:7], quaternion_exponential(change[..., 3:6]))
    return np.concatenate(
        [states[..., :3] + change[..., :3], turned, states[..., 7:13] + change[..., 6:12]],
        axis=-1,
    )


def integrate_dynamics(jacobian: Array, dt: float) -> Array:
    """Return B of x' = A x + B g over a step in which F and g are constant."""
    eye = np.eye(STATE_WIDTH)
    # Taylor series of the integral of exp(F t) in Horner form, of fourth order
    hf = dt * jacobian
    half = eye + hf / 4.0
    third = eye + (hf / 3.0) @ half
    b: Array = dt * (eye + (hf / 2.0) @ third)
    return b


TURN, SPEED, RATES = (
    slice(3, 6),
    slice(6, 9),
    slice(9, 12),
)  # of a state change (`variational_equation`)
READ_STEPS: Final = np.array([1e-4] * 7 + [1.0])  # step of a reading, to differentiate its effects


def _write_force_slopes(
    begin: Array, end: Array, first: Array, last: Array, places: SensorPlaces
) -> None:
    """Write the slopes of the mean specific force: v' + w' x r + w x (v + w x r) + g up."""
    mean = 0.5 * (begin + end)
    eye, lever = np.eye(3), cross_matrix(np.array(places.imu))
    turning = cross_matrix(mean[..., 10:13])
    going = cross_matrix(mean[..., 7:10] + np.cross(mean[..., 10:13], np.array(places.imu)))
    # Derivative of w x (v + w x r) by w
    by_rates = -going - turning @ lever
    for out, state, sign in ((first, begin, -1.0), (last, end, 1.0)):
        force = out[..., CHANNEL_READINGS['force'], :]
        # The map's vertical u seen from a body that turns by a: u + u x a.
        force[..., TURN] = 0.5 * STANDARD_GRAVITY * cross_matrix(body_vertical(state))
        force[..., SPEED] = sign / GRID_PERIOD * eye + 0.5 * turning
        force[..., RATES] = -sign / GRID_PERIOD * lever + 0.5 * by_rates


def _write_height_slopes(begin: Array, first: Array, places: SensorPlaces) -> None:
    """Write the slopes of range and pressure."""
    up = body_vertical(begin)
    leaning, lever = cross_matrix(up), np.array(places.range)
    # Range to the floor: height of the sensor over the cosine of the tilt.
    # Quotient rule: sensor height and cosine of the tilt both depend on attitude
    above, along = begin[..., 2] + up @ lever, up[..., 2]
    first[..., 6, 2] = 1.0 / along
    first[..., 6, TURN] = lever @ leaning / along[..., None]
    first[..., 6, TURN] -= (above / along**2)[..., None] * leaning[..., 2, :]
    part, lever = LAPSE / SEA_TEMPERATURE, np.array(places.imu)
    thinner = (1.0 - part * (begin[..., 2] + up @ lever)) ** (EXPONENT - 1.0)
    first[..., 7, 2] = -places.floor * EXPONENT * part * thinner
    first[..., 7, TURN] = first[..., 7, 2, None] * (lever @ leaning)


def _apply_sensor_effects(
    exact: Array, time: Array, acting: Mapping[str, Chain], *slopes: Array
) -> None:
    """Apply the chain rule of the sensor effects to slopes of ideal readings."""
    whole = apply_sensor_effects(exact, time, acting)
    for name, part in CHANNEL_READINGS.items():
        if not acting[name]:
            continue
        count = part.stop - part.start
        own = np.empty((*time.shape, count, count))
        for k in range(count):
            # Disturb one reading of the channel at a time (forward difference)
            aside = exact.copy()
            aside[..., part.start + k] += READ_STEPS[part.start]
            there = apply_sensor_effects(aside, time, acting)
            own[..., k] = ((there - whole) / READ_STEPS[part.start])[..., part]
        for out in slopes:
            out[..., part, :] = own @ out[..., part, :]


def reading_jacobians(
    grid: Array, exact: Array, time: Array, acting: Mapping[str, Chain], places: SensorPlaces
) -> tuple[Array, Array]:
    """
    Return the Jacobians of readings at the beginning and at the end of their period.

    Each has the shape (S, n, 8, 12): by the change of position, attitude, velocity and rates.
    `grid` holds the states, shape (S, n + 1, 13), and `exact` the `sensing.ideal_readings`.
    """
    begin, end = grid[:, :-1], grid[:, 1:]
    first, last = np.zeros((2, *exact.shape, STATE_WIDTH))
    for out in (first, last):
        out[..., CHANNEL_READINGS['rates'], RATES] = 0.5 * np.eye(3)
    _write_force_slopes(begin, end, first, last, places)
    _write_height_slopes(begin, first, places)
    _apply_sensor_effects(exact, time, acting, first, last)
    return first, last
