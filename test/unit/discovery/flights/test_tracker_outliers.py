"""Poses that a tracker mistook are told from those of a fast vehicle."""

from lta_discovery.flights.noise import find_tracker_outliers
import numpy as np
from numpy.typing import NDArray

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
