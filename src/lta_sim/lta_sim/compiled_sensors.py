"""
Compiled sensor models with counter-based random numbers, for batches of closed loops.

Each reading is that of the sensor's own file in `lta_model.sensors`. Only the random numbers
differ (`counter_rng`), so a flight in a batch is similar but not identical to the single flight of
the same seed.
"""

import math
from typing import NamedTuple

from lta_model.effects.air import stationary_memory
from lta_model.sensors.imu import read_axis
from lta_model.sensors.pressure import air_pressure, read_pressure
from lta_model.sensors.range import height_and_tilt, noise_deviation, read_range, slant_range
from lta_sim.counter_rng import draw_normals, draw_uniforms

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]

# Random streams.
START, ERRORS, IMU, RANGE, PRESSURE, LIGHT, TURBULENCE, EDDIES, GAINS, SWEEP = range(10)


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


def draw_symmetric_pair(seed: int, lane: int) -> tuple[float, float]:
    """Return two numbers uniform between -1 and 1, constant during a flight."""
    # From 0..1 to -1..1
    a, b = draw_uniforms(seed, ERRORS, 0, lane)
    return 2.0 * a - 1.0, 2.0 * b - 1.0


def draw_six_uniforms(bound: Six, seed: int, lane: int) -> Six:
    """Return six numbers uniform within plus or minus the given bounds."""
    a, b = draw_symmetric_pair(seed, lane)
    c, d = draw_symmetric_pair(seed, lane + 1)
    e, f = draw_symmetric_pair(seed, lane + 2)
    return (
        bound[0] * a, bound[1] * b, bound[2] * c, bound[3] * d, bound[4] * e, bound[5] * f,
    )  # fmt: skip


def draw_errors(sensors: SensorDatasheets, seed: int) -> SensorErrors:
    """Return the errors of one flight."""
    imu = sensors.imu
    # Each call uses three lanes: gains 0 to 2, offsets 3 to 5, then one lane per scalar pair
    g = draw_six_uniforms(imu.gain, seed, 0)
    gain = (1.0 + g[0], 1.0 + g[1], 1.0 + g[2], 1.0 + g[3], 1.0 + g[4], 1.0 + g[5])
    offset, drift = draw_symmetric_pair(seed, 6)
    near, _ = draw_symmetric_pair(seed, 7)
    return SensorErrors(
        ImuAxes(gain, draw_six_uniforms(imu.offset, seed, 3), imu.noise, imu.step, imu.full_scale),
        sensors.range_offset * near,
        sensors.pressure_offset * offset,
        sensors.drift * drift,
    )


def simulate_axis_reading(imu: ImuAxes, axis: int, truth: float, normal: float) -> float:
    """Return the reading of one axis. [m/s2 or rad/s]"""
    return read_axis(
        truth,
        normal,
        imu.gain[axis],
        imu.offset[axis],
        imu.noise[axis],
        imu.step[axis],
        imu.full_scale[axis],
    )


def simulate_imu_reading(
    errors: SensorErrors, seed: int, step: int, force: Vector, rates: Vector
) -> tuple[Vector, Vector]:
    """
    Return measured specific force [m/s2] and rates [rad/s] of one control step.

    `force` and `rates` are the true values at the sensor in the body frame.
    """
    imu = errors.imu
    a, b = draw_normals(seed, IMU, step, 0)
    c, d = draw_normals(seed, IMU, step, 1)
    e, f = draw_normals(seed, IMU, step, 2)
    return (
        simulate_axis_reading(imu, 0, force[0], a),
        simulate_axis_reading(imu, 1, force[1], b),
        simulate_axis_reading(imu, 2, force[2], c),
    ), (
        simulate_axis_reading(imu, 3, rates[0], d),
        simulate_axis_reading(imu, 4, rates[1], e),
        simulate_axis_reading(imu, 5, rates[2], f),
    )


def simulate_range_reading(
    sensors: SensorDatasheets, errors: SensorErrors, seed: int, tick: int, state: tuple[float, ...]
) -> float:
    """Return range reading number `tick` in whole millimetres, NaN out of range. [m]"""
    height, up = height_and_tilt(state, sensors.range_place)
    distance = slant_range(height, up, sensors.farthest)
    if distance == math.inf:
        return math.nan
    noise = noise_deviation(sensors.range_noise, distance) * draw_normals(seed, RANGE, tick, 0)[0]
    reading = read_range(distance, errors.range_offset, noise, sensors.nearest, sensors.farthest)
    return reading if math.isfinite(reading) else math.nan


def simulate_pressure_reading(
    sensors: SensorDatasheets,
    errors: SensorErrors,
    seed: int,
    step: int,
    height: float,
    elapsed: float,
) -> float:
    """Return the pressure reading at a height of the hull centre and a flight time. [Pa]"""
    truth = air_pressure(sensors.floor, height + sensors.imu_place[2])
    noise = sensors.pressure_noise * draw_normals(seed, PRESSURE, step, 0)[0]
    return read_pressure(
        truth, errors.pressure_offset, errors.drift * elapsed, noise, sensors.resolution
    )


def draw_white_noise(seed: int, step: int, period: float) -> Vector:
    """Return turbulence noise of unit intensity, constant over a period [s]. [s^-1/2]"""
    a, b = draw_normals(seed, TURBULENCE, step, 0)
    c, _ = draw_normals(seed, TURBULENCE, step, 1)
    # Noise held for a period has unit intensity if its variance is 1 / period
    scale = 1.0 / math.sqrt(period)
    return a * scale, b * scale, c * scale


def draw_turbulence_memory(seed: int) -> tuple[float, ...]:
    """Return the initial memory of turbulence, in its stationary state."""
    a, b = draw_normals(seed, EDDIES, 0, 0)
    c, d = draw_normals(seed, EDDIES, 0, 1)
    e, _ = draw_normals(seed, EDDIES, 0, 2)
    return stationary_memory((a, b, c, d, e))
