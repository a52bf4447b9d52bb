"""Wild readings are left out, and lively ones stay."""

from dataclasses import replace

from lta_analysis.discovery.flights.outliers import wild, without_outliers
from lta_analysis.discovery.replay.linearise import Linearised
import numpy as np
import pytest

NOISE = 1e-3
TIME = 0.04 * np.arange(500)
RNG = np.random.default_rng(8)
SMOOTH = 0.5 * np.sin(2.0 * np.pi * 0.6 * TIME) + NOISE * RNG.standard_normal(len(TIME))


@pytest.mark.parametrize('where', [[100], [100, 101], [100, 101, 102], [40, 300, 302]])
def test_wild_readings_are_found_and_no_others(where: list[int]) -> None:
    values = SMOOTH.copy()
    values[where] += 0.2
    assert list(np.flatnonzero(wild(values, NOISE))) == where


def test_noise_gaps_and_missing_channels_have_none() -> None:
    assert not wild(SMOOTH, NOISE).any()
    holed = SMOOTH.copy()
    holed[50:60] = np.nan
    assert not wild(holed, NOISE).any()
    assert not wild(np.full(100, np.nan), np.inf).any()


def test_a_wild_pose_goes_as_a_whole_and_a_clean_flight_stays(clean: Linearised) -> None:
    flight = clean.replay.flight
    same, none = without_outliers(flight)
    assert none == 0
    assert same is flight
    position = flight.position.copy()
    position[333, 1] += 0.3
    mended, count = without_outliers(replace(flight, position=position))
    assert count == 1
    assert np.isnan(mended.position[333]).all()
    assert np.isnan(mended.quaternion[333]).all()
    rest = np.arange(len(position)) != 333
    np.testing.assert_array_equal(mended.position[rest], flight.position[rest])
    np.testing.assert_array_equal(mended.readings, flight.readings)
