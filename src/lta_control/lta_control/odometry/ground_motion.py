# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the motion over ground in each step: velocity and position, with their covariance.

The position is advanced in each step, the covariance every `PERIOD` by `ground_filter`, which
describes the model. It is not compiled, so that all nodes and loops get the same bits.
"""

from collections.abc import Iterable
import math
from typing import NamedTuple, TYPE_CHECKING

from lta_control.motion import Vector, yaw_from_quaternion
from lta_control.motion_filters import HullDragModel
from lta_control.odometry.ground_filter import (
    correct_motion,
    correct_place,
    hold_still,
    predict_motion,
)
from lta_control.odometry.ground_state import (
    DRIFT_X,
    DRIFT_Y,
    GroundMotion,
    GroundSettings,
    is_computable,
    place_origin,
    restart_ground_motion,
    start_ground_motion,
    X,
    Y,
)
from lta_control.odometry.tracked_motion import OdomMotion
from lta_control.sighting import LampSighting
import numpy as np

if TYPE_CHECKING:
    from lta_control.estimator import MotionEstimate

PREDICTION_PERIOD = 0.1  # s between predictions of the covariance
NEAR_GROUND = 0.03  # m above the height on the floor, up to which the drone may stand
# A drone on the floor stands still if it turns and climbs no faster, and no motor pushes it
STILL_RATE = 0.03  # rad/s, 15 times the noise; wind that could move it makes it sway faster
STILL_CLIMB = 0.05  # m/s
STILL_DUTY = 0.01  # with which no motor moves a drone
CORRECTION_TIME = 0.7  # s in which the pending correction of the position falls to a third
TRACKER_SIGMA = 0.01  # m: of a tracked position, with the error of its time


class ModelledMotion(NamedTuple):
    """What the filter takes from the estimator."""

    ready: bool  # whether the IMU biases are known
    # Heading in the odom frame [rad], and its rate [rad/s]
    yaw: float
    yaw_rate: float
    # Airspeed of the drag model, body frame [m/s]
    surge: float
    sway: float
    on_ground: bool = False  # whether the drone may stand on the floor, or be held there
    stands: bool = False  # whether it stands still there


def is_on_ground(height: float, standing_height: float) -> bool:
    """Return whether the drone may stand on the floor; heights of the hull centre [m]."""
    return height < standing_height + NEAR_GROUND


def is_still(rates: Iterable[float], climb: float, duties: Iterable[float]) -> bool:
    """Return whether a drone on the floor stands still, by what the estimator has of it."""
    return (
        max(map(abs, rates)) < STILL_RATE
        and abs(climb) < STILL_CLIMB
        and max(map(abs, duties)) < STILL_DUTY
    )


def read_modelled_motion(estimate: 'MotionEstimate', standing_height: float) -> ModelledMotion:
    """Return what the filter takes from the estimator's state."""
    speed, yaw = estimate.airspeed, yaw_from_quaternion(estimate.attitude)
    on_ground = is_on_ground(estimate.altitude.height, standing_height)
    return ModelledMotion(
        estimate.ready,
        yaw,
        estimate.rates[2],
        speed.model_surge,
        speed.model_sway,
        on_ground,
        on_ground and is_still(estimate.rates, estimate.altitude.climb, estimate.duties),
    )


def build_odom_motion(
    stamp_ns: int, estimate: 'MotionEstimate', ground: GroundMotion
) -> OdomMotion:
    """Return the motion to which tracked poses are related."""
    yaw = yaw_from_quaternion(estimate.attitude)
    rate, velocity = estimate.rates[2], ground.velocity
    # Of the filter, which the tracker corrects
    place = ground.mean[X], ground.mean[Y]
    return OdomMotion(stamp_ns, place, yaw, rate, velocity, ground.airspeed)


def ground_velocity(estimate: 'MotionEstimate', ground: GroundMotion) -> Vector:
    """Return the velocity over ground in the body frame [m/s]."""
    x, y, z, w = estimate.attitude
    vx, vy = ground.velocity
    vz = estimate.altitude.climb
    # Transposed rotation matrix of the attitude, which is body to odom
    return (
        (1.0 - 2.0 * (y * y + z * z)) * vx
        + 2.0 * (x * y + z * w) * vy
        + 2.0 * (x * z - y * w) * vz,
        2.0 * (x * y - z * w) * vx
        + (1.0 - 2.0 * (x * x + z * z)) * vy
        + 2.0 * (y * z + x * w) * vz,
        2.0 * (x * z + y * w) * vx
        + 2.0 * (y * z - x * w) * vy
        + (1.0 - 2.0 * (x * x + y * y)) * vz,
    )


def ground_step(
    settings: GroundSettings,
    hull: HullDragModel,
    state: GroundMotion,
    motion: ModelledMotion,
    sighting: LampSighting | None,
    dt: float,
    tracked: tuple[float, float] | None = None,
) -> GroundMotion:
    """
    Return the motion over ground one step later, from the newest modelled motion.

    `tracked` is the position by a tracker at this step [m, odom], if there is one. It is used
    where the covariance is advanced, which sets `elapsed` to 0.
    """
    if not state.rows.size:
        state = start_ground_motion(settings)
    ready, yaw, yaw_rate, surge, sway, on_ground, stands = motion
    cos, sin = math.cos(yaw), math.sin(yaw)
    air = cos * surge - sin * sway, sin * surge + cos * sway
    mean, moved = state.mean, state.moved
    keep = CORRECTION_TIME / (CORRECTION_TIME + dt)
    way = dt * (air[0] + mean[DRIFT_X]), dt * (air[1] + mean[DRIFT_Y])
    # The frame begins where the drone stands when the estimate is ready
    place = (mean[X] + way[0], mean[Y] + way[1]) if ready else (0.0, 0.0)
    state = state._replace(
        mean=(*place, *mean[DRIFT_X:]),
        air=air,
        moved=(moved[0] + way[0], moved[1] + way[1]),
        elapsed=state.elapsed + dt,
        on_ground=on_ground,
        pending=(keep * state.pending[0], keep * state.pending[1]),
    )
    if not ready:
        sighting = None
    if sighting is None and state.elapsed < PREDICTION_PERIOD - 0.5 * dt:
        return state
    # A bearing holds for the middle of its block
    bearing = 0.0 if sighting is None else yaw - yaw_rate * sighting.age + sighting.bearing
    try:
        with np.errstate(all='ignore'):  # judged by `is_computable`
            after = predict_motion(settings, hull, state, (cos, sin))
            if stands:
                after = hold_still(state, after)
            if tracked is not None and ready:
                after = correct_place(after, tracked, TRACKER_SIGMA)
            if sighting is not None:
                x, y = after.position
                after = correct_motion(
                    settings, after, sighting, bearing, state.doubted + state.elapsed
                )
                after = after._replace(pending=(after.mean[X] - x, after.mean[Y] - y))
    except (OverflowError, ZeroDivisionError, ValueError):
        # Sightings that contradict each other: the drone flies on without
        return restart_ground_motion(settings, state)
    if not is_computable(after):
        return restart_ground_motion(settings, state)
    return after if ready else place_origin(after)
