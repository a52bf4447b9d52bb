"""
What log packets mean: the firmware's units and signs to ours (SI, FLU body).

The firmware's accelerometer and gyroscope are FLU; its `stateEstimate.pitch` counts nose up
positive, so it changes sign for FLU (crazyflie-firmware, stabilizer_types.h: "pitch is inverted").
"""

from collections.abc import Mapping
import math
from typing import Final, NamedTuple

from lta_bridge.crazyflie.log_table import BLOCKS
from lta_config.constants import STANDARD_GRAVITY
from scipy.spatial.transform import Rotation

MILLIBAR: Final = 100.0  # Pa
MILLIMETRE: Final = 1e-3  # m
FULL_RATIO: Final = 65535.0
NO_RETURN: Final = 5.0  # m: the firmware takes more for an outlier (zranger2.c)

# What a drone can measure at most, with room for its own calibration; what lies beyond was not
# measured (BMI088: 24 g, 2000 deg/s; BMP388: 300 to 1250 mbar; decks take up to 17 V).
REACH: Final = {
    'acc': (-40.0, 40.0),
    'gyro': (-3000.0, 3000.0),
    'baro': (200.0, 1300.0),
    'stateEstimate': (-720.0, 720.0),
    'pm': (-1.0, 30.0),
}
WHOLE: Final = {block.name: block.variables.keys() for block in BLOCKS}
Values = Mapping[str, float]


class ImuReading(NamedTuple):
    """Specific force [m/s2] and angular rate [rad/s], body FLU."""

    force: tuple[float, float, float]
    rates: tuple[float, float, float]


class AirReading(NamedTuple):
    """Pressure [Pa] and downward distance [m]; infinite where nothing returned."""

    pressure: float
    distance: float


class MotorsReading(NamedTuple):
    """Duty of M1 to M4, 0 to 1, and the supervisor's word."""

    duties: tuple[float, ...]
    word: int


class PowerReading(NamedTuple):
    """Cell voltage [V] and the firmware's power state by its number."""

    voltage: float
    state: int


def find_value_fault(block: str, values: Values) -> str:
    """Return why the values of a log block cannot be used; empty where they can."""
    if values.keys() != WHOLE.get(block, ()):
        return f'log block {block} has other values than it should'
    for name, value in values.items():
        least, most = REACH.get(name.partition('.')[0], (-math.inf, math.inf))
        if not (math.isfinite(value) and least <= value <= most):
            return f'{name} is {value:g}, which no Crazyflie measures'
    return ''


def convert_imu(values: Values) -> ImuReading:
    """Return an IMU block: g to m/s2, deg/s to rad/s."""
    fx, fy, fz = (STANDARD_GRAVITY * values[f'acc.{axis}'] for axis in 'xyz')
    wx, wy, wz = (math.radians(values[f'gyro.{axis}']) for axis in 'xyz')
    return ImuReading((fx, fy, fz), (wx, wy, wz))


def convert_air(values: Values) -> AirReading:
    """Return a block of pressure and range: mbar to Pa, mm to m."""
    distance = MILLIMETRE * values['range.zrange']
    return AirReading(
        MILLIBAR * values['baro.pressure'], math.inf if distance >= NO_RETURN else distance
    )


def convert_attitude(values: Values) -> tuple[float, float, float, float]:
    """Return the firmware's attitude as a quaternion x y z w, body FLU to its start frame."""
    roll, pitch, yaw = (values[f'stateEstimate.{angle}'] for angle in ('roll', 'pitch', 'yaw'))
    x, y, z, w = Rotation.from_euler('ZYX', [yaw, -pitch, roll], degrees=True).as_quat().tolist()
    return x, y, z, w


def convert_motors(values: Values) -> MotorsReading:
    """Return a motor block: ratios to duties."""
    duties = tuple(values[f'motor.m{number}'] / FULL_RATIO for number in range(1, 5))
    return MotorsReading(duties, int(values['supervisor.info']))


def convert_power(values: Values) -> PowerReading:
    """Return a power block."""
    return PowerReading(values['pm.vbat'], int(values['pm.state']))
