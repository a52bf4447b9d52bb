# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bins of beacons and of noise, at the limits of what is allowed, and lamps to tell apart."""

from lta_config.errors import BadInput
from lta_vlc.demodulation import plan_bins
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import (
    alias_frequency,
    mains_flicker_frequencies,
    select_quiet_bins,
    signal_to_noise,
)
import numpy as np
import pytest


def planned(samples, rate=None, **settings):
    """Return the bins of one beacon: 1 Hz wide and without mains unless stated otherwise."""
    given = {'mains': 0.0, 'harmonics': 1} | settings
    return plan_bins(DemodulationSettings(**given), rate or float(samples), samples)


def test_the_window_may_begin_at_the_first_bin_and_end_at_the_last():
    bins = planned(100, frequency=3.0, window=2)
    assert (bins.first, bins.last) == (1, 5)
    assert bins.frequency_limits == (0.5, 5.5)
    bins = planned(100, frequency=48.0, window=2)
    assert (bins.first, bins.last) == (46, 50)
    for frequency in (2.0, 49.0):
        with pytest.raises(BadInput, match='too close'):
            planned(100, frequency=frequency, window=2)


def test_sixteen_quiet_bins_are_enough():
    """The beacon takes three: 16 of bins 1 to 19 are left, and 15 of bins 1 to 18."""
    assert planned(38, frequency=10.0, window=1).quiet.size == 16
    sentence = (
        r'^The beacon at 10 Hz and its harmonics leave only 15 FFT bins of a block of 36 .* 16 are'
    )
    with pytest.raises(BadInput, match=sentence):
        planned(36, frequency=10.0, window=1)


def test_quiet_bins_by_hand():
    # Bins of 1 Hz up to 16; the beacon at 5 Hz, harmonics at 10 and 15, one bin either side.
    quiet = select_quiet_bins((5.0,), 32.0, 32, window=1, harmonics=10)
    assert quiet.tolist() == [1, 2, 3, 7, 8, 12, 13]


def test_only_the_harmonics_asked_for_are_masked():
    quiet = select_quiet_bins((5.0,), 32.0, 32, window=1, harmonics=1)
    assert quiet.tolist() == [1, 2, 3, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]


def test_harmonic_above_nyquist_still_reaches_below_it():
    # Harmonics at 6, 12 and 18 Hz; the last lies above Nyquist at 16, its window does not.
    quiet = select_quiet_bins((6.0,), 32.0, 32, window=2, harmonics=5)
    assert quiet.tolist() == [1, 2, 3, 9, 15]


def test_harmonics_are_rounded_one_by_one():
    # 4.4 Hz: harmonics at 4.4, 8.8 and 13.2 stand in bins 4, 9 and 13, not in 4, 8 and 12.
    quiet = select_quiet_bins((4.4,), 32.0, 32, window=0, harmonics=3)
    assert sorted(set(range(1, 17)) - set(quiet.tolist())) == [4, 9, 13]


def test_mains_stays_in_the_noise():
    assert 10 in select_quiet_bins((150.0,), 10_000.0, 1000, window=2, harmonics=50)


def test_ratio_with_its_limits():
    peak = np.array([6.0, 0.0, 0.0, 2.0])
    noise = np.array([1.5, 1.5, 0.0, 0.0])
    assert signal_to_noise(peak, noise) == pytest.approx([4.0, 0.0, 0.0, np.inf])


@pytest.mark.parametrize(
    ('frequency', 'appears'),
    [(150.0, 150.0), (5000.0, 5000.0), (6000.0, 4000.0), (10_000.0, 0.0), (10_150.0, 150.0)],
)
def test_sampling_folds_frequencies(frequency, appears):
    assert alias_frequency(frequency, 10_000.0) == pytest.approx(appears)


def test_lamps_on_the_mains_flicker_at_twice_its_frequency():
    assert mains_flicker_frequencies(60.0, 10_000.0) == [120.0 * k for k in range(1, 11)]
    assert mains_flicker_frequencies(0.0, 10_000.0) == []
    assert mains_flicker_frequencies(50.0, 250.0)[:4] == [100.0, 50.0, 50.0, 100.0]
