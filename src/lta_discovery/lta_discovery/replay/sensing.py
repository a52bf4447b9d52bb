# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Predict the readings of tracker and sensors from states, vectorized."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, final

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_product,
    rotate_vectors,
    rotation_matrix,
)
from lta_model.effects.sensors import MARKER_OFFSET
from lta_model.measurement_chain import apply_chain, Chain
from lta_model.sensors.imu import imu_specific_force
from lta_model.sensors.pressure import air_pressure
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


MARKER: Final = MARKER_OFFSET.reading
IDENTITY: Final = np.array([0.0, 0.0, 0.0, 1.0])  # quaternion x y z w
# Readings that each channel of effects acts on.
CHANNEL_READINGS: Final = {
    'rates': slice(0, 3),
    'force': slice(3, 6),
    'range': slice(6, 7),
    'pressure': slice(7, 8),
}


@final
@dataclass(frozen=True, slots=True)
class SensorPlaces:
    """Places of the sensors in the body frame, and pressure at the floor [m, Pa]."""

    imu: tuple[float, float, float]
    range: tuple[float, float, float]
    floor: float

    @classmethod
    def from_vehicle(cls, vehicle: Vehicle, floor: float) -> 'SensorPlaces':
        """Return those of a vehicle."""
        sensors = vehicle.file.sensors
        a, b, c = sensors.imu_position.vector
        d, e, f = sensors.range_position.vector
        return cls((a, b, c), (d, e, f), floor)


def apply_channel_effects(chain: Chain, values: Array, time: Array) -> Array:
    """Apply the effects of a channel to readings, shape (..., k)."""
    if not chain:
        return values
    parts = apply_chain(chain, tuple(np.moveaxis(values, -1, 0)), time)  # type: ignore[arg-type]
    # An effect may return a scalar for a channel; give all the same shape
    shape = values.shape[:-1]
    return np.stack([np.broadcast_to(part, shape) for part in parts], axis=-1)


def pose_time_shift(acting: Mapping[str, Chain], time: Array) -> Array:
    """Return how much newer a tracked pose is than its stamp [s]."""
    clock = apply_channel_effects(acting['clock'], time[..., None], time)
    return apply_channel_effects(acting['pose_time'], clock, time)[..., 0] - time


def cross_matrix(vector: Array) -> Array:
    """Return the matrices of v x, shape (..., 3, 3)."""
    out = np.zeros((*vector.shape, 3))
    out[..., 2, 1], out[..., 0, 2], out[..., 1, 0] = np.moveaxis(vector, -1, 0)
    out[..., 1, 2], out[..., 2, 0], out[..., 0, 1] = np.moveaxis(-vector, -1, 0)
    return out


def _shift_poses(states: Array, shift: Array) -> tuple[Array, Array]:
    """
    Return poses at small time shifts from the states on the grid.

    To second order: with a linear shift by 0.1 s, oscillations would appear too large, and gyro
    readings too small.
    """
    velocity = rotate_vectors(states[..., 3:7], states[..., 7:10])
    rates, half = states[..., :-1, 10:13], 0.5 * shift**2
    # Accelerations by central differences on the grid
    change, turning = (
        np.gradient(each, GRID_PERIOD, axis=-2)[..., :-1, :]
        for each in (velocity, states[..., 10:13])
    )
    position = states[..., :-1, :3] + shift * velocity[..., :-1, :] + half * change
    turn = quaternion_exponential(shift * rates + half * turning)
    return position, quaternion_product(states[..., :-1, 3:7], turn)


def predict_pose(states: Array, time: Array, acting: Mapping[str, Chain]) -> tuple[Array, Array]:
    """Return the predicted tracker poses of all states on the grid but the last."""
    position, quaternion = states[..., :-1, :3], states[..., :-1, 3:7]
    if acting['clock'] or acting['pose_time']:
        position, quaternion = _shift_poses(states, pose_time_shift(acting, time)[..., None])
    if acting['pose']:
        pose = apply_channel_effects(
            acting['pose'], np.concatenate([position, quaternion], axis=-1), time
        )
        position, quaternion = pose[..., :3], pose[..., 3:]
    return position, quaternion


def tracker_frame(acting: Mapping[str, Chain]) -> tuple[Array, Array]:
    """Return the rotation from the map into the tracker's frame: matrix and quaternion."""
    chain = tuple(link for link in acting['pose'] if link[0] is not MARKER)
    if not chain:
        return np.eye(3), IDENTITY
    # Images of the unit vectors are the columns of the rotation matrix
    axes = [apply_chain(chain, (*axis, 0.0, 0.0, 0.0, 1.0), 0.0)[:3] for axis in np.eye(3)]
    turn = apply_chain(chain, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), 0.0)[3:]
    return np.array(axes, dtype=np.float64).T, np.array(turn, dtype=np.float64)


def marker_frame(acting: Mapping[str, Chain]) -> tuple[Array, Array] | None:
    """Return origin and rotation of the markers in the body; None if they are the body's."""
    for reading, p in acting['pose']:
        if reading is MARKER:
            there = apply_chain(((reading, p),), (0.0,) * 6 + (1.0,), 0.0)
            return np.array(there[:3], dtype=np.float64), np.array(there[3:], dtype=np.float64)
    return None


def transform_to_map(states: Array, acting: Mapping[str, Chain]) -> Array:
    """
    Transform tracker states, shape (..., 13), into states of the body in the map frame.

    Body velocity and rates do not depend on the tracker frame, but on the frame of the markers.
    """
    if not acting['pose']:
        return states
    frame, turn = tracker_frame(acting)
    back = np.broadcast_to(quaternion_conjugate(turn), (*states.shape[:-1], 4))
    out = np.concatenate(
        # A row vector times the matrix applies the inverse rotation
        [states[..., :3] @ frame, quaternion_product(back, states[..., 3:7]), states[..., 7:]],
        axis=-1,
    )
    markers = marker_frame(acting)
    return out if markers is None else _transform_to_body(out, *markers)


