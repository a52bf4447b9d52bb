"""
Compiled sensors of the estimator with counter-based random numbers.

Plain functions of numbers and tuples, for batches of closed loops. The error model of each
reading is that of the sensor's own file in `lta_model.sensors`, constant errors and noise alike.
Only the random numbers are drawn differently (`counter_rng`), so that a flight of a batch
resembles the flight of that seed but is not identical.
"""

import math
from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_model.effects.air.turbulence import stationary_memory
from lta_model.rigid_body import rotation_matrix
from lta_model.sensors.imu import imu_specific_force
from lta_model.sensors.pressure import air_pressure
from lta_model.sensors.range import height_and_tilt, noise_deviation, RESOLUTION
from lta_sim.counter_rng import draw_normals, draw_uniforms

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]

# Random streams.
START, ERRORS, IMU, RANGE, PRESSURE, LIGHT, TURBULENCE, EDDIES, GAINS = range(9)
# Adding and subtracting it rounds a number below 2^51 to an integer, halves to even.
WHOLE = 6755399441055744.0


class ImuAxes(NamedTuple):
    """Axes of the inertial sensor, force x y z, then rate x y z; see `imu.ImuErrors`."""

    gain: Six
    offset: Six
    noise: Six
    step: Six
    full_scale: Six


class SensorDatasheets(NamedTuple):
    """Error bounds from the data sheets; drawn errors are uniform within them."""

    imu: ImuAxes
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


class SensorErrors(NamedTuple):
    """Errors that stay constant during a flight, drawn from `SensorDatasheets`."""

    imu: ImuAxes
    range_offset: float
    pressure_offset: float
    drift: float


def round_to_step(value: float, step: float) -> float:
    """Return the nearest multiple of a step, halves to the even one."""
    return ((value / step + WHOLE) - WHOLE) * step


def draw_spread(seed: int, lane: int) -> tuple[float, float]:
    """Return two numbers uniform between -1 and 1, drawn once in a flight."""
    a, b = draw_uniforms(seed, ERRORS, 0, lane)
    return 2.0 * a - 1.0, 2.0 * b - 1.0


def draw_six(bound: Six, seed: int, lane: int) -> Six:
    """Return six numbers uniform within bounds."""
    a, b = draw_spread(seed, lane)
    c, d = draw_spread(seed, lane + 1)
    e, f = draw_spread(seed, lane + 2)
    return (
        bound[0] * a, bound[1] * b, bound[2] * c, bound[3] * d, bound[4] * e, bound[5] * f,
    )  # fmt: skip


def draw_errors(sensors: SensorDatasheets, seed: int) -> SensorErrors:
    """Return the errors of one flight."""
    imu = sensors.imu
    g = draw_six(imu.gain, seed, 0)
    gain = (1.0 + g[0], 1.0 + g[1], 1.0 + g[2], 1.0 + g[3], 1.0 + g[4], 1.0 + g[5])
    offset, drift = draw_spread(seed, 6)
    near, _ = draw_spread(seed, 7)
    return SensorErrors(
        ImuAxes(gain, draw_six(imu.offset, seed, 3), imu.noise, imu.step, imu.full_scale),
        sensors.range_offset * near,
        sensors.pressure_offset * offset,
        sensors.drift * drift,
    )


def sample_axis(imu: ImuAxes, axis: int, truth: float, normal: float) -> float:
    """Return the reading of one axis, quantised and clipped at full scale. [m/s2 or rad/s]"""
    value = imu.gain[axis] * truth + imu.offset[axis] + imu.noise[axis] * normal
    told, end = round_to_step(value, imu.step[axis]), imu.full_scale[axis]
    return min(max(told, -end), end)


def specific_force_at(
    sensors: SensorDatasheets, state: tuple[float, ...], rate: tuple[float, ...]
) -> Vector:
    """Return the true specific force at the sensor, from a state and its derivative. [m/s2]"""
    turn = rotation_matrix((state[3], state[4], state[5], state[6]))
    return imu_specific_force(
        (state[7], state[8], state[9]),
        (state[10], state[11], state[12]),
        (rate[7], rate[8], rate[9]),
        (rate[10], rate[11], rate[12]),
        (turn[6], turn[7], turn[8]),
        sensors.imu_place,
        STANDARD_GRAVITY,
    )


def sample_imu(
    errors: SensorErrors, seed: int, step: int, force: Vector, rates: Vector
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
    a, b = draw_normals(seed, IMU, step, 0)
    c, d = draw_normals(seed, IMU, step, 1)
    e, f = draw_normals(seed, IMU, step, 2)
    return (
        sample_axis(imu, 0, force[0], a),
        sample_axis(imu, 1, force[1], b),
        sample_axis(imu, 2, force[2], c),
    ), (
        sample_axis(imu, 3, rates[0], d),
        sample_axis(imu, 4, rates[1], e),
        sample_axis(imu, 5, rates[2], f),
    )


def sample_range(
    sensors: SensorDatasheets, errors: SensorErrors, seed: int, tick: int, state: tuple[float, ...]
) -> float:
    """Return a range in whole millimetres, NaN where there is none; `tick` counts readings. [m]"""
    height, up = height_and_tilt(state, sensors.range_place)
    if up <= 0.0 or height > sensors.farthest * up:
        return math.nan
    distance = max(height, 0.0) / up
    noise = noise_deviation(sensors.range_noise, distance) * draw_normals(seed, RANGE, tick, 0)[0]
    told = distance + errors.range_offset + noise
    if told > sensors.farthest or told < sensors.nearest:
        return math.nan
    return round_to_step(told, RESOLUTION)


def sample_pressure(
    sensors: SensorDatasheets,
    errors: SensorErrors,
    seed: int,
    step: int,
    height: float,
    elapsed: float,
) -> float:
    """Return a pressure at a height of the hull centre [m] after a time of flight [s]. [Pa]"""
    truth = air_pressure(sensors.floor, height + sensors.imu_place[2])
    noise = sensors.pressure_noise * draw_normals(seed, PRESSURE, step, 0)[0]
    told = truth + errors.pressure_offset + errors.drift * elapsed + noise
    return round_to_step(told, sensors.resolution)


def draw_white_noise(seed: int, step: int, period: float) -> Vector:
    """Return noise of unit intensity for turbulence, held for a period [s]. [s^-1/2]"""
    a, b = draw_normals(seed, TURBULENCE, step, 0)
    c, _ = draw_normals(seed, TURBULENCE, step, 1)
    scale = 1.0 / math.sqrt(period)
    return a * scale, b * scale, c * scale


def draw_turbulence_memory(seed: int) -> tuple[float, ...]:
    """Return the initial memory of turbulence, in its stationary state."""
    a, b = draw_normals(seed, EDDIES, 0, 0)
    c, d = draw_normals(seed, EDDIES, 0, 1)
    e, _ = draw_normals(seed, EDDIES, 0, 2)
    return stationary_memory((a, b, c, d, e))
