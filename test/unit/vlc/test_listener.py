# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Several beacons, wishes, drifting clocks, gaps and faults, from block to block."""

import math

from lta_config.errors import BadInput
from lta_graph.health import HealthLevel
from lta_vlc.demodulation import demodulate_block, DemodulatedBlock, DiodeFault, Peaks
from lta_vlc.messages import describe_beacons
from lta_vlc.receiver import (
    BeaconPresence,
    BeaconReceiver,
    BlockSequence,
    FrequencyTracker,
    tracking_range,
)
from lta_vlc.settings import ANY_BEACON, DemodulationSettings
import numpy as np
import pytest

from .tones import RATE, SAMPLES, square, tone

FACING = np.maximum(np.cos(np.arange(8) * math.pi / 4.0), 0.0)


def listener(**settings) -> BeaconReceiver:
    return BeaconReceiver(DemodulationSettings(**settings), RATE, SAMPLES)


def counts(*lamps, noise=3.0, seed=1):
    """Return a block of ADC counts of (frequency, amplitude, first diode that faces the lamp)."""
    block = np.full((SAMPLES, 8), 800.0)
    for frequency, amplitude, diode in lamps:
        block += amplitude * np.outer(square(frequency, 0.3), np.roll(FACING, diode))
    block += np.random.default_rng(seed).normal(0.0, noise, block.shape)
    return np.rint(block).clip(0, 4095).astype(np.uint16)


def test_two_lamps_are_heard_each_from_its_side():
    heard = listener(others=(250.0,)).demodulate_next_block(
        counts((150.0, 200.0, 0), (250.0, 20.0, 3))
    )
    near, far = heard.peaks
    assert near.amplitude.argmax() == 0
    assert far.amplitude.argmax() == 3
    # One standard deviation is 3 sqrt(2 / 1000) = 0.13 counts.
    assert near.amplitude == pytest.approx(200.0 * FACING, abs=0.6)
    assert far.amplitude == pytest.approx(20.0 * np.roll(FACING, 3), abs=0.6)
    assert heard.frequencies == pytest.approx([150.0, 250.0], abs=0.05)
    assert heard.level == pytest.approx(np.full(8, 800.0), abs=0.5)
    assert near.noise is far.noise
    assert set(heard.faults) == {DiodeFault.NONE}


def test_the_other_lamp_is_no_noise():
    """Without its harmonics masked, those of the near lamp would bury the far one."""
    block = counts((150.0, 400.0, 0), (250.0, 2.0, 0))
    both = listener(others=(250.0,)).demodulate_next_block(block)
    alone = listener(frequency=250.0).demodulate_next_block(block)
    assert both.peaks[1].snr[0] > 6.0
    assert alone.peaks[0].snr[0] < 2.0


def test_what_is_wanted_comes_first_and_the_rest_stays():
    ears = listener()
    block = counts((150.0, 200.0, 0), (250.0, 20.0, 3))
    assert len(ears.demodulate_next_block(block).peaks) == 1
    ears.prioritize_beacon(250.0)
    assert ears.beacons == (250.0, 150.0)
    assert ears.demodulate_next_block(block).peaks[0].amplitude.argmax() == 3
    ears.prioritize_beacon(ANY_BEACON)
    assert ears.beacons == (150.0, 250.0)
    assert ears.demodulate_next_block(block).peaks[0].amplitude.argmax() == 0


def test_a_wish_pushes_out_what_it_collides_with():
    ears = listener()
    ears.prioritize_beacon(180.0 - 10.0)  # within the resolution of 150 Hz
    assert ears.beacons == (170.0,)
    with pytest.raises(BadInput, match=r'at 310 Hz \(2 bins'):
        ears.prioritize_beacon(310.0)
    assert ears.beacons == (170.0,)


def test_only_so_many_wishes_are_remembered():
    ears = listener(window=1)
    for wish in (250.0, 350.0, 550.0, 650.0, 850.0):
        ears.prioritize_beacon(wish)
    assert ears.beacons == (850.0, 650.0, 550.0, 350.0)


def test_a_clock_that_drifts_is_followed_out_of_the_window():
    """1250 Hz that is 3 % off in the end: 37 Hz, where the window is 20 Hz."""
    ears, errors = listener(frequency=1250.0), []
    for k in range(120):
        frequency = 1250.0 + 37.0 * min(k / 100.0, 1.0)
        heard = ears.demodulate_next_block(counts((frequency, 50.0, 0), seed=k))
        assert heard.peaks[0].snr[0] > 6.0, k
        errors.append(heard.frequencies[0] - frequency)
    assert np.abs(errors).max() < 0.1  # Hz, of 10 Hz a bin
    still = listener(frequency=1250.0).demodulate_next_block(counts((1287.0, 50.0, 0)))
    assert abs(still.frequencies[0] - 1287.0) > 5.0  # not in the window from the start


