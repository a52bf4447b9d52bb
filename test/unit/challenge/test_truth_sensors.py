"""What tracker and sensors of a challenge say, against the flight and against themselves."""

from lta_challenge.truth_sensors import add_noise, Instruments, TruthSensors
from lta_challenge.truth_simulation import simulate_flight, TruthTrajectory
from lta_challenge.truth_vehicle import build_truth_vehicle, TruthVehicle
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .test_truth import GTMAB, pilot

FILE = load_vehicle('gtmab').file
EXACT = Instruments().scale_noise(0.0)


@pytest.fixture(scope='module')
def flight() -> TruthTrajectory:
    """Twenty seconds."""
    return simulate_flight(build_truth_vehicle(GTMAB), pilot(2000), GTMAB, tilt=(0.1, -0.05, 0.0))


def watched(
    flight: TruthTrajectory, nominal: NominalVehicle, kinds: Instruments = EXACT
) -> TruthSensors:
    """Look at a flight of a vehicle."""
    hull: TruthVehicle = build_truth_vehicle(nominal)
    return TruthSensors(flight, hull, FILE, kinds, np.random.default_rng(3))


def test_turns_and_changes_of_velocity_add_up_to_the_flight(flight: TruthTrajectory) -> None:
    time, values = watched(flight, GTMAB).measure_imu()
    turn = Rotation.from_matrix(flight.rotation[0])
    place = np.array(FILE.sensors.imu_position.vector)
    speed = turn.apply(flight.velocity[0] + np.cross(flight.rates[0], place))
    for rates, force in zip(values[:, :3], values[:, 3:], strict=True):
        half = turn * Rotation.from_rotvec(0.005 * rates)
        speed = speed + 0.01 * (half.apply(force) - [0.0, 0.0, 9.80665])
        turn = turn * Rotation.from_rotvec(0.01 * rates)
    end = Rotation.from_matrix(flight.rotation[-1])
    assert time[0] == pytest.approx(0.005)
    # Readings are rounded to 0.5 mrad/s and 2 mm/s2: errors that mostly cancel.
    assert (end.inv() * turn).magnitude() < 5e-4
    true = end.apply(flight.velocity[-1] + np.cross(flight.rates[-1], place))
    assert np.abs(speed - true).max() < 0.01


def test_a_late_tracker_shows_where_the_vehicle_was(flight: TruthTrajectory) -> None:
    late = GTMAB.with_value('tracker_delay', 'delay', 0.05)
    (time, now), (_, before) = (watched(flight, each).measure_pose() for each in (GTMAB, late))
    inside = time > 0.1
    index = np.round(time[inside] / 0.01).astype(int)
    # The same mistakes and gaps; the clock is off by a millisecond and the step a tenth of one.
    sound = np.abs(now[inside, :3] - flight.position[index]).max(axis=1) < 0.01
    off = before[inside, :3] - flight.position[index - 5]
    assert sound.mean() > 0.99
    assert np.abs(off[sound]).max() < 0.004


def test_a_tracker_loses_and_mistakes_now_and_then(flight: TruthTrajectory) -> None:
    long = TruthTrajectory(*(np.concatenate([part] * 30) for part in _parts(flight)))
    time, poses = watched(long, GTMAB).measure_pose()
    step = np.abs(np.diff(poses[:, :3], axis=0)).max(axis=1)
    assert 0.9 < len(time) / len(long.position) < 0.999
    assert 10 < np.sum(step > 0.2) < 300


def _parts(flight: TruthTrajectory) -> list[np.ndarray]:  # type: ignore[type-arg]
    return [getattr(flight, name) for name in flight.__slots__]


def test_height_by_range_and_by_pressure_agree(flight: TruthTrajectory) -> None:
    seen = watched(flight, GTMAB)
    time, far = seen.measure_range()
    index = np.round(time / 0.01).astype(int)
    level = flight.rotation[index, 2, 2] > np.cos(0.02)
    depth = FILE.sensors.range_position.vector[2]
    assert far[level, 0] == pytest.approx(flight.position[index[level], 2] + depth, abs=2e-3)
    time, pressure = seen.measure_pressure()
    index = np.round(time / 0.01).astype(int)
    slope = np.polyfit(flight.position[index, 2], pressure[:, 0], 1)[0]
    assert slope == pytest.approx(-11.9, rel=0.1)  # Pa/m of air at 20 C, with a walk


def test_noise_has_its_size_and_a_little_memory() -> None:
    values = add_noise(np.zeros(200_000), (2.0, 0.5), 0.01, np.random.default_rng(0))
    assert np.std(values) == pytest.approx(np.hypot(2.0, 0.5 / np.sqrt(12.0)), rel=0.01)
    assert np.all(values % 0.5 == 0.0)
    neighbours = np.mean(values[1:] * values[:-1]) / np.mean(values**2)
    assert neighbours == pytest.approx(0.3**2 * np.exp(-0.01 / 0.2), abs=0.01)
