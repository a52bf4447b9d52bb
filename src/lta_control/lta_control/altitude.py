# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate altitude and climb rate from range, pressure and vertical acceleration.

A Kalman filter with three states: height of the hull centre above the floor, climb rate, and the
offset of the pressure height, which drifts slowly with weather and temperature. The range finder
gives the height while the floor is within its range; beyond that the filter relies on pressure.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings

STUCK = 2.0  # s of turning motors without a new reading, after which a sensor is not believed


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


class SensorWatch(NamedTuple):
    """The newest reading of a sensor, and how long motors have turned since it changed [s]."""

    reading: float = 0.0
    age: float = 0.0


class HeightSensors(NamedTuple):
    """The two sensors that measure the height."""

    range: SensorWatch = SensorWatch()
    pressure: SensorWatch = SensorWatch()


def mask_out_of_range(reading: float, lowest: float, highest: float) -> float:
    """Return a reading, or NaN outside the sensor's range (REP-117)."""
    return reading if lowest <= reading <= highest else math.nan


def watch_sensor(watch: SensorWatch, reading: float, turning: bool, dt: float) -> SensorWatch:
    """
    Return what is known about a sensor `dt` seconds later.

    Noise changes every reading of a drone in flight, so one that repeats to the bit is no new
    one; neither is NaN or infinity. At rest a sensor may be quiet: time counts while motors are
    `turning`.
    """
    if math.isfinite(reading) and reading != watch.reading:
        return SensorWatch(reading, 0.0)
    return SensorWatch(watch.reading, watch.age + dt if turning else watch.age)


def watch_height_sensors(
    sensors: HeightSensors, distance: float, pressure: float, turning: bool, dt: float
) -> HeightSensors:
    """Return what is known about both sensors after readings [m, Pa]; see `watch_sensor`."""
    return HeightSensors(
        watch_sensor(sensors.range, distance, turning, dt),
        watch_sensor(sensors.pressure, pressure, turning, dt),
    )


def is_stuck(watch: SensorWatch) -> bool:
    """Return whether a sensor has given no new reading for too long."""
    return watch.age > STUCK


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
