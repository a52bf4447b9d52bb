# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The three filters of the estimator: attitude, altitude with climb rate, and airspeed.

The attitude follows the gyroscope, and slowly the direction of gravity.

The altitude is that of a Kalman filter with three states: height of the hull centre above the
floor, climb rate, and the offset of the pressure height, which drifts slowly with weather and
temperature. The range finder gives the height while the floor is within its range; beyond that
the filter relies on pressure.

The airspeed is estimated from acceleration and the drag model. Integrated acceleration alone
drifts. If it is damped towards zero, the estimate decays in steady flight and a speed loop closed
on it runs away. The filter therefore damps towards the speed that the drag model predicts for the
commanded thrust. In wind this is the speed through the air: ground speed is not observable with
these sensors.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_control.motion import drag_force, Quaternion, up_in_body, Vector


def attitude_step(
    q: Quaternion, rates: Vector, force: Vector, gain: float, dt: float
) -> Quaternion:
    """
    Return the attitude one step later, as a body-to-odom quaternion x, y, z, w.

    `rates` [rad/s] and the specific force `force` [m/s2, +g up at rest] are in the body frame
    with the bias removed. `gain` is the rate at which gravity corrects roll and pitch. [1/s]
    """
    fx, fy, fz = force
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    ux, uy, uz = up_in_body(q)
    wx, wy, wz = rates
    if size > 0.0:
        # Correction: cross product of measured and estimated up direction.
        # Normalised: only the direction of the specific force counts
        k = gain / size
        wx += k * (fy * uz - fz * uy)
        wy += k * (fz * ux - fx * uz)
        wz += k * (fx * uy - fy * ux)
    x, y, z, w = q
    # Quaternion kinematics q' = q * (w, 0) / 2, one Euler step
    h = 0.5 * dt
    nx = x + h * (w * wx + y * wz - z * wy)
    ny = y + h * (w * wy + z * wx - x * wz)
    nz = z + h * (w * wz + x * wy - y * wx)
    nw = w - h * (x * wx + y * wy + z * wz)
    # Renormalise, since the Euler step leaves the unit sphere.
    norm = math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    return nx / norm, ny / norm, nz / norm, nw / norm


class AltitudeSettings(Settings):
    """Noise of the altitude filter's inputs."""

    acceleration_noise: float = setting(0.15, 'm/s2', 1e-3, 10.0)
    """Standard deviation of the measured vertical acceleration."""
    offset_walk: float = setting(0.02, 'm/s^0.5', 0.0, 1.0)
    """Random drift, in one second, of the height computed from air pressure."""
    range_noise: float = setting(0.01, 'm', 1e-3, 1.0)
    """Standard deviation of the measured distance to the floor."""
    pressure_noise: float = setting(0.15, 'm', 1e-3, 10.0)
    """Standard deviation of the height computed from air pressure."""


class AltitudeEstimate(NamedTuple):
    """Estimate and covariance (upper triangle, row by row)."""

    height: float = 0.0  # [m]
    climb: float = 0.0  # [m/s]
    offset: float = 0.0  # [m]
    p: tuple[float, float, float, float, float, float] = (1.0, 0.0, 0.0, 0.01, 0.0, 1.0)


def predict_altitude(
    state: AltitudeEstimate, acceleration: float, noise: float, walk: float, dt: float
) -> AltitudeEstimate:
    """
    Return the estimate one step later.

    `acceleration` is the measured upward acceleration without gravity. [m/s2] `noise` and `walk`
    are the standard deviations of the acceleration [m/s2] and of the offset's random walk
    [m/s^0.5].
    """
    p00, p01, p02, p11, p12, p22 = state.p
    q = noise * noise
    # Constant acceleration over the step: its noise enters height and climb rate together
    half = 0.5 * dt * dt
    return AltitudeEstimate(
        state.height + dt * state.climb + half * acceleration,
        state.climb + dt * acceleration,
        state.offset,
        (
            p00 + 2.0 * dt * p01 + dt * dt * p11 + half * half * q,
            p01 + dt * p11 + half * dt * q,
            p02 + dt * p12,
            p11 + dt * dt * q,
            p12,
            p22 + dt * walk * walk,
        ),
    )


def correct_altitude(
    state: AltitudeEstimate, measured: float, noise: float, with_offset: bool
) -> AltitudeEstimate:
    """
    Return the estimate after one measurement of the height.

    `measured` is the height of the hull centre by this sensor and `noise` its standard deviation.
    [m] `with_offset` is True where the sensor measures height plus the pressure offset.
    """
    p00, p01, p02, p11, p12, p22 = state.p
    # Measurement row H = (1, 0, c)
    c = 1.0 if with_offset else 0.0
    h0, h1, h2 = p00 + c * p02, p01 + c * p12, p02 + c * p22  # P H^T
    size = h0 + c * h2 + noise * noise
    # Kalman gain; `size` is the innovation variance.
    k0, k1, k2 = h0 / size, h1 / size, h2 / size
    error = measured - state.height - c * state.offset
    return AltitudeEstimate(
        state.height + k0 * error,
        state.climb + k1 * error,
        state.offset + k2 * error,
        (
            p00 - k0 * h0,
            p01 - k0 * h1,
            p02 - k0 * h2,
            p11 - k1 * h1,
            p12 - k1 * h2,
            p22 - k2 * h2,
        ),
    )


class HullDragModel(NamedTuple):
    """Drag and inertia of the vehicle along body x and y, about the hull centre."""

    mass: tuple[float, float]  # mass including the added mass [kg]
    # Drag coefficients [N s/m], [N s2/m2]
    linear: tuple[float, float]
    quadratic: tuple[float, float]


class AirspeedEstimate(NamedTuple):
    """Estimated and modelled velocity along body x and y. [m/s]."""

    surge: float = 0.0
    sway: float = 0.0
    model_surge: float = 0.0
    model_sway: float = 0.0


def airspeed_step(
    hull: HullDragModel,
    state: AirspeedEstimate,
    force: tuple[float, float],
    acceleration: tuple[float, float],
    yaw_rate: float,
    trust: float,
    dt: float,
) -> AirspeedEstimate:
    """
    Return the airspeed one step later.

    `force` is the rotor force from the commanded duties [N] and `acceleration` the measured
    acceleration without gravity [m/s2], both along body x and y. `trust` is the time constant
    with which the estimate returns to the model [s].
    """
    surge, sway, model_surge, model_sway = state
    mx, my = hull.mass
    drag_x = drag_force(hull.linear[0], hull.quadratic[0], model_surge)
    drag_y = drag_force(hull.linear[1], hull.quadratic[1], model_sway)
    # Coriolis terms: the body frame turns under the velocity.
    model_x = (force[0] - drag_x + my * yaw_rate * model_sway) / mx
    model_y = (force[1] - drag_y - mx * yaw_rate * model_surge) / my
    # Measured acceleration plus a pull towards the model
    rate_x = acceleration[0] + yaw_rate * sway + (model_surge - surge) / trust
    rate_y = acceleration[1] - yaw_rate * surge + (model_sway - sway) / trust
    return AirspeedEstimate(
        surge + dt * rate_x,
        sway + dt * rate_y,
        model_surge + dt * model_x,
        model_sway + dt * model_y,
    )
