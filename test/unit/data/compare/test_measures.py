# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Differences: bias, RMS, intervals and partings against hand values and scipy."""

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_data.compare.channel_comparison import ChannelPair, compare_channels
from lta_data.compare.divergence import (
    find_divergence,
    measure_difference,
    noise_band,
    noise_deviation,
    rms_interval,
)
from lta_data.compare.frame_alignment import fit_frame_transform
from lta_data.compare.sampling import (
    align_signals,
    break_at_gaps,
    interpolate_signal,
    wrap_angle,
)
from lta_data.even_grid import SampledSignal
from lta_data.flight import Channel
import numpy as np
import pytest
from scipy import signal

T = np.arange(0.0, 20.0, 0.01)
CHANCE = np.random.default_rng(0)


def pair_of(a, b, time=T, angular=False):
    return align_signals(SampledSignal(time, a), SampledSignal(time, b), angular=angular)


def test_the_faster_is_interpolated_at_the_instants_of_the_slower():
    fast = SampledSignal(np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 10.0, 20.0, 30.0]))
    slow = SampledSignal(np.array([0.5, 2.25]), np.array([1.0, 1.0]))
    found = align_signals(fast, slow)
    np.testing.assert_allclose(found.time, [0.5, 2.25])
    np.testing.assert_allclose(found.difference, [1.0 - 5.0, 1.0 - 22.5])
    swapped = align_signals(slow, fast)
    np.testing.assert_allclose(swapped.time, [0.5, 2.25])
    np.testing.assert_allclose(swapped.difference, [4.0, 21.5])


def test_nothing_is_known_in_a_gap_or_beside_a_value_that_is_no_number():
    time = np.array([0.0, 1.0, 2.0, 8.0, 9.0, 10.0, 11.0])
    line = SampledSignal(time, np.array([0.0, 1.0, 2.0, 8.0, np.nan, 10.0, 11.0]))
    at = np.array([1.5, 2.0, 5.0, 8.0, 8.5, 9.5, 10.5, 11.5])
    expected = [1.5, 2.0, np.nan, 8.0, np.nan, np.nan, 10.5, np.nan]
    np.testing.assert_array_equal(interpolate_signal(line, at), expected)
    cut = break_at_gaps(line)
    np.testing.assert_allclose(cut.time[3], 5.0)
    assert np.isnan(cut.values[3])


def test_angles_go_the_shorter_way_around():
    a = SampledSignal(np.array([0.0, 1.0, 2.0]), np.array([3.1, -3.1, -3.0]))
    b = SampledSignal(np.array([0.5, 1.75]), np.array([-3.1, 3.1]))
    found = align_signals(a, b, angular=True)
    expected = [np.pi - 3.1, 3.1 + 3.025 - 2 * np.pi]
    np.testing.assert_allclose(found.difference, expected, atol=1e-12)


def test_bias_rms_and_nrmse_by_hand():
    a = np.array([1.0, -1.0, 1.0, -1.0])  # standard deviation 1
    found = measure_difference(pair_of(a, np.array([2.0, 0.0, 4.0, -2.0]), np.arange(4.0)))
    assert found.bias == 1.0
    assert found.rms == pytest.approx(np.sqrt(3.0))
    assert (found.greatest, found.greatest_at) == (3.0, 2.0)
    assert found.spread == 1.0
    assert found.nrmse == pytest.approx(np.sqrt(3.0))
    assert measure_difference(pair_of(0 * a, a, np.arange(4.0))).nrmse is None


@pytest.mark.parametrize('pole', [0.0, 0.9])
def test_the_interval_of_the_rms_covers_the_truth_as_often_as_it_says(pole):
    chance = np.random.default_rng(7)
    truth = 1.0 / np.sqrt(1.0 - pole**2)
    hits = 0
    for _ in range(150):
        series = signal.lfilter([1.0], [1.0, -pole], chance.normal(size=2200))[200:]
        low, high = rms_interval(series)
        hits += low <= truth <= high
    assert 0.87 <= hits / 150 <= 0.99


def test_noise_is_that_on_a_smooth_signal_and_outliers_do_not_count():
    values = np.sin(T) + 0.05 * CHANCE.normal(size=len(T))
    values[::100] += 10.0
    assert noise_deviation(values) == pytest.approx(0.05, rel=0.1)
    assert noise_deviation(np.sin(T)) < 1e-4
    assert noise_deviation(3.0 * np.rint(2.0 * T) / 2.0) == pytest.approx(1.5 / np.sqrt(12.0))
    assert noise_deviation(np.zeros(10)) == 0.0
    assert noise_deviation(np.where(T > 5.0, 0.4, 0.0)) == 0.0  # a command


def test_a_step_is_found_where_it_begins():
    a = np.sin(T) + 0.01 * CHANCE.normal(size=len(T))
    b = np.sin(T) + 0.01 * CHANCE.normal(size=len(T)) + np.where(T >= 7.0, 0.2, 0.0)
    both = pair_of(a, b)
    band = noise_band(both)
    assert band == pytest.approx(4 * np.hypot(0.01, 0.01), rel=0.1)
    found = find_divergence(both, band)
    assert found.at == pytest.approx(7.0, abs=0.011)
    assert found.outside == pytest.approx(0.65, abs=0.01)


