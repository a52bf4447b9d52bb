"""Which bins count as quiet, and the ratio, by hand."""

from lta_vlc.spectral.bins import select_quiet_bins, signal_to_noise
import numpy as np
import pytest


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
