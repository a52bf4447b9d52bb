# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Errors of sensors, of the tracker and of clocks."""

import math

from lta_model.effects.protocol import (
    declare_each,
    EffectParameter,
    MeasurementEffect,
    Quaternion,
    Values,
)


def imu_scale(p: Values, values: Values, time: float) -> Values:
    """
    Scale factor of each accelerometer axis.

        f_read = (x f_x, y f_y, z f_z)
    """
    x, y, z = p
    return (x * values[0], y * values[1], z * values[2])


# The data sheet bounds the scale of the gyroscope only; that of the accelerometer is taken alike
_IMU_SCALE_SOURCE = 'assumed: as the gyroscope, Bosch BMI088 data sheet: sensitivity within +-1 %'

IMU_SCALE = MeasurementEffect(
    'imu_scale',
    declare_each(('x', 'y', 'z'), '1', 1.0, 0.8, 1.2, 0.006, _IMU_SCALE_SOURCE),
    'force',
    imu_scale,
)


def imu_bias(p: Values, values: Values, time: float) -> Values:
    """
    Constant bias of each accelerometer axis.

        f_read = f + (x, y, z)

    It adds to the offset drawn for each flight, before noise, rounding and clipping, and is the
    same in every flight, so that identification can estimate it.
    """
    x, y, z = p
    return (values[0] + x, values[1] + y, values[2] + z)


# The spread is that of a uniform draw within the data sheet's bound, 20 mg / 3^0.5.
_IMU_BIAS_SOURCE = (
    'Bosch BMI088 data sheet: zero-g offset of +-20 mg; limits: ten times that (assumed)'
)

IMU_BIAS = MeasurementEffect(
    'imu_bias',
    declare_each(('x', 'y', 'z'), 'm/s2', 0.0, -2.0, 2.0, 0.11, _IMU_BIAS_SOURCE),
    'force',
    imu_bias,
)


def gyro_scale(p: Values, values: Values, time: float) -> Values:
    """
    Scale factor of each gyroscope axis.

        w_read = (x w_x, y w_y, z w_z)

    A heading integrated from rates errs by (z - 1) times the angle turned.
    """
    x, y, z = p
    return (x * values[0], y * values[1], z * values[2])


# The spread is that of a uniform draw within the data sheet's bound, 1 % / 3^0.5.
_GYRO_SCALE_SOURCE = 'Bosch BMI088 data sheet: sensitivity within +-1 %; limits: 20 % (assumed)'

GYRO_SCALE = MeasurementEffect(
    'gyro_scale',
    declare_each(('x', 'y', 'z'), '1', 1.0, 0.8, 1.2, 0.006, _GYRO_SCALE_SOURCE),
    'rates',
    gyro_scale,
)


def gyro_bias(p: Values, values: Values, time: float) -> Values:
    """
    Constant bias of each gyroscope axis.

        w_read = w + (x, y, z)

    Applied after `gyro_scale`, so it is the reading at rest.
    """
    x, y, z = p
    return (values[0] + x, values[1] + y, values[2] + z)


# The spread is that of a uniform draw within the data sheet's bound, 1 deg/s / 3^0.5.
_GYRO_BIAS_SOURCE = 'Bosch BMI088 data sheet: offset of +-1 deg/s; limits: 20 deg/s (assumed)'

GYRO_BIAS = MeasurementEffect(
    'gyro_bias',
    declare_each(('x', 'y', 'z'), 'rad/s', 0.0, -0.35, 0.35, 0.01, _GYRO_BIAS_SOURCE),
    'rates',
    gyro_bias,
)


def pressure_drift(p: Values, values: Values, time: float) -> Values:
    """
    Linear drift of the pressure, by weather or a warming sensor.

        p_read = p + rate t,   t since the start of the flight

    12 Pa are a metre. Weather changes by some 1 hPa an hour, 0.03 Pa/s; the sensor drifts less.
    """
    (rate,) = p
    return (values[0] + rate * time,)


