# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Frequencies of several lamps: laws over any demodulator, and what a spectrum says of them."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_studies.light.plan.frequencies import choose_frequencies, FrequencyBand, LOWEST_FLICKER
from lta_studies.light.plan.joint_snr import compute_crosstalk
import numpy as np
import pytest

from .halls import ear

BANDS = st.builds(
    FrequencyBand,
    rate=st.sampled_from([5e3, 1e4, 2e4]),
    samples=st.sampled_from([500, 1000, 2000]),
    window=st.integers(1, 3),
    mains=st.sampled_from([100.0, 120.0]),
    duty=st.sampled_from([0.5, 0.3, 0.25]),
)
USUAL = FrequencyBand(1e4, 1000, 2, 100.0, 0.5)


def has(band, order):
    """Whether a square wave of that duty has the harmonic, by its own Fourier integral."""
    on = np.arange(20_000) < band.duty * 20_000
    return abs(np.fft.rfft(on)[order]) > 1e-6 * 20_000


@given(band=BANDS, count=st.integers(1, 10))
def test_no_lamp_stands_in_the_window_of_another_nor_of_the_mains(band, count):
    try:
        found, order = choose_frequencies(band, [], count)
    except BadInput:
        return
    assert len(found) == count
    assert order >= 5
    half = band.window * band.rate / band.samples
    orders = [n for n in range(1, order + 1) if has(band, n)]
    for one in found:
        assert LOWEST_FLICKER <= one <= band.rate / 2 - half
        assert one * band.samples / band.rate == pytest.approx(
            round(one * band.samples / band.rate)
        )
        assert min(abs(one - k * band.mains) for k in range(1, 200)) > half
        for other in found:
            if one == other:
                continue
            assert abs(one - other) > 2.0 * half
            for n in orders:
                shown = abs((n * one + band.rate / 2) % band.rate - band.rate / 2)
                assert abs(shown - other) > half


def test_there_are_as_many_as_the_sentence_says():
    for fit in range(1, 200):
        try:
            choose_frequencies(USUAL, [], fit)
        except BadInput as error:
            sentence = str(error)
            break
    assert f'{fit} lamps need a frequency, but only {fit - 1} are free' in sentence
    assert 'a bin of 10 Hz' in sentence
    assert '100 Hz (mains)' in sentence
    assert 30 <= fit <= 50


def test_fewer_lamps_keep_clear_of_more_harmonics():
    orders = [choose_frequencies(USUAL, [], count)[1] for count in (1, 5, 10, 20, 30)]
    assert orders == sorted(orders, reverse=True)
    assert orders[0] > orders[-1]


def test_lamps_that_are_there_keep_theirs_and_the_new_ones_keep_clear():
    found, order = choose_frequencies(USUAL, [450.0], 3)
    assert 150.0 not in found  # its third harmonic
    assert USUAL.is_separable(450.0, np.array(found), order).all()
    with pytest.raises(BadInput, match='flickers at 500 Hz'):
        choose_frequencies(USUAL, [500.0], 1)
    with pytest.raises(BadInput, match='flicker at 150 and 450 Hz'):
        choose_frequencies(USUAL, [150.0, 450.0], 1)


def test_what_a_wave_leaves_in_the_window_of_another_is_as_faint_as_the_law_says():
    found, order = choose_frequencies(USUAL, [], 8)
    window, quiet = compute_crosstalk(ear(), found, 0.5)
    own = 2.0 / math.pi
    # The next harmonic that may come into a window, and what folds onto it from above.
    assert window.max() < 1.5 * own / (order + 2)
    assert quiet.max() < 0.01 * own
    near, _ = compute_crosstalk(ear(), [150.0, 450.0], 0.5)
    assert near[1, 0] == pytest.approx(own / 3.0, rel=0.01)  # the third harmonic
    assert near[0, 1] < 0.02
