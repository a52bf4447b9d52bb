# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate sensors with noise, each with its own clock and stamps."""

from dataclasses import dataclass
import math
from typing import Final, final, Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from campaigns.challenge.body import GRAVITY
from campaigns.challenge.flight import Array, SimulatedTrajectory, TICK
from campaigns.challenge.truth import VehicleTruth

Draw = np.random.Generator
Stamps = Literal['exact', 'millisecond', 'grid', 'jitter']

STAMPS: Final[tuple[Stamps, ...]] = ('exact', 'millisecond', 'grid', 'jitter')
MILLISECOND: Final = 1e-3  # s
POSE_GRID: Final = 2e-3  # s; grid of the pose stamps, in one of the stamp modes
JITTER: Final = 3e-4  # s; standard deviation of jittering stamps
# Range of the relative rate error of a sensor. An exact rate would keep the stamps at one point
# of their grid, or let them drift along it like a wrong clock.
CLOCK: Final = (1e-3, 5e-3)

POSE_RATE: Final = 100.0  # Hz
IMU_RATE: Final = 100.0
RANGE_RATE: Final = 40.0
PRESSURE_RATE: Final = 50.0
BATTERY_RATE: Final = 10.0

PLACE_NOISE: Final = 1e-3  # m
ATTITUDE_NOISE: Final = 2.5e-3  # rad
GYRO_NOISE: Final = 2.4e-3  # rad/s
FORCE_NOISE: Final = 0.02  # m/s2
RANGE_NOISE: Final = 5e-3  # m
PRESSURE_NOISE: Final = 0.6  # Pa
PRESSURE_WALK: Final = 0.03  # Pa per square root of a second
VOLTAGE_NOISE: Final = 2e-3  # V

SEA_LEVEL: Final = 101325.0  # Pa
SCALE_HEIGHT: Final = 8577.0  # m; of air at 20 C: R T / (M g)
CHARGE: Final = 900.0  # C; capacity of the battery
POWER: Final = (0.35, 24.0)  # W and W/N; power of the electronics, and power per thrust
INNER: Final = 0.15  # ohm; internal resistance of the battery


@final
@dataclass(frozen=True, slots=True)
class SampledMotion:
    """The motion at the times of samples."""

    # Position, velocity and acceleration of the hull centre in the map, shape (N, 3) [m], [m/s],
    # [m/s2]
    place: Array
    velocity: Array
    gain: Array
    turn: Rotation  # from body to map
    # Body rates and their derivatives, shape (N, 3) [rad/s], [rad/s2]
    rates: Array
    spin: Array