def test_what_meets_again_has_not_parted_and_what_swings_has():
    once = pair_of(0 * T, np.where((T > 3.0) & (T < 6.0), 1.0, 0.0))
    found = find_divergence(once, 0.1)
    assert found.at is None
    assert found.first == pytest.approx(3.01, abs=0.011)
    swing = find_divergence(pair_of(0 * T, np.where(T > 5.0, np.sin(10.0 * T), 0.0)), 0.1)
    assert swing.at == pytest.approx(5.0, abs=0.1)
    assert find_divergence(pair_of(T, T), 0.0).first is None


def test_a_turn_and_a_shift_are_found_in_spite_of_a_stretch_that_parts():
    chance = np.random.default_rng(1)
    b = np.cumsum(chance.normal(size=(500, 3)), axis=0) * 0.1
    c, s = np.cos(0.7), np.sin(0.7)
    a = b @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + [3.0, -2.0, 0.5]
    a += 0.005 * chance.normal(size=a.shape)
    a[400:, 0] += 4.0
    found = fit_frame_transform(a, b)
    assert found.yaw == pytest.approx(0.7, abs=0.002)
    assert (found.x, found.y, found.z) == pytest.approx((3.0, -2.0, 0.5), abs=0.01)
    assert not found.by_heading
    np.testing.assert_allclose(found.transform_positions(b)[:400], a[:400], atol=0.05)


def test_of_a_hover_the_headings_tell_the_turn():
    chance = np.random.default_rng(1)
    a, b = 0.01 * chance.normal(size=(2, 300, 3))
    heading = chance.uniform(-3.0, 3.0, 300)
    found = fit_frame_transform(
        a + np.array([1.0, 2.0, 0.0]), b, wrap_angle(heading + 0.4), heading
    )
    assert found.by_heading
    assert found.yaw == pytest.approx(0.4)
    assert (found.x, found.y) == pytest.approx((1.0, 2.0), abs=0.01)


# --- laws --------------------------------------------------------------------------------------

numbers = st.lists(st.floats(-1e3, 1e3), min_size=40, max_size=60)


def channel(values, angular=False):
    values = np.array(values)
    return Channel('odom/z', 'm', np.arange(len(values)) * 0.1, values, angular)


def compared(a, b, shift=0.0, angular=False):
    moved = (replace(each, time=each.time + shift) for each in (a, b))
    return compare_channels(ChannelPair('odom/z', *moved))


@settings(max_examples=40)
@given(numbers, st.booleans())
def test_a_channel_beside_itself_is_identical(values, angular):
    found = compared(channel(values, angular), channel(values, angular))
    assert found.verdict == 'identical'
    assert (found.measures.rms, found.measures.bias, found.measures.greatest) == (0.0, 0.0, 0.0)
    assert (found.measures.rms_low, found.measures.rms_high) == (0.0, 0.0)
    assert (found.parting.at, found.parting.first, found.score) == (None, None, 0.0)


@settings(max_examples=40)
@given(numbers, st.integers(0, 2**32 - 1))
def test_swapping_turns_the_sign_and_nothing_else(values, seed):
    a = channel(values)
    b = channel(np.array(values) + np.random.default_rng(seed).normal(size=len(values)))
    one, other = compared(a, b), compared(b, a)
    assert other.measures.bias == pytest.approx(-one.measures.bias)
    assert other.measures.greatest == pytest.approx(-one.measures.greatest)
    assert other.measures.rms == pytest.approx(one.measures.rms)
    assert other.parting == one.parting
    assert other.score == pytest.approx(one.score)


@settings(max_examples=40)
@given(numbers, numbers, st.integers(-1000, 1000))
def test_shifting_both_in_time_changes_no_figure(first, second, tenths):
    size = min(len(first), len(second))
    a, b = channel(first[:size]), channel(second[:size])
    here, there = compared(a, b), compared(a, b, 0.125 * tenths)
    assert there.measures.rms == pytest.approx(here.measures.rms)
    assert there.measures.rms_high == pytest.approx(here.measures.rms_high)
    assert there.verdict == here.verdict
    if here.parting.at is not None:
        assert there.parting.at - 0.125 * tenths == pytest.approx(here.parting.at, abs=1e-6)


@settings(max_examples=40)
@given(st.floats(-3.0, 3.0), st.floats(-10.0, 10.0), st.integers(0, 2**32 - 1))
def test_a_placement_undoes_what_was_done(yaw, shift, seed):
    b = np.random.default_rng(seed).normal(size=(50, 3))
    c, s = np.cos(yaw), np.sin(yaw)
    a = b @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + shift
    np.testing.assert_allclose(fit_frame_transform(a, b).transform_positions(b), a, atol=1e-9)
