"""
Simulate tracker and sensors of a flight, independently of `lta_sim`.

The IMU integrates over 10 ms: a rate is the rotation, a force the change of velocity, both
stamped in the middle. The tracker has its own clock, dropouts and outliers. Noise is partly
coloured, and readings are quantised.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from lta_challenge.truth_flight import TICK
from lta_challenge.truth_simulation import TruthTrajectory
from lta_challenge.truth_vehicle import TruthVehicle
from lta_config.schema.vehicle_file import VehicleFile
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
Draw = np.random.Generator
Streams = Mapping[str, tuple[Array, Array]]

GRAVITY: Final = 9.80665
GAS: Final = 287.05  # J/(kg K)
COLOURED: Final = 0.3  # amplitude of the coloured part of the noise, relative
REMEMBERED: Final = 0.2  # s; correlation time of the coloured part
WALK: Final = 0.02  # Pa/sqrt(s); random walk of the pressure
LOST: Final = 2.0  # dropouts of the tracker per minute
LONG: Final = 0.3  # s; mean length of a dropout
LONGEST: Final = 1.5  # s
MISTAKEN: Final = 0.0007  # share of outliers among the poses
AHEAD: Final = 1.0e-3  # s; standard deviation of the tracker's clock offset
FARTHEST: Final = 4.0  # m; limit of the range finder


@final
@dataclass(frozen=True, slots=True)
class Instruments:
    """Noise and resolution of the sensors."""

    # Standard deviation of the noise, and step of rounding [m, rad, rad/s, m/s2, m, Pa, V]
    place: tuple[float, float] = (1.0e-3, 1e-4)
    turn: tuple[float, float] = (2.5e-3, 0.0)
    rates: tuple[float, float] = (2.4e-3, 5e-4)
    force: tuple[float, float] = (0.02, 2e-3)
    range: tuple[float, float] = (5e-3, 1e-3)
    pressure: tuple[float, float] = (0.6, 0.02)
    voltage: tuple[float, float] = (5e-3, 1e-3)

    def scale_noise(self, factor: float) -> 'Instruments':
        """Return instruments with scaled noise."""
        worse = {
            name: (getattr(self, name)[0] * factor, getattr(self, name)[1])
            for name in self.__slots__
        }
        return Instruments(**worse)


def add_noise(values: Array, kind: tuple[float, float], apart: float, draw: Draw) -> Array:
    """Add partly coloured noise to values sampled at an interval [s], and round them."""
    size, step = kind
    white = draw.standard_normal(values.shape)
    # Coefficient of a first-order low-pass filter with unit output variance
    keep = np.exp(-apart / REMEMBERED)
    # Start in the stationary state, not at zero
    start = draw.standard_normal((1, *values.shape[1:])) * keep
    slow, _ = lfilter(
        [np.sqrt(1.0 - keep**2)], [1.0, -keep], draw.standard_normal(values.shape), 0, start
    )
    # The weights keep the total variance at size^2
    out = values + size * (np.sqrt(1.0 - COLOURED**2) * white + COLOURED * slow)
    rounded: Array = np.round(out / step) * step if step else out
    return rounded


@final
class TruthSensors:
    """
    The sensors on one flight.

    `hull`: the vehicle, with its measurement effects. `file`: positions of the sensors.
    `instruments`: noise and resolution.
    """

    def __init__(
        self,
        happened: TruthTrajectory,
        hull: TruthVehicle,
        file: VehicleFile,
        instruments: Instruments,
        draw: Draw,
    ) -> None:
        self._seen, self._hull, self._file = happened, hull, file
        self._kinds, self._draw = instruments, draw
        self._time: Array = TICK * np.arange(len(happened.position), dtype=np.float64)
        self._turns = Rotation.from_matrix(happened.rotation)
        # Rotation vector of each tick, in body axes
        self._steps = (self._turns[:-1].inv() * self._turns[1:]).as_rotvec()

    def measure_pose(self) -> tuple[Array, Array]:
        """Return positions and quaternions x y z w of the tracker, without dropouts."""
        time = self._time[1:-1]
        ahead = AHEAD * self._draw.standard_normal()
        # First the error of the tracker's clock, then its delay
        clock = self._hull.apply_measurement_effects('clock', (time + ahead,), time)
        (then,) = self._hull.apply_measurement_effects('pose_time', clock, time)
        place, turn = self._interpolate_pose(np.clip(then, 0.0, self._time[-1] - 1e-6))
        seen = self._hull.apply_measurement_effects('pose', (*place.T, *turn.as_quat().T), time)
        place = add_noise(np.column_stack(seen[:3]), self._kinds.place, TICK, self._draw)
        wobble = add_noise(np.zeros((len(time), 3)), self._kinds.turn, TICK, self._draw)
        turn = Rotation.from_quat(np.column_stack(seen[3:])) * Rotation.from_rotvec(wobble)
        mistaken = self._draw.random(len(time)) < MISTAKEN
        count = int(mistaken.sum())
        # Outliers: 0.3 m and 0.3 rad
        place[mistaken] += 0.3 * self._draw.standard_normal((count, 3))
        quaternion = turn.as_quat()
        if count:
            off = Rotation.from_rotvec(0.3 * self._draw.standard_normal((count, 3)))
            quaternion[mistaken] = (turn[mistaken] * off).as_quat()
        received = ~self._draw_dropouts(time)
        return time[received], np.column_stack([place, quaternion])[received]

    def _draw_dropouts(self, time: Array) -> NDArray[np.bool_]:
        """Draw the dropouts of the tracker."""
        lost = np.zeros(len(time), dtype=np.bool_)
        # Dropouts are a Poisson process
        for _ in range(self._draw.poisson(LOST * time[-1] / 60.0)):
            begin = self._draw.uniform(time[0], time[-1])
            long = min(self._draw.exponential(LONG), LONGEST)
            lost |= (time >= begin) & (time < begin + long)
        return lost

    def _interpolate_pose(self, time: Array) -> tuple[Array, Rotation]:
        """Interpolate position (cubic) and attitude (constant rate) between ticks."""
        k = np.minimum((time / TICK).astype(int), len(self._time) - 2)
        f = ((time - self._time[k]) / TICK)[:, None]
        speed = self._turns.apply(self._seen.velocity)
        a, b = self._seen.position[k], self._seen.position[k + 1]
        u, v = TICK * speed[k], TICK * speed[k + 1]
        # Cubic Hermite polynomial in the fraction f of a tick
        place = a + f * (u + f * (3.0 * (b - a) - 2.0 * u - v + f * (2.0 * (a - b) + u + v)))
        return place, self._turns[k] * Rotation.from_rotvec(f * self._steps[k])

    def measure_imu(self) -> tuple[Array, Array]:
        """Return body rates and specific force of the IMU."""
        middle = self._time[:-1] + 0.5 * TICK
        place = np.array(self._file.sensors.imu_position.vector)
        # Velocity of the IMU itself, away from the hull centre, in the map
        speed = self._turns.apply(self._seen.velocity + np.cross(self._seen.rates, place[None, :]))
        # Specific force: acceleration minus gravity, which points down
        felt = np.diff(speed, axis=0) / TICK + [0.0, 0.0, GRAVITY]
        # Attitude in the middle of the tick, at the stamp
        half = self._turns[:-1] * Rotation.from_rotvec(0.5 * self._steps)
        force = self._hull.apply_measurement_effects(
            'force', tuple(half.inv().apply(felt).T), middle
        )
        rates = self._hull.apply_measurement_effects(
            'rates', tuple((self._steps / TICK).T), middle
        )
        values = np.column_stack(
            [
                add_noise(np.column_stack(rates), self._kinds.rates, TICK, self._draw),
                add_noise(np.column_stack(force), self._kinds.force, TICK, self._draw),
            ]
        )
        return middle, values

    def _select_ticks(self, period: float) -> NDArray[np.int64]:
        """Return the ticks of a sensor with a given period [s]."""
        # Sensors do not start at the same tick
        first = int(self._draw.integers(0, 5))
        return np.round(np.arange(first, len(self._time), period / TICK)).astype(int)[:-1]

    def measure_range(self) -> tuple[Array, Array]:
        """Return the distance to the floor along the body's downward axis; inf for no echo."""
        k = self._select_ticks(0.025)
        place = np.array(self._file.sensors.range_position.vector)
        up = self._seen.rotation[k, 2]
        # Height of the sensor, divided by the cosine of the tilt
        far = (self._seen.position[k, 2] + up @ place) / up[:, 2]
        (far,) = self._hull.apply_measurement_effects('range', (far,), self._time[k])
        far = add_noise(far, self._kinds.range, 0.025, self._draw)
        return self._time[k], np.where(far < FARTHEST, far, np.inf)[:, None]

    def measure_pressure(self) -> tuple[Array, Array]:
        """Return the pressure at the IMU: isothermal air, weather and noise."""
        k = self._select_ticks(0.02)
        place = np.array(self._file.sensors.imu_position.vector)
        height = self._seen.position[k, 2] + self._seen.rotation[k, 2] @ place
        # Temperature [K] and sea-level pressure [Pa] of the day
        warm, floor = self._draw.normal(291.0, 3.0), self._draw.normal(101325.0, 600.0)
        value = floor * np.exp(-GRAVITY * height / (GAS * warm))
        value += WALK * np.sqrt(0.02) * np.cumsum(self._draw.standard_normal(len(k)))
        (value,) = self._hull.apply_measurement_effects('pressure', (value,), self._time[k])
        return self._time[k], add_noise(value, self._kinds.pressure, 0.02, self._draw)[:, None]

    def measure_voltage(self) -> tuple[Array, Array]:
        """Return the battery voltage."""
        k = self._select_ticks(0.1)
        volts = add_noise(self._seen.voltage[k], self._kinds.voltage, 0.1, self._draw)
        return self._time[k], volts[:, None]

    def record_streams(self) -> Streams:
        """Return times [s] and values of all sensors, by topic."""
        return {
            'ground_truth/odom': self.measure_pose(),
            'imu': self.measure_imu(),
            'range': self.measure_range(),
            'pressure': self.measure_pressure(),
            'battery': self.measure_voltage(),
        }
