# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Clocks: offsets, drifts and starts that are known, found within their own uncertainty."""

from lta_data.compare.clock_offset import estimate_clock_offset
from lta_data.compare.coarse_lag import estimate_start_offset, find_motion_start, SharedQuantity
from lta_data.even_grid import SampledSignal, sort_samples
import numpy as np
import pytest

from .compare_flight import motion


def shared(a_time, b_time, offset, drift=0.0, noise=0.02, seed=0, columns=(2, 3)):
    """Return what two recorders made of the motion, B's clock being ahead."""
    chance = np.random.default_rng(seed)
    at_b = (b_time - offset) / (1.0 + drift)
    found = []
    for column in columns:
        a = motion(a_time)[:, column] + noise * chance.normal(size=len(a_time))
        b = motion(at_b)[:, column] + noise * chance.normal(size=len(b_time))
        found.append(
            SharedQuantity(f'odom/{column}', SampledSignal(a_time, a), SampledSignal(b_time, b))
        )
    return found


@pytest.mark.parametrize('offset', [0.1234, -3.21, 0.0, 7.5])
def test_an_offset_is_found_within_its_uncertainty(offset):
    found = estimate_clock_offset(shared(np.arange(0, 40, 0.01), np.arange(0, 40, 1 / 60), offset))
    assert abs(found.value - offset) < 4 * found.sigma
    assert found.sigma < 0.005
    assert found.correlation > 0.9
    assert not found.drifts
    assert set(found.used) == {'odom/2', 'odom/3'}


def test_the_uncertainty_is_that_of_the_errors_that_are_made():
    times = np.arange(0, 40, 0.02), np.arange(0.007, 40, 0.05)
    found = [estimate_clock_offset(shared(*times, 0.1234, seed=seed)) for seed in range(25)]
    errors = np.array([each.value - 0.1234 for each in found])
    claimed = np.array([each.sigma for each in found])
    # 25 draws tell a standard deviation to 14 %; three of those either way.
    assert 0.58 < np.std(errors) / np.median(claimed) < 1.42
    assert abs(errors.mean()) < 3 * np.std(errors) / np.sqrt(25)
    assert (np.abs(errors) < 1.96 * claimed).mean() >= 0.85


def test_a_drift_is_found_and_one_that_is_not_there_is_not():
    times = np.arange(0, 300, 0.02), np.arange(0, 301, 0.02)
    found = estimate_clock_offset(shared(*times, 0.5, drift=200e-6))
    assert found.drifts
    assert abs(found.drift - 200e-6) < 4 * found.drift_sigma
    assert found.drift_sigma < 20e-6
    assert found.value == pytest.approx(0.5 + 200e-6 * found.middle, abs=4 * found.sigma)
    steady = estimate_clock_offset(shared(*times, 0.5))
    assert not steady.drifts
    assert abs(steady.drift) < 4 * steady.drift_sigma


def test_a_short_span_says_nothing_of_drift():
    times = np.arange(0, 20, 0.02), np.arange(0, 20, 0.02)
    found = estimate_clock_offset(shared(*times, 0.1))
    assert (found.drift, found.drift_sigma) == (0.0, np.inf)


def test_outliers_and_a_slow_bias_do_not_move_the_offset():
    pairs = shared(np.arange(0, 60, 0.02), np.arange(0, 60, 0.02), 0.1234, noise=0.01)
    chance = np.random.default_rng(5)
    spoilt = []
    for name, a, b, angular in pairs:
        values = b.values + 0.3 * np.sin(2 * np.pi * b.time / 400.0)
        values[chance.integers(0, len(values), 30)] += 2.0
        spoilt.append(SharedQuantity(name, a, SampledSignal(b.time, values), angular))
    found = estimate_clock_offset(spoilt)
    assert abs(found.value - 0.1234) < 4 * found.sigma < 0.05


def test_steps_without_noise_do_not_throw_the_fine_step_off():
    """Most misfits of such signals are zero, so that all that tells the offset is an outlier."""
    a_time, b_time = np.arange(0, 40, 0.02), np.arange(0.003, 40, 0.05)

    def step(t, column):
        return np.tanh(3.0 * (t - 15.0 - column)) + np.tanh(2.0 * (t - 28.0 - column))

    pairs = [
        SharedQuantity(
            f'odom/{column}',
            SampledSignal(a_time, step(a_time, column)),
            SampledSignal(b_time + 0.123, step(b_time, column)),
        )
        for column in (1, 2, 3)
    ]
    found = estimate_clock_offset(pairs)
    assert found.value == pytest.approx(0.123, abs=1e-3)
    assert found.sigma < 1e-2