_PRESSURE_DRIFT_SOURCE = (
    'BMP388: 0.75 Pa/K, warming by 5 K in ten minutes; weather: 1 hPa in an hour (both '
    'unverified, from memory); limits assumed'
)

PRESSURE_DRIFT = MeasurementEffect(
    'pressure_drift',
    (EffectParameter('rate', 'Pa/s', 0.0, -1.0, 1.0, 0.01, _PRESSURE_DRIFT_SOURCE),),
    'pressure',
    pressure_drift,
)


def range_offset(p: Values, values: Values, time: float) -> Values:
    """
    Constant offset of the range finder.

        d_read = d + offset

    It adds to the offset drawn for each flight. A sensor mounted lower or higher than in its
    vehicle file reads the same.
    """
    (offset,) = p
    return (values[0] + offset,)


# The spread is that of a uniform draw within the manual's bound, 20 mm / 3^0.5.
_RANGE_OFFSET_SOURCE = 'ST VL53L1X manual: error of +-20 mm in the dark; limits assumed'

RANGE_OFFSET = MeasurementEffect(
    'range_offset',
    (EffectParameter('offset', 'm', 0.0, -0.5, 0.5, 0.012, _RANGE_OFFSET_SOURCE),),
    'range',
    range_offset,
)


def tracker_misalignment(p: Values, values: Values, time: float) -> Values:
    """
    Rotation of the tracker's frame against the map about their common origin.

    Its axes are those of the map, turned by `yaw` about z, then by `pitch` about the new y and by
    `roll` about the new x: R = Rz(yaw) Ry(pitch) Rx(roll), tracker -> map. A point and an attitude
    read

        p_read = R' p,   q_read = q_R* q

    so a level flight appears to climb by pitch times the distance. Body-frame velocities and rates
    are unaffected. Gravity stays vertical in the map, so a tilt shows as a difference between the
    attitudes of tracker and accelerometer.
    """
    yaw, pitch, roll = p
    a, b, c, d = euler_to_quaternion(yaw, pitch, roll)
    x, y, z, i, j, k, w = values
    # p - 2 d (v x p) + 2 v x (v x p): the turn back, v = (a, b, c) the vector part.
    s, t, u = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return (
        x - d * s + b * u - c * t,
        y - d * t + c * s - a * u,
        z - d * u + a * t - b * s,
        # q_R* q: the conjugate turns the attitude into the tracker's frame
        d * i - a * w - b * k + c * j,
        d * j - b * w - c * i + a * k,
        d * k - c * w - a * j + b * i,
        d * w + a * i + b * j + c * k,
    )


def euler_to_quaternion(yaw: float, pitch: float, roll: float) -> Quaternion:
    """Return the quaternion x y z w of Rz(yaw) Ry(pitch) Rx(roll)."""
    # Half angles, as always in quaternions
    a, b, c = math.cos(0.5 * yaw), math.cos(0.5 * pitch), math.cos(0.5 * roll)
    d, e, f = math.sin(0.5 * yaw), math.sin(0.5 * pitch), math.sin(0.5 * roll)
    return (
        a * b * f - d * e * c,
        a * e * c + d * b * f,
        d * b * c - a * e * f,
        a * b * c + d * e * f,
    )


_YAW = 'assumed: the x axis of the tracker is aligned by eye with a line on the floor'
_TILT = 'assumed: calibration square on a floor that is level to half a degree'

TRACKER_MISALIGNMENT = MeasurementEffect(
    'tracker_misalignment',
    (
        EffectParameter('yaw', 'rad', 0.0, -math.pi, math.pi, 0.09, _YAW),
        *declare_each(('pitch', 'roll'), 'rad', 0.0, -0.5, 0.5, 0.009, _TILT),
    ),
    'pose',
    tracker_misalignment,
)


