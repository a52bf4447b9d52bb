# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Convert log packets from the firmware's units and signs to SI units in the FLU body frame.

The firmware's accelerometer and gyroscope are FLU. Its `stateEstimate.pitch` is positive nose up,
so it changes sign for FLU (crazyflie-firmware, stabilizer_types.h: "pitch is inverted").
"""

from collections.abc import Mapping
import math
from typing import Final, NamedTuple

from lta_bridge.crazyflie.log_table import LOG_BLOCKS
from lta_config.constants import STANDARD_GRAVITY
from scipy.spatial.transform import Rotation

# SI values of the firmware's units
MILLIBAR: Final = 100.0  # Pa
MILLIMETRE: Final = 1e-3  # m
MOTOR_FULL_RATIO: Final = 65535.0
NO_RETURN: Final = 5.0  # m; the firmware treats a longer distance as an outlier (zranger2.c)

# Plausible ranges in the firmware's units: the sensors' limits with a margin for calibration
# (BMI088: 24 g, 2000 deg/s; BMP388: 300 to 1250 mbar; decks take up to 17 V).
PLAUSIBLE_RANGES: Final = {
    'acc': (-40.0, 40.0),
    'gyro': (-3000.0, 3000.0),
    'baro': (200.0, 1300.0),
    'stateEstimate': (-720.0, 720.0),  # deg
    'pm': (-1.0, 30.0),  # V, and the power state
}
BLOCK_VARIABLES: Final = {block.name: block.variables.keys() for block in LOG_BLOCKS}
Values = Mapping[str, float]


class ImuReading(NamedTuple):
    """Specific force [m/s2] and angular rate [rad/s], body FLU."""

    force: tuple[float, float, float]
    rates: tuple[float, float, float]


class AirReading(NamedTuple):
    """Pressure [Pa] and downward distance [m]; infinite without an echo."""

    pressure: float
    distance: float


class MotorsReading(NamedTuple):
    """Duties of M1 to M4, 0 to 1, and the supervisor's status word."""

    duties: tuple[float, ...]
    word: int


class PowerReading(NamedTuple):
    """Cell voltage [V] and the number of the firmware's power state."""

    voltage: float
    state: int


def find_value_fault(block: str, values: Values) -> str:
    """Return why the values of a log block cannot be used; empty if they can."""
    if values.keys() != BLOCK_VARIABLES.get(block, ()):
        return f'log block {block} does not have the expected variables'
    for name, value in values.items():
        least, most = PLAUSIBLE_RANGES.get(name.partition('.')[0], (-math.inf, math.inf))
        if not (math.isfinite(value) and least <= value <= most):
            return f'{name} is {value:g}, outside the range that a Crazyflie can measure'
    return ''


def convert_imu(values: Values) -> ImuReading:
    """Convert an IMU block: g to m/s2, deg/s to rad/s."""
    fx, fy, fz = (STANDARD_GRAVITY * values[f'acc.{axis}'] for axis in 'xyz')
    wx, wy, wz = (math.radians(values[f'gyro.{axis}']) for axis in 'xyz')
    return ImuReading((fx, fy, fz), (wx, wy, wz))


def convert_air(values: Values) -> AirReading:
    """Convert a block of pressure and range: mbar to Pa, mm to m."""
    distance = MILLIMETRE * values['range.zrange']
    return AirReading(
        MILLIBAR * values['baro.pressure'], math.inf if distance >= NO_RETURN else distance
    )


def convert_attitude(values: Values) -> tuple[float, float, float, float]:
    """Return the firmware's attitude as a quaternion x y z w, body FLU to the start frame."""
    roll, pitch, yaw = (values[f'stateEstimate.{angle}'] for angle in ('roll', 'pitch', 'yaw'))
    # The firmware's pitch has the opposite sign of FLU's
    x, y, z, w = Rotation.from_euler('ZYX', [yaw, -pitch, roll], degrees=True).as_quat().tolist()
    return x, y, z, w


def convert_motors(values: Values) -> MotorsReading:
    """Convert a motor block: ratios to duties."""
    duties = tuple(values[f'motor.m{number}'] / MOTOR_FULL_RATIO for number in range(1, 5))
    return MotorsReading(duties, int(values['supervisor.info']))


def convert_power(values: Values) -> PowerReading:
    """Convert a power block."""
    return PowerReading(values['pm.vbat'], int(values['pm.state']))