def test_motion_that_repeats_itself_is_called_ambiguous():
    t = np.arange(0, 40, 0.02)
    lines = [SampledSignal(t, np.sin(2 * np.pi * (t - lag) / 4.0)) for lag in (0.0, 0.3)]
    assert estimate_clock_offset([SharedQuantity('odom/z', *lines)]).is_ambiguous
    assert not estimate_clock_offset(shared(t, t, 0.3)).is_ambiguous


def test_nothing_that_moves_ties_no_clocks():
    t = np.arange(0, 20, 0.02)
    chance = np.random.default_rng(0)
    noisy = [SampledSignal(t, chance.normal(size=len(t))) for _ in range(2)]
    assert estimate_clock_offset([SharedQuantity('imu/x', *noisy)]) is None
    assert (
        estimate_clock_offset(
            [SharedQuantity('imu/x', SampledSignal(t, 0 * t), SampledSignal(t, 0 * t))]
        )
        is None
    )
    assert estimate_clock_offset([]) is None


def test_a_start_is_the_first_lasting_departure_from_the_first_level():
    t = np.arange(0, 20, 0.01)
    chance = np.random.default_rng(0)
    rest = 0.01 * chance.normal(size=len(t))
    rest[300] += 5.0  # an outlier is no start
    ramp = np.maximum(t - 6.0, 0.0)
    assert find_motion_start(SampledSignal(t, rest + ramp)) == pytest.approx(6.0, abs=0.3)
    duty = np.where(t >= 4.0, 0.4, 0.0)
    assert find_motion_start(SampledSignal(t, duty)) == pytest.approx(4.0, abs=1e-9)
    assert find_motion_start(SampledSignal(t, t)) is None
    assert find_motion_start(SampledSignal(t, 0 * t)) is None


def test_commands_go_before_motion_and_tell_the_offset_of_two_runs():
    t = np.arange(0, 20, 0.01)
    duty = [SampledSignal(t, np.where(t >= start, 0.4, 0.0)) for start in (4.0, 5.5)]
    climb = [SampledSignal(t, np.maximum(t - start, 0.0)) for start in (4.2, 6.9)]
    found = estimate_start_offset(
        [SharedQuantity('odom/z', *climb), SharedQuantity('motors/effort.left', *duty)]
    )
    assert found.offset == pytest.approx(1.5, abs=1e-9)
    assert found.used == ('motors/effort.left',)
    assert found.by_command
    assert found.sigma == pytest.approx(0.01 * np.sqrt(2) / np.sqrt(12), rel=0.01)
    # The scatter of several channels tells how well the motion tells its start; one has none.
    assert estimate_start_offset([SharedQuantity('odom/z', *climb)]) is None
    without = estimate_start_offset([SharedQuantity(f'odom/{name}', *climb) for name in 'xyz'])
    assert without.offset == pytest.approx(2.7, abs=0.05)
    assert not without.by_command


def test_late_messages_are_put_in_order_and_a_clock_that_was_set_back_is_left_out():
    time = np.arange(100.0)
    late = time.copy()
    late[[40, 41]] = late[[41, 40]]
    late[[10, 60]] = 9.0, np.nan
    line = sort_samples(late, 10.0 * late)
    # Of two samples at one time, the first
    np.testing.assert_array_equal(line.time, np.delete(time, [10, 60]))
    np.testing.assert_array_equal(line.values, 10.0 * line.time)
    back = np.concatenate([time[:50], time[:50] - 20.0 + 50.0])
    line = sort_samples(back, np.arange(100.0))
    np.testing.assert_array_equal(line.values, [*range(50), *range(70, 100)])


def test_what_is_unknown_or_absurd_is_not_a_number():
    line = sort_samples([0.0, 1.0, 2.0, 3.0], [[1.0, 2.0], [np.inf, 2.0], [1e31, 0.0], [5.0, 6.0]])
    np.testing.assert_array_equal(line.values[:, 0], [1.0, np.nan, np.nan, 5.0])
    np.testing.assert_array_equal(line.select_complete().time, [0.0, 3.0])
