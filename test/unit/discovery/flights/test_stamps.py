# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Stamps that are rounded or jitter: what is behind them, and what is left alone."""

from dataclasses import replace

from hypothesis import example, given, settings, strategies
from lta_discovery.flights.measured_flight import FlightStreams, resample_flight, Stream
from lta_discovery.flights.regular_times import find_stamp_step, fit_regular_times
from lta_discovery.flights.timestamp_repair import (
    add_stamp_noise,
    estimate_stamp_share,
    repair_timestamps,
)
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

SECONDS = 60.0
NOISE = 1e-3  # m
MS = 1e-3  # s


def flown(true: Array, stamps: Array, seed: int = 1) -> FlightStreams:
    """Return a flight in curves at about half a metre a second, seen at true instants."""
    rng = np.random.default_rng(seed)
    place = np.column_stack([np.sin(0.5 * true), 0.5 * np.cos(0.7 * true), 1.5 + 0.0 * true])
    place += NOISE * rng.standard_normal(place.shape)
    poses = np.hstack([place, np.tile([0.0, 0.0, 0.0, 1.0], (len(true), 1))])
    return FlightStreams(Stream(stamps, poses), Stream(np.zeros(1), np.zeros((1, 4))))


def every(rate: float) -> Array:
    """Return instants of a rate that begin anywhere."""
    return np.arange(0.0037, SECONDS, 1.0 / rate)


def rounded(time: Array, step: float) -> Array:
    """Return stamps on steps."""
    return step * np.round(time / step)


def wrong(found: Array, true: Array) -> float:
    """Return how far stamps are off at most, a constant delay aside [s]."""
    return float(np.abs(found - true - np.mean(found - true)).max())


@pytest.mark.parametrize('step', [0.01, 0.002, 0.001, 1e-4])
def test_the_step_is_the_largest_on_which_all_stamps_sit(step: float) -> None:
    time = rounded(np.cumsum(np.random.default_rng(2).uniform(0.005, 0.02, 2000)), step)
    assert find_stamp_step(0.123456 + time) == step
    assert find_stamp_step(np.cumsum(np.random.default_rng(2).uniform(0.005, 0.02, 2000))) == 0.0


@pytest.mark.parametrize(
    ('rate', 'step'),
    [(30.0, MS), (100.0, MS), (120.0, MS), (240.0, MS), (30.0, 2 * MS), (60.0, 2 * MS),
     (120.0, 2 * MS), (240.0, 2 * MS)],
)  # fmt: skip
@pytest.mark.parametrize('drift', [0.0, 5e-5])
def test_a_raster_is_recovered_from_rounded_stamps(rate: float, step: float, drift: float) -> None:
    true = (1.0 + drift) * every(rate)
    stamps = rounded(true, step)
    assert wrong(fit_regular_times(stamps, step), true) < 0.05 * MS


def test_rounding_that_meets_every_phase_leaves_a_step_by_the_root_of_twelve() -> None:
    stamps = rounded(1.00007 * every(120.0), 0.002)
    off = stamps - fit_regular_times(stamps, 0.002)
    assert np.std(off) == pytest.approx(0.002 / np.sqrt(12.0), rel=0.02)


def test_lost_poses_and_a_silence_do_not_shift_the_raster() -> None:
    true = every(120.0)
    keep = np.random.default_rng(3).random(len(true)) > 0.2
    keep[2000:2600] = False
    stamps = rounded(true[keep], MS)
    assert wrong(fit_regular_times(stamps, MS), true[keep]) < 0.05 * MS


def test_a_clock_whose_rate_wanders_is_followed() -> None:
    true = every(120.0)
    true = true + 2.0 * MS * np.sin(2.0 * np.pi * true / 120.0)
    assert wrong(fit_regular_times(rounded(true, MS), MS), true) < 0.25 * MS


def test_rounded_stamps_are_mended_and_said() -> None:
    true = every(120.0)
    told, deviation, words = repair_timestamps('A', flown(true, rounded(true, 2.0 * MS)))
    assert wrong(told.pose.time, true) < 0.05 * MS
    assert deviation == 0.0
    assert words == [
        "A: the tracker's timestamps are rounded to 2 ms; they were replaced by regular times at "
        '120.0 Hz, from which they deviate by 0.57 ms rms.'
    ]


def test_the_poses_tell_whether_stamps_jitter_or_they_do() -> None:
    shaken = every(100.0) + 0.3 * MS * np.random.default_rng(4).standard_normal(len(every(100.0)))
    told, _, words = repair_timestamps('A', flown(every(100.0), shaken))
    assert wrong(told.pose.time, every(100.0)) < 0.05 * MS
    assert words[0].startswith("A: the tracker's timestamps jitter, but its sampling is regular;")
    true = flown(shaken, shaken)
    assert repair_timestamps('A', true) == (true, 0.0, [])
    hovering = flown(np.zeros(len(shaken)), shaken)
    assert repair_timestamps('A', hovering) == (
        hovering,
        0.0,
        [],
    )  # nothing tells, and nothing is wrong


