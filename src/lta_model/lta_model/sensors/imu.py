# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
BMI088 inertial sensor: specific force and angular rate with offset, scale error, noise and counts.

Noise and offsets: Bosch BMI088 data sheet. The white noise of a sample is density *
sqrt(bandwidth), with the bandwidths of the 100 Hz output settings taken as ideal low-passes. The
signal itself is not filtered: an airship moves far below these bandwidths.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.compilation.compiler import compile_functions
from lta_config.constants import RADIANS_PER_DEGREE, STANDARD_GRAVITY
from lta_model.measurement_chain import apply_chain, Chain, round_to_step
from lta_model.rigid_body import rotation_matrix
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class ImuSettings:
    """Data sheet values; offsets and scale errors are the largest, of uniform distributions."""

    acceleration_noise: Vector = (160e-6, 160e-6, 190e-6)  # density [g/sqrt(Hz)]
    # Of the accelerometer at a sample rate of 100 Hz, normal mode, and of the gyroscope [Hz]
    acceleration_bandwidth: float = 40.0
    rate_bandwidth: float = 32.0
    acceleration_offset: float = 0.020  # [g]
    acceleration_scale: float = 0.01  # relative; assumed equal to that of the gyroscope [1]
    acceleration_range: float = 6.0  # full scale [g]
    rate_noise: float = 0.014  # density [deg/s/sqrt(Hz)]
    rate_offset: float = 1.0  # [deg/s]
    rate_scale: float = 0.01  # relative [1]
    rate_range: float = 500.0  # full scale [deg/s]


@final
@dataclass(frozen=True, slots=True)
class ImuErrors:
    """Errors that stay constant during a flight, specific force x y z, then rate x y z."""

    gain: tuple[float, ...]
    offset: tuple[float, ...]
    noise: tuple[float, ...]
    step: tuple[float, ...]
    full_scale: tuple[float, ...]


def draw_errors(settings: ImuSettings, rng: Generator) -> ImuErrors:
    """Return the errors of one flight; offset and scale error are uniform within their bounds."""
    bounds = error_bounds(settings)
    return ImuErrors(
        gain=tuple(
            1.0 + bound * x for bound, x in zip(bounds.gain, _draw_six_uniforms(rng), strict=True)
        ),
        offset=tuple(
            bound * x for bound, x in zip(bounds.offset, _draw_six_uniforms(rng), strict=True)
        ),
        noise=bounds.noise,
        step=bounds.step,
        full_scale=bounds.full_scale,
    )


def error_bounds(settings: ImuSettings) -> ImuErrors:
    """Return the largest errors: `gain` is the largest deviation of the factor from 1."""
    g, deg = STANDARD_GRAVITY, RADIANS_PER_DEGREE
    density = (*(n * g for n in settings.acceleration_noise), *(settings.rate_noise * deg,) * 3)
    width = (settings.acceleration_bandwidth,) * 3 + (settings.rate_bandwidth,) * 3
    full_scale = (settings.acceleration_range * g,) * 3 + (settings.rate_range * deg,) * 3
    return ImuErrors(
        gain=(settings.acceleration_scale,) * 3 + (settings.rate_scale,) * 3,
        offset=(settings.acceleration_offset * g,) * 3 + (settings.rate_offset * deg,) * 3,
        noise=tuple(n * math.sqrt(b) for n, b in zip(density, width, strict=True)),
        step=tuple(end / 2**15 for end in full_scale),  # 16 bit, signed
        full_scale=full_scale,
    )


def _draw_six_uniforms(rng: Generator) -> list[float]:
    """Return six numbers uniform in [-1, 1)."""
    # Plain floats are faster than NumPy scalars in the loops that use them
    numbers: list[float] = rng.uniform(-1.0, 1.0, 6).tolist()
    return numbers


def imu_specific_force(
    velocity: Vector,
    rates: Vector,
    velocity_rate: Vector,
    rates_rate: Vector,
    up: Vector,
    position: Vector,
    gravity: float,
) -> Vector:
    """Return the specific force at the sensor: a + w' x r + w x (w x r) + g up."""
    wx, wy, wz = rates
    dx, dy, dz = rates_rate
    rx, ry, rz = position
    # v + w x r is the sensor's own velocity, so both products with w become one.
    ux = velocity[0] + wy * rz - wz * ry
    uy = velocity[1] + wz * rx - wx * rz
    uz = velocity[2] + wx * ry - wy * rx
    return (
        velocity_rate[0] + dy * rz - dz * ry + wy * uz - wz * uy + gravity * up[0],
        velocity_rate[1] + dz * rx - dx * rz + wz * ux - wx * uz + gravity * up[1],
        velocity_rate[2] + dx * ry - dy * rx + wx * uy - wy * ux + gravity * up[2],
    )


