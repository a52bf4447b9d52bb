# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A recording on the grid: what is there, how noisy it is, and what is left out."""

from dataclasses import replace

from lta_config.errors import BadInput
from lta_data.bag.channels import read_flight
from lta_data.bag.recorded_flight import open_flight
from lta_discovery.flights.measured_flight import (
    FlightStreams,
    resample_flight,
    Stream,
    WARM_UP,
)
from lta_discovery.flights.noise import estimate_noise, estimate_pose_noise
from lta_discovery.flights.streams import build_streams
from lta_discovery.model.quaternions import quaternion_exponential
from lta_discovery.replay.replay import average_held_values
import numpy as np
import pytest

from ...report_flight import place, ROTORS, write_flight  # noqa: TID252 - `test` is Python's own

RNG = np.random.default_rng(3)
TIME = np.arange(0.0, 30.0, 0.01)
# A helix that turns with its way: body velocity (0.5, 0, 0.1) m/s and a rate of 0.4 rad/s.
SPEED, CLIMB, RATE = 0.5, 0.1, 0.4


def helix(noise: float = 0.0) -> FlightStreams:
    """Return a flight with a closed form, at 100 Hz."""
    turn = RATE * TIME
    position = np.column_stack(
        [SPEED / RATE * np.sin(turn), SPEED / RATE * (1.0 - np.cos(turn)), 1.0 + CLIMB * TIME]
    )
    quaternion = quaternion_exponential(np.column_stack([0.0 * turn, 0.0 * turn, turn]))
    position += noise * RNG.standard_normal(position.shape)
    pose = Stream(TIME, np.column_stack([position, quaternion]))
    return FlightStreams(pose, Stream(TIME, np.zeros((len(TIME), 4))))


def test_noise_is_that_which_was_added_whatever_the_motion() -> None:
    smooth = np.sin(0.7 * TIME)
    noisy = smooth + 0.003 * RNG.standard_normal(len(TIME))
    assert estimate_noise(noisy) == pytest.approx(0.003, rel=0.06)
    noisy[::50] += 1.0  # outliers
    noisy[100:110] = np.inf
    assert estimate_noise(noisy) == pytest.approx(0.003, rel=0.2)
    assert estimate_noise(np.full(100, np.nan)) == np.inf


def test_a_gap_is_not_filled_and_the_floor_and_the_warm_up_do_not_count() -> None:
    told = helix()
    keep = (TIME < 10.0) | (TIME > 10.6)
    pose = Stream(TIME[keep], told.pose.values[keep])
    found = resample_flight(FlightStreams(pose, told.commands, floor=1.5))
    hole = (found.time > 10.05) & (found.time < 10.55)
    assert hole.any()
    assert np.isnan(found.position[hole]).all()
    assert not found.usable[hole].any()
    assert not found.usable[found.time - found.time[0] < WARM_UP - 1e-9].any()
    assert found.usable[(found.time > 5.1) & ~((found.time > 9.9) & (found.time < 10.7))].all()
    assert not found.usable[found.time < 4.99].any()  # below 1.5 m
    assert np.isinf(found.noise[6:]).all()  # no other sensors


def test_a_bag_gives_poses_and_commands(tmp_path) -> None:
    flight = open_flight(write_flight(tmp_path / 'bag'))
    told = build_streams(read_flight(flight).channels, list(ROTORS))
    x, z, _ = place(20.0)
    k = int(np.argmin(np.abs(told.pose.time - 20.0)))
    np.testing.assert_allclose(told.pose.values[k], [x, 0.0, z, 0.0, 0.0, 0.0, 1.0], atol=0.01)
    assert told.commands.values.shape[1] == len(ROTORS)
    assert set(told.commands.values[-1]) <= {0.0, 0.3, 0.5}
    assert 'voltage' in told.others


def test_without_a_tracker_or_a_rotor_it_says_what_is_missing(tmp_path) -> None:
    flight = open_flight(write_flight(tmp_path / 'bag'))
    channels = read_flight(flight).channels
    with pytest.raises(BadInput, match='no commands for tail'):
        build_streams(channels, ['tail'])
    blind = {name: c for name, c in channels.items() if not name.startswith('ground_truth')}
    with pytest.raises(BadInput, match='no measured pose'):
        build_streams(blind, list(ROTORS))


def test_a_held_value_counts_from_when_it_came() -> None:
    told = Stream(np.array([0.5, 1.25, 1.5]), np.array([[1.0], [3.0], [-2.0]]))
    means = average_held_values(told, np.array([0.0, 1.0, 2.0, 3.0]))
    # 0.5 s of 1; 0.25 s of 1, 0.25 s of 3, 0.5 s of -2; all -2.
    np.testing.assert_allclose(means[:, 0], [0.5, 0.0, -2.0], atol=1e-12)


def _shaking(amplitudes: list[float], count: int = 40) -> np.ndarray:
    """Return series alternating between +- an amplitude; third differences are 8 times that."""
    return np.outer((-1.0) ** np.arange(count), amplitudes)


# The noise that is found in a series alternating between -1 and 1: the median size of white noise
# is 0.6745 deviations, and a third difference has 1 + 9 + 9 + 1 times the variance of a reading.
UNIT = 8.0 / 0.6745 / 20.0**0.5


@pytest.mark.parametrize(('count', 'known'), [(10, False), (11, True), (40, True)])
def test_noise_needs_at_least_eight_third_differences(count: int, known: bool) -> None:
    found = estimate_noise(_shaking([0.5], count)[:, 0])
    assert found == (pytest.approx(0.5 * UNIT) if known else np.inf)


def test_rotation_noise_is_twice_that_of_a_free_quaternion_component() -> None:
    """The four components share the noise of three free ones, each of which is half an angle."""
    levels = estimate_pose_noise(_shaking([0.01, 0.02, 0.03, 1e-3, 2e-3, 3e-3, 4e-3]))
    turn = 2.0 * np.sqrt((1.0 + 4.0 + 9.0 + 16.0) / 3.0) * 1e-3
    np.testing.assert_allclose(levels, UNIT * np.array([0.01, 0.02, 0.03, turn, turn, turn]))


def test_readings_that_never_change_get_the_least_noise_of_their_sensor() -> None:
    """That is 0.3 mrad/s, 3 mm/s2, 1 mm and 0.3 Pa."""
    told = helix()
    others = {'rates': np.zeros((len(TIME), 3)), 'force': np.zeros((len(TIME), 3)),
              'range': np.zeros((len(TIME), 1)), 'pressure': np.zeros((len(TIME), 1))}  # fmt: skip
    streams = {name: Stream(TIME, values) for name, values in others.items()}
    found = resample_flight(replace(told, others=streams))
    assert found.noise[6:].tolist() == [3e-4] * 3 + [3e-3] * 3 + [1e-3, 0.3]