def test_a_lamp_that_is_gone_is_sought_where_it_should_be():
    ears = listener(frequency=1250.0)
    for k in range(30):
        ears.demodulate_next_block(counts((1265.0, 50.0, 0), seed=k))
    aside = ears.demodulate_next_block(counts((1282.0, 50.0, 0)))
    assert aside.frequencies[0] == pytest.approx(1282.0, abs=0.2)
    ears.skip_blocks(20)
    back = ears.demodulate_next_block(counts((1235.0, 50.0, 0)))
    assert back.frequencies[0] == pytest.approx(1235.0, abs=0.2)


def test_a_beacon_is_found_and_lost_with_patience():
    ears, bright, dark = listener(), counts((150.0, 50.0, 0)), counts()
    told = []
    for block in [bright, bright, dark, bright, dark, dark, dark, dark, dark, bright]:
        ears.demodulate_next_block(block)
        told.append(ears.presences[150.0].found)
    assert told == [False, True, True, True, True, True, True, True, False, False]


def test_spoilt_diodes_are_flagged_gated_and_pull_nothing():
    block = counts((150.3, 200.0, 0)).astype(float)
    block[:, 1] = 4095.0 * (square(143.0) > 0.0)  # saturated half of the time, and off
    block[:, 2] = 17.0
    block[5, 3] = math.nan
    block[7, 4] = -math.inf
    block[3, 5] = 4095.0  # a glitch, no more
    heard = demodulate_block(block, listener()._planned((150.0,), (0,)), 4095.0)
    wild = DiodeFault.NOT_A_NUMBER
    assert heard.faults[1:5] == (DiodeFault.SATURATED, DiodeFault.FLAT, wild, wild)
    assert [heard.faults[k] for k in (0, 5, 6, 7)] == [DiodeFault.NONE] * 4
    assert heard.peaks[0].snr[1:5].tolist() == [0.0] * 4
    assert heard.frequencies[0] == pytest.approx(150.3, abs=0.05)
    assert heard.peaks[0].amplitude[0] == pytest.approx(200.0, abs=0.6)
    assert np.isnan(heard.level).tolist() == [False, False, False, True, True] + [False] * 3
    assert np.isfinite(heard.peaks[0].amplitude).all()


@pytest.mark.parametrize(('bits', 'factor'), [(10, 1.0), (12, 1.0), (16, 16.0)])
def test_what_clips_is_what_the_converter_says(bits, factor):
    """800 counts of 12 bits with 200 of a lamp on them: the top of 10 bits, and far from it."""
    top = 2.0**bits - 1.0
    ears = BeaconReceiver(DemodulationSettings(), RATE, SAMPLES, top)
    heard = ears.demodulate_next_block(
        (factor * counts((150.0, 400.0, 0)).astype(float)).clip(0.0, top)
    )
    assert (heard.faults[0] is DiodeFault.SATURATED) == (bits == 10)
    assert heard.faults[4] is DiodeFault.NONE


def test_a_tone_that_nobody_knows_is_told_and_mains_are_known():
    strange = counts((150.0, 5.0, 0)) + np.rint(200.0 + 40.0 * tone(3210.0))[:, None].astype(int)
    assert set(listener().demodulate_next_block(strange).faults) == {DiodeFault.ALIASED}
    mains = counts((150.0, 5.0, 0)) + np.rint(200.0 + 40.0 * tone(100.4))[:, None].astype(int)
    assert set(listener().demodulate_next_block(mains).faults) == {DiodeFault.NONE}


PERIOD = 100_000_000
START = 1_000_000_000


def taken(*blocks: float) -> list[int]:
    """Return how many blocks are missing before each of these, counted in blocks."""
    sequence = BlockSequence(PERIOD)
    return [sequence.count_missing_blocks(START + round(block * PERIOD)) for block in blocks]


def test_blocks_go_on_from_one_another():
    assert taken(0, 1, 2, 3) == [0, 0, 0, 0]


def test_a_clock_that_trembles_loses_nothing():
    assert taken(0, 1.3, 2.2, 2.8, 4.2) == [0, 0, 0, 0, 0]


@pytest.mark.parametrize('late', [1, 0, 1.4, 1.4999, -8.9999])
def test_a_block_out_of_order_is_refused_and_the_newest_kept(late):
    sequence = BlockSequence(PERIOD)
    sequence.count_missing_blocks(START + PERIOD)
    with pytest.raises(BadInput, match=r'follows one with 1.100 s, but each block lasts 0.1 s'):
        sequence.count_missing_blocks(START + round(late * PERIOD))
    assert sequence.count_missing_blocks(START + 2 * PERIOD) == 0


