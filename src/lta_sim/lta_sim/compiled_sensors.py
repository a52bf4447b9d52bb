# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compiled sensor models with counter-based random numbers, for batches of closed loops.

Each reading is that of the sensor's own file in `lta_model.sensors`. Only the random numbers
differ, so a flight in a batch is similar but not identical to the single flight of the same seed:
draw n of stream s of a flight is a function of (s, n). Threefry-2x32 with 20 rounds (Salmon,
Moraes, Dror and Shaw 2011, Parallel random numbers: as easy as 1, 2, 3,
doi:10.1145/2063384.2063405) needs only additions, rotations and exclusive ors of 32 bits, and so
has the same bits in plain Python, compiled, and on a GPU. Normal deviates use logarithm and
cosine, and may differ in the last bit between these.
"""

import math
from typing import NamedTuple

from lta_model.effects.air import stationary_memory
from lta_model.rigid_body import height_and_tilt
from lta_model.sensors.imu import read_axis
from lta_model.sensors.pressure import air_pressure, read_pressure
from lta_model.sensors.range import noise_deviation, read_range, slant_range

MASK_32 = 0xFFFFFFFF
# Key parity and rotation constants of Threefry-2x32, from the paper
PARITY = 0x1BD11BDA
ROTATIONS = (13, 15, 26, 6, 17, 29, 16, 24)
ROUND_GROUPS = 5  # of four turns each
# 2^-32
SCALE = 1.0 / 4294967296.0


def threefry(key: int, stream: int, first: int, second: int) -> tuple[int, int]:
    """
    Return 64 random bits as two 32-bit words.

    `key`, `stream`: identify the sequence; 32 bits each. `first`, `second`: counter within the
    sequence; 32 bits each.
    """
    keys = (key, stream, PARITY ^ key ^ stream)
    x, y = (first + key) & MASK_32, (second + stream) & MASK_32
    for group in range(ROUND_GROUPS):
        for k in range(4):
            turn = ROTATIONS[4 * (group % 2) + k]
            # The mask emulates 32-bit overflow, because Python's integers are unbounded
            x = (x + y) & MASK_32
            y = (((y << turn) & MASK_32) | (y >> (32 - turn))) ^ x
        # Key injection after every four rounds
        x = (x + keys[(group + 1) % 3]) & MASK_32
        y = (y + keys[(group + 2) % 3] + group + 1) & MASK_32
    return x, y


def draw_uniforms(seed: int, stream: int, turn: int, lane: int) -> tuple[float, float]:
    """
    Return two numbers uniform between 0 and 1, both excluded.

    `seed`, `stream`: seed of the flight, and number of the sensor or event. `turn`, `lane`:
    control step, and index of the draw within it.
    """
    x, y = threefry(seed, stream, turn, lane)
    # The half excludes 0, so that the logarithm of Box and Muller is finite
    return (x + 0.5) * SCALE, (y + 0.5) * SCALE


def draw_normals(seed: int, stream: int, turn: int, lane: int) -> tuple[float, float]:
    """Return two normal deviates (Box and Muller 1958); arguments as for `draw_uniforms`."""
    a, b = draw_uniforms(seed, stream, turn, lane)
    radius = math.sqrt(-2.0 * math.log(a))
    return radius * math.cos(2.0 * math.pi * b), radius * math.sin(2.0 * math.pi * b)


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
    """Return the reading of one axis [m/s2 or rad/s]."""
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
    """Return range reading number `tick` in whole millimetres, NaN out of range [m]."""
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
    state: tuple[float, ...],
    elapsed: float,
) -> float:
    """Return the pressure reading at a state and a flight time; it is beside the IMU [Pa]."""
    truth = air_pressure(sensors.floor, height_and_tilt(state, sensors.imu_place)[0])
    noise = sensors.pressure_noise * draw_normals(seed, PRESSURE, step, 0)[0]
    return read_pressure(
        truth, errors.pressure_offset, errors.drift * elapsed, noise, sensors.resolution
    )


def draw_white_noise(seed: int, step: int, period: float) -> Vector:
    """Return turbulence noise of unit intensity, constant over a period [s] [s^-1/2]."""
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
