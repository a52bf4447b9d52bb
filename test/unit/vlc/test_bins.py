"""Bins in which beacons are sought and noise is measured, at the limits of what is allowed."""

from lta_config.errors import BadInput
from lta_vlc.demodulation import plan_bins
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.bins import plan_beacon_bins
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


def test_a_beacon_at_half_of_the_sample_rate_is_refused():
    with pytest.raises(BadInput, match='at 50 Hz cannot be detected at 100 samples/s'):
        planned(100, frequency=50.0, window=0)
    assert planned(100, frequency=49.9, window=0).first == 50


def test_sixteen_quiet_bins_are_enough():
    """The beacon takes three: 16 of bins 1 to 19 are left, and 15 of bins 1 to 18."""
    assert planned(38, frequency=10.0, window=1).quiet.size == 16
    sentence = (
        r'^The beacon at 10 Hz and its harmonics leave only 15 FFT bins of a block of 36 .* 16 are'
    )
    with pytest.raises(BadInput, match=sentence):
        planned(36, frequency=10.0, window=1)


def test_unlit_bins_are_more_than_one_and_a_half_bins_from_mains_flicker():
    """Mains of 10 Hz make lamps flicker at multiples of 20 Hz; bins are 0.5 Hz wide."""
    bins = planned(200, 100.0, frequency=5.0, window=0, mains=10.0)
    quiet, unlit = bins.quiet.tolist(), bins.unlit.tolist()
    assert quiet == [k for k in range(1, 101) if k != 10]
    flicker = [40, 80]  # bins; 60 Hz and above are aliased to 40, 20 or 0 Hz
    beside = {k + side for k in (0, *flicker) for side in (-1, 0, 1)}
    assert unlit == [k for k in quiet if k not in beside]


def test_flicker_between_two_bins_excludes_two_bins_on_either_side():
    """21 Hz is bin 10.5 of 2 Hz; 189 and 210 Hz are aliased to 11 and 10 Hz, bins 5.5 and 5."""
    bins = planned(100, 200.0, frequency=60.0, window=0, mains=10.5)
    spoilt = set(bins.quiet.tolist()) - set(bins.unlit.tolist())
    assert {k for k in spoilt if k < 15} == {4, 5, 6, 7, 9, 10, 11, 12}
    without = planned(100, 200.0, frequency=60.0, window=0)
    assert without.unlit.tolist() == without.quiet.tolist()


def test_the_refusal_names_all_beacons():
    with pytest.raises(
        BadInput, match=r'^The beacons at 5, 10 Hz and their harmonics leave only 9 FFT bins'
    ):
        plan_beacon_bins(
            (5.0, 10.0), DemodulationSettings(window=1, harmonics=1, mains=0.0), 30.0, 30
        )
