# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wild readings and what a tracker mistakes are left out, and lively ones stay."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import MeasuredFlight, Stream
from lta_discovery.flights.noise import find_tracker_outliers
from lta_discovery.flights.outliers import find_outliers, remove_outliers
from lta_discovery.state_filter.linear_flight import FlightSystem
import numpy as np
from numpy.typing import NDArray
import pytest

NOISE = 1e-3
TIME = 0.04 * np.arange(500)
RNG = np.random.default_rng(8)
SMOOTH = 0.5 * np.sin(2.0 * np.pi * 0.6 * TIME) + NOISE * RNG.standard_normal(len(TIME))


@pytest.mark.parametrize('where', [[100], [100, 101], [100, 101, 102], [40, 300, 302]])
def test_wild_readings_are_found_and_no_others(where: list[int]) -> None:
    values = SMOOTH.copy()
    values[where] += 0.2
    assert list(np.flatnonzero(find_outliers(values, NOISE))) == where


def test_noise_gaps_and_missing_channels_have_none() -> None:
    assert not find_outliers(SMOOTH, NOISE).any()
    holed = SMOOTH.copy()
    holed[50:60] = np.nan
    assert not find_outliers(holed, NOISE).any()
    assert not find_outliers(np.full(100, np.nan), np.inf).any()


def test_a_wild_pose_goes_as_a_whole_and_a_clean_flight_stays(clean: FlightSystem) -> None:
    flight = clean.flight
    same, none = remove_outliers(flight)
    assert none == 0
    assert same is flight
    position = flight.position.copy()
    position[333, 1] += 0.3
    mended, count = remove_outliers(replace(flight, position=position))
    assert count == 1
    assert np.isnan(mended.position[333]).all()
    assert np.isnan(mended.quaternion[333]).all()
    rest = np.arange(len(position)) != 333
    np.testing.assert_array_equal(mended.position[rest], flight.position[rest])
    np.testing.assert_array_equal(mended.readings, flight.readings)


def _still(quaternion: float) -> MeasuredFlight:
    """Return a flight at rest with one displaced quaternion and two readings 13 deviations off."""
    n = 100
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (n, 1))
    turn[50, 1] = quaternion
    readings = np.zeros((n, 8))
    readings[20, 0], readings[30, 7] = 13.0 * 0.01, 13.0 * 0.5
    noise = np.array([1e-3, 1e-3, 1e-3, 2e-3, 4e-3, 3e-3] + [0.01] * 7 + [0.5])
    time, nothing = 0.04 * np.arange(n), Stream(np.zeros(1), np.zeros((1, 4)))
    return MeasuredFlight(
        time, np.zeros((n, 3)), turn, readings, noise, np.ones(n, bool), nothing, time
    )


@pytest.mark.parametrize(('quaternion', 'wild_poses'), [(0.0235, 0), (0.0245, 1)])
def test_a_quaternion_is_wild_beyond_twelve_times_half_the_rotation_noise(
    quaternion: float, wild_poses: int
) -> None:
    """The largest rotation noise is 4 mrad, so the limit is 12 * 2e-3 = 0.024."""
    found, count = remove_outliers(_still(quaternion))
    assert count == 2 + wild_poses
    assert np.flatnonzero(np.isnan(found.quaternion).all(axis=1)).tolist() == [50] * wild_poses
    assert np.argwhere(np.isnan(found.readings)).tolist() == [[20, 0], [30, 7]]


@pytest.mark.parametrize(('length', 'found'), [(8, 8), (9, 9), (10, 0)])
def test_more_than_nine_readings_in_a_row_are_no_outliers(length: int, found: int) -> None:
    """
    The row alternates between 1 and -1, and all other readings are 0.

    It is off the cubic through its neighbours by 11 / 6 at least, the readings beside it by 5 / 6;
    the limit of twelve deviations is 0.9.
    """
    values = np.zeros(60)
    values[30 : 30 + length] = (-1.0) ** np.arange(length)
    assert find_outliers(values, 0.075).sum() == found


def test_a_reading_off_by_less_than_0_3_of_the_worst_beside_it_is_not_wild() -> None:
    values = np.zeros(60)
    values[30:33] = 1.0, 0.32, -0.28
    assert np.flatnonzero(find_outliers(values, 1e-3)).tolist() == [30, 31]


def test_a_cubic_however_steep_has_no_wild_readings() -> None:
    """A reading 0.02 off the cubic is wild if twelve deviations are 0.012, not if 0.0204."""
    time = np.arange(40.0)
    assert not find_outliers(time**3, 1e-6).any()
    values = time**3
    values[20] += 0.02
    assert np.flatnonzero(find_outliers(values, 1e-3)).tolist() == [20]
    assert np.flatnonzero(find_outliers(values, 1.7e-3)).tolist() == []


@pytest.mark.parametrize(('length', 'missing', 'found'), [(6, 0, []), (7, 0, [2]), (7, 1, [])])
def test_a_reading_is_wild_only_with_six_known_neighbours(
    length: int, missing: int, found: list[int]
) -> None:
    """Up to five on either side are used; missing readings do not count."""
    values = np.zeros(length)
    values[2] = 1.0
    values[length - missing :] = np.nan
    assert np.flatnonzero(find_outliers(values, 0.06)).tolist() == found


Array = NDArray[np.float64]


def swerving(rate: float) -> Array:
    """Return 20 s at 1 m/s in curves, turning at 1 rad/s, with a millimetre of noise."""
    time = np.arange(0.0, 20.0, 1.0 / rate)
    rng = np.random.default_rng(1)
    place = np.column_stack([np.sin(time), 1.0 - np.cos(time), 1.5 + 0.0 * time])
    turn = np.column_stack([0.0 * time, 0.0 * time, np.sin(0.5 * time), np.cos(0.5 * time)])
    return np.hstack([place, turn]) + 1e-3 * rng.standard_normal((len(time), 7))


def test_a_vehicle_that_swerves_is_no_mistake_at_any_rate() -> None:
    assert [
        find_tracker_outliers(swerving(rate)).sum() for rate in (20.0, 60.0, 100.0, 240.0)
    ] == [0] * 4


def test_what_jumps_there_and_back_is_told_and_nothing_else() -> None:
    poses = swerving(100.0)
    poses[300, 0] += 0.3
    poses[700:703, 2] -= 0.1
    poses[900, 3:] = [0.3, 0.0, 0.0, 0.95]
    poses[1200] = np.nan
    assert np.flatnonzero(find_tracker_outliers(poses)).tolist() == [300, 700, 701, 702, 900]


def test_a_gap_is_no_mistake() -> None:
    poses = np.delete(swerving(100.0), np.s_[500:620], axis=0)
    assert not find_tracker_outliers(poses).any()