def test_a_recording_may_begin_again():
    assert taken(50, 51, 0, 1) == [0, 0, 0, 0]


def test_after_twenty_silent_blocks_the_nominal_frequency_is_expected():
    tracker = FrequencyTracker(150.0, 1.5)
    for silent in range(1, 20):
        tracker = tracker.coast_without_detection()
        assert tracker == FrequencyTracker(150.0, 1.5, silent)
    assert tracker.coast_without_detection() == FrequencyTracker(150.0, 0.0, 20)
    assert FrequencyTracker(150.0, 1.5, 4).coast_without_detection(15) == FrequencyTracker(
        150.0, 1.5, 19
    )
    assert FrequencyTracker(150.0, 1.5, 4).coast_without_detection(16) == FrequencyTracker(
        150.0, 0.0, 20
    )
    assert FrequencyTracker(150.0, 1.5, 19).update_frequency(151.5, 20.0) == FrequencyTracker(
        150.0, 1.5, 0
    )


@pytest.mark.parametrize(
    ('beacons', 'flicker', 'apart', 'far'),
    [
        ((1000.0,), (), 30.0, 50.0),  # a twentieth of its frequency
        ((1000.0, 1120.0), (), 30.0, 30.0),  # half of the way to the next beacon, less `apart`
        ((880.0, 1000.0), (), 30.0, 30.0),
        ((1000.0,), (930.0, 1100.0), 30.0, 40.0),  # all of the way to the flicker, less `apart`
        ((1000.0, 1120.0), (1050.0,), 30.0, 20.0),
        ((1000.0, 1050.0), (), 30.0, 0.0),
    ],
)
def test_reach_ends_before_the_bins_of_other_beacons_and_of_flicker(beacons, flicker, apart, far):
    assert tracking_range(1000.0, beacons, flicker, apart) == pytest.approx(far)


NOTHING = np.zeros(4)
LOST, FOUND = BeaconPresence(False), BeaconPresence(True)


def told(*presences, snr=(5.0, 3.0), faults=(DiodeFault.NONE,) * 4):
    """Return the facts of two beacons, at 150 and 250 Hz, that are heard 0.3 Hz too high."""
    peaks = tuple(
        Peaks(NOTHING, np.array([0.5 * best, best, 0.0, 0.0]), NOTHING, NOTHING) for best in snr
    )
    hearing = DemodulatedBlock(peaks, (150.3, 250.3), faults, NOTHING)
    return list(describe_beacons(hearing, (150.0, 250.0), presences, 7, 2))


def test_the_wanted_beacon_warns_where_no_diode_hears_it_and_another_never():
    assert [(fact.task, fact.level, fact.message) for fact in told(FOUND, FOUND)] == [
        ('light', HealthLevel.OK, 'beacon found'),
        ('beacon at 250 Hz', HealthLevel.OK, 'beacon found'),
    ]
    assert [(fact.level, fact.message) for fact in told(LOST, LOST)] == [
        (HealthLevel.WARN, 'no photodiode receives the beacon'),
        (HealthLevel.OK, 'no photodiode receives the beacon'),
    ]


def test_what_concerns_the_diodes_is_told_once():
    saturated = DiodeFault.SATURATED | DiodeFault.ALIASED
    faults = (
        saturated,
        DiodeFault.FLAT,
        DiodeFault.SATURATED,
        DiodeFault.SATURATED | DiodeFault.NOT_A_NUMBER,
    )
    wanted, other = told(FOUND, FOUND, faults=faults)
    assert wanted.values == {
        'beacon_Hz': '150',
        'best_snr': '5.0',
        'frequency_error_Hz': '0.300',
        'saturated_diodes': '3',
        'flat_diodes': '1',
        'wild_diodes': '1',
        'aliased_diodes': '1',
        'blocks_missing': '7',
        'blocks_refused': '2',
    }
    assert other.values == {
        'beacon_Hz': '250',
        'best_snr': '3.0',
        'frequency_error_Hz': '0.300',
    }


def test_one_that_is_not_heard_has_no_frequency_to_be_off():
    assert math.isnan(float(told(LOST, FOUND)[0].values['frequency_error_Hz']))
    deaf = told(FOUND, FOUND, snr=(0.0, 3.0))[0].values['frequency_error_Hz']
    assert math.isnan(float(deaf))
    faint = told(FOUND, FOUND, snr=(1.0, 1.0))[1].values['frequency_error_Hz']
    assert faint == '0.300'