@final
class SensorSet:
    """All sensors on one flight."""

    def __init__(
        self, path: SimulatedTrajectory, truth: VehicleTruth, stamps: Stamps, draw: Draw
    ) -> None:
        self._path, self._truth, self._stamps, self._draw = path, truth, stamps, draw
        time, states, gains = path.time, path.states, path.gains
        w, (q, x, y, z) = states[:, 10:13], states[:, 6:10].T
        # Derivative of the quaternion, for the Hermite interpolation
        turning = 0.5 * np.column_stack([
            -(x * w[:, 0] + y * w[:, 1] + z * w[:, 2]),
            q * w[:, 0] + y * w[:, 2] - z * w[:, 1],
            q * w[:, 1] + z * w[:, 0] - x * w[:, 2],
            q * w[:, 2] + x * w[:, 1] - y * w[:, 0],
        ])  # fmt: skip
        slopes = np.hstack([states[:, 3:6], gains[:, :3], turning, gains[:, 3:]])
        self._states = CubicHermiteSpline(time, states, slopes)

    def _sample_times(self, rate: float, age: float = 0.0) -> Array:
        """Return the sample times of a sensor with a small rate error [s]."""
        # Relative rate error with a random sign
        off = self._draw.choice([-1.0, 1.0]) * self._draw.uniform(*CLOCK)
        period = (1.0 + off) / rate
        # The trajectory starts one tick before 0; stay within it despite the age of a pose
        first = 2.0 * TICK + age + self._draw.uniform(0.0, 1.0 / rate)
        return np.arange(first, self._path.time[-1], period)

    def _times_to_stamps(self, time: Array, *, pose: bool = False) -> Array:
        """Return the stamps of sample times."""
        if self._stamps == 'millisecond':
            return np.round(time / MILLISECOND) * MILLISECOND
        if self._stamps == 'grid' and pose:
            return np.round(time / POSE_GRID) * POSE_GRID
        if self._stamps == 'jitter':
            return time + JITTER * self._draw.standard_normal(len(time))
        return time

    def _white_noise(self, size: float, *shape: int) -> Array:
        return size * self._draw.standard_normal(shape)

    def _interpolate_motion(self, time: Array) -> SampledMotion:
        """Interpolate the motion at given times."""
        states = self._states(time)
        gains = np.column_stack([
            np.interp(time, self._path.time, each) for each in self._path.gains.T
        ])  # fmt: skip
        # w x y z to SciPy's x y z w
        turn = Rotation.from_quat(np.roll(states[:, 6:10], -1, axis=1))
        return SampledMotion(
            states[:, :3], states[:, 3:6], gains[:, :3], turn, states[:, 10:], gains[:, 3:]
        )

    def measure_poses(self) -> tuple[Array, Array]:
        """Return the tracker's poses: position and quaternion x y z w, in its own axes."""
        age = self._truth.tracker_delay
        time = self._sample_times(POSE_RATE, age)
        moments = self._interpolate_motion(time - age)
        to_map = Rotation.from_euler('ZYX', self._truth.tracker)
        marker = moments.place + moments.turn.apply(self._truth.marker_arm)
        place = to_map.apply(marker, inverse=True) + self._white_noise(PLACE_NOISE, len(time), 3)
        to_body = Rotation.from_euler('ZYX', self._truth.marker_turn)
        shaken = Rotation.from_rotvec(self._white_noise(ATTITUDE_NOISE, len(time), 3))
        turn = to_map.inv() * moments.turn * to_body * shaken
        return self._times_to_stamps(time, pose=True), np.hstack([place, turn.as_quat()])

    def measure_imu(self) -> tuple[Array, Array]:
        """Return body rates and specific force at the position of the IMU."""
        time, t = self._sample_times(IMU_RATE), self._truth
        moments = self._interpolate_motion(time)
        free = moments.gain + np.array([0.0, 0.0, GRAVITY])
        arm, rates = np.array(t.imu_place), moments.rates
        # Acceleration of the IMU relative to the hull centre: Euler and centripetal terms
        lever = np.cross(moments.spin, arm) + np.cross(rates, np.cross(rates, arm))
        force = moments.turn.apply(free, inverse=True) + lever
        rates = rates * (1.0 + np.array(t.gyro_scale)) + t.gyro_bias
        rates = rates + self._white_noise(GYRO_NOISE, len(time), 3)
        force = force + t.imu_bias + self._white_noise(FORCE_NOISE, len(time), 3)
        return self._times_to_stamps(time), np.hstack([rates, force])

    def measure_ranges(self) -> tuple[Array, Array]:
        """Return the distance to the floor along the body's downward axis."""
        time, t = self._sample_times(RANGE_RATE), self._truth
        moments = self._interpolate_motion(time)
        height = moments.place[:, 2] + moments.turn.apply(t.range_place)[:, 2]
        upright = moments.turn.apply([0.0, 0.0, 1.0])[:, 2]
        seen = height / upright + t.range_offset + self._white_noise(RANGE_NOISE, len(time))
        return self._times_to_stamps(time), seen[:, None]

    def measure_pressures(self) -> tuple[Array, Array]:
        """Return the air pressure at the flight controller."""
        time, t = self._sample_times(PRESSURE_RATE), self._truth
        moments = self._interpolate_motion(time)
        height = moments.place[:, 2] + moments.turn.apply(t.imu_place)[:, 2]
        # Weather: a random walk
        walk = np.cumsum(self._white_noise(PRESSURE_WALK / math.sqrt(PRESSURE_RATE), len(time)))
        seen = SEA_LEVEL * np.exp(-height / SCALE_HEIGHT) + t.pressure_offset + walk
        return self._times_to_stamps(time), (seen + self._white_noise(PRESSURE_NOISE, len(time)))[
            :, None
        ]

    def measure_voltages(self) -> tuple[Array, Array]:
        """Return the battery voltage, which falls with used charge and with load."""
        full, noise = self._draw.uniform(3.95, 4.15), VOLTAGE_NOISE
        power = POWER[0] + POWER[1] * self._path.thrusts.sum(axis=1)
        current = power / full
        used = np.cumsum(current) * TICK / CHARGE
        # 0.7 V from full to empty, linear in the used charge
        voltage = full - 0.7 * used - INNER * current
        time = self._sample_times(BATTERY_RATE)
        seen = np.interp(time, self._path.time, voltage) + self._white_noise(noise, len(time))
        return self._times_to_stamps(time), seen[:, None]

    def record_streams(self) -> dict[str, tuple[Array, Array]]:
        """Return all recorded topics, the commands included."""
        commands = self._path.commands
        return {
            'ground_truth/odom': self.measure_poses(),
            'imu': self.measure_imu(),
            'range': self.measure_ranges(),
            'pressure': self.measure_pressures(),
            'battery': self.measure_voltages(),
            'motors': (TICK * np.arange(len(commands), dtype=np.float64), commands),
        }