def read_axis(
    truth: float, normal: float, gain: float, offset: float, noise: float, step: float, end: float
) -> float:
    """Return the reading of one axis, rounded to counts and then clipped at full scale."""
    return min(max(round_to_step(gain * truth + offset + noise * normal, step), -end), end)


def pack_errors(errors: ImuErrors) -> Array:
    """Return the errors as an array for compiled code, a row for each kind."""
    kinds = (errors.gain, errors.offset, errors.noise, errors.step, errors.full_scale)
    return np.array(kinds)


def apply_errors(truth: Sequence[float] | Array, errors: Array, chance: Array) -> None:
    """Replace the normal deviates in `chance` by readings of the truth."""
    for i in range(6):
        chance[i] = read_axis(
            truth[i],
            chance[i],
            errors[0, i],
            errors[1, i],
            errors[2, i],
            errors[3, i],
            errors[4, i],
        )


def specific_force_at(
    state: Sequence[float] | Array, rate: Sequence[float] | Array, place: Vector, gravity: float
) -> Vector:
    """Return the true specific force at the sensor, from a state and its derivative [m/s^2]."""
    # State layout: quaternion 3:7, velocity 7:10, rates 10:13
    turn = rotation_matrix((state[3], state[4], state[5], state[6]))
    return imu_specific_force(
        (state[7], state[8], state[9]),
        (state[10], state[11], state[12]),
        (rate[7], rate[8], rate[9]),
        (rate[10], rate[11], rate[12]),
        # Third row: the vertical in the body frame
        (turn[6], turn[7], turn[8]),
        place,
        gravity,
    )


def _write_truth(state: Array, rate: Array, place: Array, truth: Array) -> None:
    """Write true specific force and rates at the sensor; `place` ends with gravity."""
    truth[0], truth[1], truth[2] = specific_force_at(
        state, rate, (place[0], place[1], place[2]), place[3]
    )
    truth[3], truth[4], truth[5] = state[10], state[11], state[12]


def _write_reading(
    state: Array, rate: Array, place: Array, truth: Array, errors: Array, chance: Array
) -> None:
    """Write the truth and apply the errors, where no effect comes between them."""
    _write_truth(state, rate, place, truth)
    apply_errors(truth, errors, chance)


@final
class Imu:
    """
    The compiled sensor of one flight, read at every control step.

    Parameters
    ----------
    errors : ImuErrors
        Errors of this flight.
    position : tuple of 3 floats
        Place in the body frame. [m]
    gravity : float
        Acceleration of free fall. [m/s^2]
    on_force, on_rates : Chain
        Measurement effects of the vehicle.

    """

    def __init__(
        self,
        errors: ImuErrors,
        position: Vector,
        gravity: float,
        rng: Generator,
        on_force: Chain = (),
        on_rates: Chain = (),
    ) -> None:
        self._errors, self._rng = pack_errors(errors), rng
        self._place, self._truth = np.array([*position, gravity]), np.empty(6)
        self._on_force, self._on_rates = on_force, on_rates
        self._write_truth, self._apply_errors, self._write_reading = compile_functions(
            _write_truth, apply_errors, _write_reading
        )

    def prepare(self, state: Array, rate: Array) -> None:
        """Compile the reading or load it from disk, without drawing random numbers."""
        truth, reading = np.empty(6), np.zeros(6)
        self._write_truth(state, rate, self._place, truth)
        self._apply_errors(truth, self._errors, reading)
        self._write_reading(state, rate, self._place, truth, self._errors, reading)

    def read(self, state: Array, rate: Array, elapsed: float) -> tuple[Vector, Vector]:
        """Return measured specific force [m/s^2] and angular rate [rad/s]."""
        truth, reading = self._truth, self._rng.standard_normal(6)
        # Measurement effects are Python functions, so the compiled path is split around them
        if self._on_force or self._on_rates:
            self._write_truth(state, rate, self._place, truth)
            numbers = truth.tolist()
            truth[:3] = apply_chain(self._on_force, tuple(numbers[:3]), elapsed)
            truth[3:] = apply_chain(self._on_rates, tuple(numbers[3:]), elapsed)
            self._apply_errors(truth, self._errors, reading)
        else:
            self._write_reading(state, rate, self._place, truth, self._errors, reading)
        x, y, z, a, b, c = reading.tolist()
        return (x, y, z), (a, b, c)
