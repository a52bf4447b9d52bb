# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Laws of the demodulation, over arbitrary beacons, blocks and rings."""

import math

from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from lta_config.errors import BadInput
from lta_vlc.demodulation import demodulate_block, DiodeFault, UNUSABLE_FAULTS
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import numpy as np
import pytest

RATE, SAMPLES = 10_000.0, 1000
TIME = np.arange(SAMPLES) / RATE
FREQUENCIES = st.floats(30.0, 4900.0)
PHASES = st.floats(-math.pi, math.pi)
SETTINGS = st.builds(
    DemodulationSettings,
    frequency=st.floats(1.0, 6000.0),
    others=st.lists(st.floats(1.0, 6000.0), max_size=3).map(tuple),
    window=st.integers(0, 3),
    harmonics=st.integers(1, 50),
    mains=st.sampled_from([0.0, 50.0, 60.0]),
)
ANY_BLOCK = hnp.arrays(
    np.float64,
    st.tuples(st.just(100), st.sampled_from([1, 4, 8, 16])),
    elements=st.floats(-1e6, 1e6) | st.sampled_from([0.0, 4095.0, math.nan, math.inf, -math.inf]),
)
COUNTS = hnp.arrays(np.uint16, st.tuples(st.just(100), st.sampled_from([1, 4, 8, 16])))


def lone(frequency: float, phase: float, shares: np.ndarray) -> np.ndarray:
    """Return a block of one tone that each diode sees by its share."""
    return 500.0 + np.outer(np.cos(2.0 * math.pi * frequency * TIME + phase), shares)


@given(
    frequency=FREQUENCIES,
    phase=PHASES,
    shares=hnp.arrays(np.float64, 5, elements=st.floats(0.1, 1e3)),
)
def test_a_tone_reads_its_frequency_and_amplitude_wherever_it_stands(frequency, phase, shares):
    settings_ = DemodulationSettings(frequency=frequency, mains=0.0, harmonics=1)
    heard = BeaconReceiver(settings_, RATE, SAMPLES).demodulate_next_block(
        lone(frequency, phase, shares)
    )
    # In the lowest bins the mirror image is near, in the highest that of the other end.
    near = 0.02 / min(frequency, RATE / 2.0 - frequency)
    assert heard.frequencies[0] == pytest.approx(frequency, abs=10.0 * near)
    assert heard.peaks[0].amplitude == pytest.approx(shares, rel=2.0 * near)


@settings(max_examples=50)
@given(chosen=SETTINGS, block=ANY_BLOCK | COUNTS)
def test_any_block_is_refused_at_the_start_or_answered_with_numbers(chosen, block):
    try:
        ears = BeaconReceiver(chosen, 1000.0, 100)
    except BadInput:
        return
    for _ in range(3):
        heard = ears.demodulate_next_block(block)
    assert len(heard.peaks) == len(chosen.beacons)
    assert len(heard.faults) == block.shape[1]
    sound = np.array([not fault & UNUSABLE_FAULTS for fault in heard.faults])
    for peaks, frequency in zip(heard.peaks, heard.frequencies, strict=True):
        assert 0.0 < frequency < 500.0
        for numbers in (peaks.amplitude, peaks.noise, peaks.frequency):
            assert np.isfinite(numbers).all()
            assert (numbers >= 0.0).all()
        assert not np.isnan(peaks.snr).any()
        assert (peaks.snr[~sound] == 0.0).all()
    wild = np.array([DiodeFault.NOT_A_NUMBER in fault for fault in heard.faults])
    assert (wild == ~np.isfinite(block.astype(float)).all(axis=0)).all()


@settings(max_examples=50)
@given(
    seed=st.integers(0, 2**32 - 1), count=st.sampled_from([4, 8, 16]), scale=st.floats(0.01, 100.0)
)
def test_more_light_on_everything_changes_no_ratio(seed, count, scale):
    block = np.random.default_rng(seed).normal(500.0, 20.0, (SAMPLES, count))
    bins = BeaconReceiver(DemodulationSettings(others=(250.0,)), RATE, SAMPLES)._planned(
        (150.0, 250.0), (0, 0)
    )
    before, after = demodulate_block(block, bins), demodulate_block(scale * block, bins)
    for one, other in zip(before.peaks, after.peaks, strict=True):
        assert other.snr == pytest.approx(one.snr, rel=1e-9)
        assert other.amplitude == pytest.approx(scale * one.amplitude, rel=1e-6)
    assert after.frequencies == pytest.approx(before.frequencies, rel=1e-9)


@settings(max_examples=50)
@given(seed=st.integers(0, 2**32 - 1), count=st.sampled_from([4, 8, 16]))
def test_diodes_in_another_order_say_the_same(seed, count):
    chance = np.random.default_rng(seed)
    shares, order = chance.uniform(0.0, 100.0, count), chance.permutation(count)
    block = lone(153.3, 1.0, shares) + chance.normal(0.0, 3.0, (SAMPLES, count))
    ears = [BeaconReceiver(DemodulationSettings(), RATE, SAMPLES) for _ in range(2)]
    before, after = (
        ears[0].demodulate_next_block(block),
        ears[1].demodulate_next_block(block[:, order]),
    )
    assert after.peaks[0].snr == pytest.approx(before.peaks[0].snr[order], rel=1e-12)
    assert after.peaks[0].amplitude == pytest.approx(before.peaks[0].amplitude[order], rel=1e-9)
    assert after.frequencies == pytest.approx(before.frequencies, rel=1e-12)


@settings(max_examples=25)
@given(frequency=st.floats(150.0, 3000.0), off=st.floats(-0.02, 0.02), blocks=st.integers(1, 40))
def test_a_lamp_within_the_window_is_never_lost(frequency, off, blocks):
    """However long it is followed, and whatever else it comes near."""
    try:
        ears = BeaconReceiver(DemodulationSettings(frequency=frequency), RATE, SAMPLES)
    except BadInput:
        assume(False)
    lamp = frequency + min(max(off * frequency, -15.0), 15.0)
    block = lone(lamp, 0.0, np.array([100.0, 10.0]))
    for _ in range(blocks):
        heard = ears.demodulate_next_block(block)
    assert heard.frequencies[0] == pytest.approx(lamp, abs=0.01)