def test_the_share_of_stamps_in_what_poses_follow_is_unbiased_and_its_error_honest() -> None:
    off = 0.3 * MS * np.random.default_rng(6).standard_normal(len(every(100.0)))
    scores = []
    for seed in range(30):
        for share in (0.0, 0.5, 1.0):
            told = flown(every(100.0) + share * off, every(100.0), seed)
            found, error = estimate_stamp_share(told.pose.values[:, :3], every(100.0), off)
            scores.append((found - share) / error)
    assert np.mean(scores) == pytest.approx(0.0, abs=0.4)
    assert np.std(scores) == pytest.approx(1.0, abs=0.35)


def test_poses_of_a_simulator_that_are_taken_on_its_steps_have_true_stamps() -> None:
    steps = rounded(every(120.0), 2.0 * MS)
    told = flown(steps, steps)
    assert repair_timestamps('A', told) == (told, 0.0, [])


def test_an_imu_is_put_on_its_raster_by_its_own_readings_and_commands_stay() -> None:
    true = every(100.0)
    # 5, 15, 25 ms rounded to the even step of 2 ms: 4, 16, 24 ms, which sit on 4 ms too.
    stamps = 0.005 + 0.01 * np.arange(len(true)) + MS * np.resize([-1.0, 1.0], len(true))
    told = flown(true, true)
    rates = np.column_stack([np.sin(2.0 * true), np.cos(3.0 * true), 0.0 * true])
    others = {'rates': Stream(stamps, rates), 'force': Stream(stamps, 9.8 + rates)}
    given_out = Stream(stamps, np.zeros((len(stamps), 4)))
    found, _, words = repair_timestamps('A', replace(told, commands=given_out, others=others))
    assert wrong(found.others['rates'].time, true) < 0.05 * MS
    np.testing.assert_array_equal(found.others['force'].time, found.others['rates'].time)
    assert found.commands is given_out
    assert found.pose is told.pose
    assert words == [
        "A: the IMU's timestamps are rounded to 4 ms; they were replaced by regular times at "
        '100.0 Hz, from which they deviate by 1.00 ms rms.'
    ]


@settings(max_examples=30, deadline=None)
@given(strategies.integers(0, 10_000), strategies.floats(0.15, 1.0))
def test_irregular_poses_with_fine_stamps_are_left_alone(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    true = np.cumsum(0.01 * (1.0 - spread) + rng.exponential(0.01 * spread, 3000))
    told = flown(true, true, seed)
    assert repair_timestamps('A', told) == (told, 0.0, [])


@settings(max_examples=30, deadline=None)
@given(
    strategies.sampled_from([10.0, 25.0, 30.0, 50.0, 60.0, 100.0, 120.0, 200.0]),
    strategies.floats(0.0, 0.5),
    strategies.integers(0, 10_000),
)
@example(10.0, 0.5, 0)  # gaps of whole periods, which look like a resolution of 10 ms
def test_exact_stamps_are_left_alone(rate: float, lost: float, seed: int) -> None:
    time = every(rate)
    time = time[np.random.default_rng(seed).random(len(time)) >= lost]
    found, deviation, words = repair_timestamps('A', flown(time, time, seed))
    assert np.abs(found.pose.time - time).max() < 1e-6
    assert (deviation, words) == (0.0, [])


@pytest.mark.parametrize('time', [[], [0.0], [0.0, 0.01], [0.0] * 80, [0.0, 0.01] * 40])
def test_too_few_stamps_or_the_same_ones_are_left_alone(time: list[float]) -> None:
    told = flown(np.array(time), np.array(time))
    assert repair_timestamps('A', told)[::2] == (told, [])


def test_what_moves_within_a_step_is_noise_where_there_is_no_raster() -> None:
    true = np.cumsum(0.004 + np.random.default_rng(7).exponential(0.006, 6000))
    told = flown(true, rounded(true, 0.002))
    place = told.pose.values[:, :3]
    place[:] = [0.0, 0.0, 1.0]
    place[:, 0] += 3.0 * true  # 3 m/s
    same, deviation, words = repair_timestamps('A', told)
    assert same == told
    assert words == []
    assert deviation == pytest.approx(0.002 / np.sqrt(12.0))
    flight = replace(resample_flight(told), noise=np.full(14, 1e-3))
    more, said = add_stamp_noise('A', flight, deviation)
    assert more.noise[0] == pytest.approx(np.hypot(1e-3, 3.0 * deviation), rel=0.02)
    np.testing.assert_allclose(more.noise[1:], 1e-3)
    assert '0.58 ms rms is included in the noise of the poses' in said[0]
    assert add_stamp_noise('A', flight, 0.0) == (flight, [])