def _transform_to_body(states: Array, arm: Array, turn: Array) -> Array:
    """Transform states of the marker frame into those of the body."""
    own = np.broadcast_to(turn, (*states.shape[:-1], 4))
    attitude = quaternion_product(states[..., 3:7], quaternion_conjugate(own))
    rates = rotate_vectors(own, states[..., 10:13])
    # The hull centre moves slower than the markers by what the rotation adds
    velocity = rotate_vectors(own, states[..., 7:10]) - np.cross(rates, arm)
    place = states[..., :3] - rotate_vectors(attitude, np.broadcast_to(arm, rates.shape))
    return np.concatenate([place, attitude, velocity, rates], axis=-1)


def transform_to_tracker(states: Array, acting: Mapping[str, Chain]) -> Array:
    """Transform states of the body in the map into those that a tracker measures: the inverse."""
    if not acting['pose']:
        return states
    out = states
    markers = marker_frame(acting)
    if markers is not None:
        arm, own = markers
        back = np.broadcast_to(quaternion_conjugate(own), (*states.shape[:-1], 4))
        velocity = states[..., 7:10] + np.cross(states[..., 10:13], arm)
        shift = rotate_vectors(states[..., 3:7], np.broadcast_to(arm, velocity.shape))
        out = np.concatenate(
            [
                states[..., :3] + shift,
                quaternion_product(states[..., 3:7], quaternion_conjugate(back)),
                rotate_vectors(back, velocity),
                rotate_vectors(back, states[..., 10:13]),
            ],
            axis=-1,
        )
    frame, turn = tracker_frame(acting)
    whole = np.broadcast_to(turn, (*states.shape[:-1], 4))
    return np.concatenate(
        [out[..., :3] @ frame.T, quaternion_product(whole, out[..., 3:7]), out[..., 7:]], axis=-1
    )


def pose_sensitivity(change: Array, states: Array, acting: Mapping[str, Chain]) -> Array:
    """
    Return the change of tracked poses, shape (..., 6, K), for changes of states (..., 12, K).

    Position, and a rotation vector in the axes of the markers. [m, rad]
    """
    place, turn = change[..., :3, :], change[..., 3:6, :]
    markers = marker_frame(acting)
    if markers is not None:
        arm, own = markers
        body = rotation_matrix(states[..., 3:7])
        # A rotation of the body moves the markers by their lever arm: R (turn x arm)
        place = place + body @ (-cross_matrix(arm) @ turn)
        turn = rotation_matrix(own).T @ turn
    if acting['pose']:
        place = tracker_frame(acting)[0] @ place
    return np.concatenate([place, turn], axis=-2)


def body_vertical(states: Array) -> Array:
    """Return the map's vertical in the body frame, shape (..., 3)."""
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (*states.shape[:-1], 3))
    return rotate_vectors(quaternion_conjugate(states[..., 3:7]), up)


def _specific_force(state: Array, rate: Array, place: tuple[float, float, float]) -> Array:
    """Return the specific force in a state that changes at a rate."""
    across = [
        tuple(np.moveaxis(part, -1, 0))
        for part in (
            state[..., 7:10], state[..., 10:13], rate[..., 7:10], rate[..., 10:13],
            body_vertical(state),
        )
    ]  # fmt: skip
    # Plain arithmetic, which works for arrays as well.
    whole: Callable[..., Any] = imu_specific_force
    return np.stack(whole(*across, place, STANDARD_GRAVITY), axis=-1)


def ideal_readings(begin: Array, middle: Array, end: Array, places: SensorPlaces) -> Array:
    """
    Return rates, force, range and pressure of ideal sensors over a grid period, shape (..., 8).

    The first six readings are means of the period, by Simpson's rule from its three states. [SI]
    """
    vertical = body_vertical(begin)
    # The beam leaves along the body's vertical: height over the cosine of the tilt
    distance = (begin[..., 2] + vertical @ np.array(places.range)) / vertical[..., 2]
    # The barometer is beside the IMU and moves with it as the vehicle tilts
    height = begin[..., 2] + vertical @ np.array(places.imu)
    pressure = air_pressure(places.floor, height)
    change = (end - begin) / GRID_PERIOD
    states, weights = [begin, middle, end], [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]
    rates = np.tensordot(weights, [one[..., 10:13] for one in states], axes=1)
    forces = [_specific_force(one, change, places.imu) for one in states]
    force = np.tensordot(weights, forces, axes=1)
    return np.concatenate([rates, force, distance[..., None], pressure[..., None]], axis=-1)


def apply_sensor_effects(exact: Array, time: Array, acting: Mapping[str, Chain]) -> Array:
    """Apply the sensor effects to ideal readings, shape (..., 8)."""
    out = exact.copy()
    for name, part in CHANNEL_READINGS.items():
        if acting[name]:
            out[..., part] = apply_channel_effects(acting[name], exact[..., part], time)
    return out


def estimate_floor_pressure(flight: MeasuredFlight, places: SensorPlaces) -> float:
    """Return the median pressure at the floor [Pa]; 101325 Pa without a barometer."""
    ratio = [
        reading / air_pressure(1.0, height + places.imu[2])
        for reading, height in zip(flight.readings[:, 7], flight.position[:, 2], strict=True)
        if np.isfinite(reading) and np.isfinite(height)
    ]
    return float(np.median(ratio)) if ratio else 101325.0