def marker_offset(p: Values, values: Values, time: float) -> Values:
    """
    Frame of the tracked markers on the vehicle, against the body frame.

    A tracker reports the pose of a rigid body whose axes and origin were drawn on its screen. Its
    origin is at (x, y, z) in the body, and R = Rz(yaw) Ry(pitch) Rx(roll) turns marker axes to
    body axes:

        p_read = p + R_body (x, y, z),   q_read = q q_R

    It moves with the vehicle, unlike `tracker_misalignment`, which turns the room.
    """
    x, y, z, yaw, pitch, roll = p
    a, b, c, d = euler_to_quaternion(yaw, pitch, roll)
    east, north, up, i, j, k, l = values  # noqa: E741
    # arm + 2 l (q x arm) + 2 q x (q x arm), q = (i, j, k) the vector part of the attitude.
    f, g, h = 2.0 * (j * z - k * y), 2.0 * (k * x - i * z), 2.0 * (i * y - j * x)
    return (
        east + x + l * f + j * h - k * g,
        north + y + l * g + k * f - i * h,
        up + z + l * h + i * g - j * f,
        l * a + d * i + j * c - k * b,
        l * b + d * j + k * a - i * c,
        l * c + d * k + i * b - j * a,
        l * d - i * a - j * b - k * c,
    )


_ARM = 'assumed: the origin is set by eye to the middle of the hull; limit: the size of a room'
_TURN = 'assumed: the axes are drawn by eye while the vehicle is held level; limit: any rotation'

MARKER_OFFSET = MeasurementEffect(
    'marker_offset',
    (
        *declare_each('xyz', 'm', 0.0, -10.0, 10.0, 0.03, _ARM),
        *declare_each(('yaw', 'pitch', 'roll'), 'rad', 0.0, -math.pi, math.pi, 0.05, _TURN),
    ),
    'pose',
    marker_offset,
)


def tracker_delay(p: Values, values: Values, time: float) -> Values:
    """
    Uncompensated latency of the tracker: exposure, image processing and network.

        t' = t - delay

    A pose stamped t is the true pose of t'. Between control steps the truth is interpolated
    (`lta_sim.tracker`); before the start it is the start pose.
    """
    (delay,) = p
    return (values[0] - delay,)


_TRACKER_DELAY_SOURCE = (
    'spread (assumed): two frames of a 100 Hz tracker; limit: cameras on a robot reach 0.1 s '
    'and more'
)

TRACKER_DELAY = MeasurementEffect(
    'tracker_delay',
    (EffectParameter('delay', 's', 0.0, 0.0, 1.0, 0.02, _TRACKER_DELAY_SOURCE),),
    'pose_time',
    tracker_delay,
)


def clock_offset(p: Values, values: Values, time: float) -> Values:
    """
    Constant offset of the vehicle's clock from the tracker's.

        clock(t) = t + offset,   t the tracker's time

    Only the difference of the clocks is observable. The graph runs on the vehicle's time, which
    keys the lockstep, so the tracker's side is shifted: its stamp t carries the pose of the
    vehicle's time t + offset (`lta_sim.tracker`). With a positive offset the vehicle's sensors
    appear late and the tracker early.
    """
    (offset,) = p
    return (values[0] + offset,)


_CLOCK_OFFSET_SOURCE = 'assumed: two computers in one network without time synchronisation'

CLOCK_OFFSET = MeasurementEffect(
    'clock_offset',
    (EffectParameter('offset', 's', 0.0, -0.5, 0.5, 0.05, _CLOCK_OFFSET_SOURCE),),
    'clock',
    clock_offset,
)


def clock_skew(p: Values, values: Values, time: float) -> Values:
    """
    Rate error of the vehicle's clock relative to the tracker's.

        clock(t) = t (1 + skew),   t the tracker's time since the start of the flight

    The error is zero at the start; `clock_offset` is the constant part, and explains why the
    tracker's side is shifted.
    """
    (skew,) = p
    return (values[0] + skew * time,)


_CLOCK_SKEW_SOURCE = (
    'clock crystals are accurate to about 50 ppm (unverified, from memory); limits assumed'
)

CLOCK_SKEW = MeasurementEffect(
    'clock_skew',
    (EffectParameter('skew', '1', 0.0, -1e-3, 1e-3, 3e-5, _CLOCK_SKEW_SOURCE),),
    'clock',
    clock_skew,
)
