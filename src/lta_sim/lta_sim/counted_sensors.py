"""
The sensors of the estimator with counted chance: the same errors as `lta_sim.sensors`, compiled.

Plain functions of numbers and tuples, for batches of closed loops. Each reading has the law of the
sensor's own file, errors that stay and noise alike; only the numbers are drawn otherwise
(`counted_chance`), so that a flight of a batch is like that of the seed, not the same.
"""

import math
from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_model.effects.air.turbulence import stationary
from lta_model.rigid_body import rotation
from lta_model.sensors.imu import specific_force
from lta_model.sensors.pressure import air_pressure
from lta_model.sensors.range import deviation, outlook, RESOLUTION
from lta_sim.counted_chance import normals, uniforms

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]

# Streams of chance.
START, ERRORS, IMU, RANGE, PRESSURE, LIGHT, TURBULENCE, EDDIES, GAINS = range(9)
# Added to a number below 2^51 and taken away again it leaves the nearest whole one, halves even.
WHOLE = 6755399441055744.0


class Axes(NamedTuple):
    """Of the inertial sensor, force x y z, then rate x y z; see `imu.ImuErrors`."""

    gain: Six
    offset: Six
    noise: Six
    step: Six
    full_scale: Six


class Sensors(NamedTuple):
    """
    What the data sheets say; drawn errors are uniform within their bounds.

    Attributes
    ----------
    imu : Axes
        Bounds: `gain` is the largest deviation of the factor from 1.
    imu_place, range_place : tuple of float
        In the body frame. [m]
    nearest, farthest, range_noise, range_offset : float
        Of the range finder. [m]
    floor, pressure_noise, pressure_offset, drift, resolution : float
        Pressure at the floor and errors of the barometer. [Pa, Pa/s]

    """

    imu: Axes
    imu_place: Vector
    range_place: Vector
    nearest: float
    farthest: float
    range_noise: float
    range_offset: float
    floor: float
    pressure_noise: float
    pressure_offset: float
    drift: float
    resolution: float


class Errors(NamedTuple):
    """What stays the same during a flight: as in `Sensors`, but drawn."""

    imu: Axes
    range_offset: float
    pressure_offset: float
    drift: float


def whole(value: float, step: float) -> float:
    """Return the nearest multiple of a step, halves to the even one."""
    return ((value / step + WHOLE) - WHOLE) * step


def spread(seed: int, lane: int) -> tuple[float, float]:
    """Return two numbers uniform between -1 and 1, drawn once in a flight."""
    a, b = uniforms(seed, ERRORS, 0, lane)
    return 2.0 * a - 1.0, 2.0 * b - 1.0


def spread_six(bound: Six, seed: int, lane: int) -> Six:
    """Return six numbers uniform within bounds."""
    a, b = spread(seed, lane)
    c, d = spread(seed, lane + 1)
    e, f = spread(seed, lane + 2)
    return (
        bound[0] * a, bound[1] * b, bound[2] * c, bound[3] * d, bound[4] * e, bound[5] * f,
    )  # fmt: skip


def draw_errors(sensors: Sensors, seed: int) -> Errors:
    """Return the errors of one flight."""
    imu = sensors.imu
    g = spread_six(imu.gain, seed, 0)
    gain = (1.0 + g[0], 1.0 + g[1], 1.0 + g[2], 1.0 + g[3], 1.0 + g[4], 1.0 + g[5])
    offset, drift = spread(seed, 6)
    near, _ = spread(seed, 7)
    return Errors(
        Axes(gain, spread_six(imu.offset, seed, 3), imu.noise, imu.step, imu.full_scale),
        sensors.range_offset * near,
        sensors.pressure_offset * offset,
        sensors.drift * drift,
    )


def axis_reading(imu: Axes, axis: int, truth: float, normal: float) -> float:
    """Return what one axis says: counted, and clipped at full scale. [m/s2 or rad/s]"""
    value = imu.gain[axis] * truth + imu.offset[axis] + imu.noise[axis] * normal
    told, end = whole(value, imu.step[axis]), imu.full_scale[axis]
    return min(max(told, -end), end)


def force_at(sensors: Sensors, state: tuple[float, ...], rate: tuple[float, ...]) -> Vector:
    """Return the true specific force at the sensor, from a state and its derivative. [m/s2]"""
    turn = rotation((state[3], state[4], state[5], state[6]))
    return specific_force(
        (state[7], state[8], state[9]),
        (state[10], state[11], state[12]),
        (rate[7], rate[8], rate[9]),
        (rate[10], rate[11], rate[12]),
        (turn[6], turn[7], turn[8]),
        sensors.imu_place,
        STANDARD_GRAVITY,
    )


def imu_reading(
    errors: Errors, seed: int, step: int, force: Vector, rates: Vector
) -> tuple[Vector, Vector]:
    """
    Return measured specific force [m/s2] and rates [rad/s] of a control step.

    Parameters
    ----------
    errors : Errors
        Of the flight.
    seed, step : int
        Of the flight, and which control step.
    force, rates : tuple of float
        The truth at the sensor, body frame.

    """
    imu = errors.imu
    a, b = normals(seed, IMU, step, 0)
    c, d = normals(seed, IMU, step, 1)
    e, f = normals(seed, IMU, step, 2)
    return (
        axis_reading(imu, 0, force[0], a),
        axis_reading(imu, 1, force[1], b),
        axis_reading(imu, 2, force[2], c),
    ), (
        axis_reading(imu, 3, rates[0], d),
        axis_reading(imu, 4, rates[1], e),
        axis_reading(imu, 5, rates[2], f),
    )


def range_reading(
    sensors: Sensors, errors: Errors, seed: int, tick: int, state: tuple[float, ...]
) -> float:
    """Return a range in whole millimetres, NaN where there is none; `tick` counts readings. [m]"""
    height, up = outlook(state, sensors.range_place)
    if up <= 0.0 or height > sensors.farthest * up:
        return math.nan
    distance = max(height, 0.0) / up
    noise = deviation(sensors.range_noise, distance) * normals(seed, RANGE, tick, 0)[0]
    told = distance + errors.range_offset + noise
    if told > sensors.farthest or told < sensors.nearest:
        return math.nan
    return whole(told, RESOLUTION)


def pressure_reading(
    sensors: Sensors, errors: Errors, seed: int, step: int, height: float, elapsed: float
) -> float:
    """Return a pressure at a height of the hull centre [m] after a time of flight [s]. [Pa]"""
    truth = air_pressure(sensors.floor, height + sensors.imu_place[2])
    noise = sensors.pressure_noise * normals(seed, PRESSURE, step, 0)[0]
    told = truth + errors.pressure_offset + errors.drift * elapsed + noise
    return whole(told, sensors.resolution)


def white_noise(seed: int, step: int, period: float) -> Vector:
    """Return noise of unit intensity for turbulence, held for a period [s]. [s^-1/2]"""
    a, b = normals(seed, TURBULENCE, step, 0)
    c, _ = normals(seed, TURBULENCE, step, 1)
    scale = 1.0 / math.sqrt(period)
    return a * scale, b * scale, c * scale


def eddies(seed: int) -> tuple[float, ...]:
    """Return the memory of turbulence at the start, as of one that has blown for long."""
    a, b = normals(seed, EDDIES, 0, 0)
    c, d = normals(seed, EDDIES, 0, 1)
    e, _ = normals(seed, EDDIES, 0, 2)
    return stationary((a, b, c, d, e))
