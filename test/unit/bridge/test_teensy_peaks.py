# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Peaks that the board finds, beside what a demodulator makes of the same samples."""

from light_frames import build_frame
from lta_bridge.teensy.light_board import LightBoard, LightPeaks
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import EmulatedBoard
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import LampFinder, LampPrior
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import numpy as np
import pytest

LIGHT = load_topic_table().light
FINDER = LampFinder(build_diode_array(load_vehicle_file('gtmab').sensors.diodes))
FREQUENCY = 150.0
BOOT = 1_700_000_000_000_000_000


def lamp(azimuth, noise=3.0, seed=1):
    """Return a block under a square-wave lamp at an azimuth, on a ring of eight cosine diodes."""
    chance = np.random.default_rng(seed)
    time = np.arange(1000) / LIGHT.sample_rate.si
    wave = (np.sin(2 * np.pi * FREQUENCY * time) >= 0.0).astype(float)
    facing = np.array([axis[0] * np.cos(azimuth) + axis[1] * np.sin(azimuth) for axis in axes()])
    light = 200.0 + 800.0 * np.clip(facing, 0.0, 1.0) * wave[:, None]
    return np.round(light + chance.normal(0.0, noise, light.shape)).astype(np.uint16)


def axes():
    return FINDER.diodes.axes


def through(samples, link):
    """Return what the bridge makes of a board's peaks over these samples."""
    board = EmulatedBoard(BOOT)
    for turn in range(8):
        now = BOOT + 20_000_000 * turn
        assert (
            list(
                link.receive_bytes(
                    board.answer_timesync(link.compose_due_messages(now), now + 100_000),
                    now + 200_000,
                )
            )
            == []
        )
    frame = board.encode_peaks(samples, FREQUENCY, BOOT + 1_000_000_000)
    return list(link.receive_bytes(board.encode_status() + frame, BOOT + 1_100_000_000))


@pytest.mark.parametrize('azimuth', [0.0, 0.7, 2.5, -1.9])
def test_they_lead_where_the_samples_lead(azimuth):
    samples = lamp(azimuth)
    (came,) = through(samples, LightBoard(LIGHT, 8, finds_peaks=True))
    assert isinstance(came, LightPeaks)
    assert came.stamp_ns == pytest.approx(BOOT + 1_000_000_000, abs=200_000)
    settings = DemodulationSettings()
    heard = (
        BeaconReceiver(settings, LIGHT.sample_rate.si, LIGHT.samples)
        .demodulate_next_block(samples)
        .peaks[0]
    )
    bright = heard.amplitude > 50.0
    assert came.peaks.amplitude[bright] == pytest.approx(heard.amplitude[bright], rel=0.01)
    # All that is not the fundamental counts as noise, a square wave's harmonics too.
    assert (came.peaks.snr[bright] > settings.threshold).all()
    assert (came.peaks.snr[bright] < heard.snr[bright]).all()
    one, other = (
        FINDER.find_lamp(peaks, settings.threshold, LampPrior()).towards
        for peaks in (came.peaks, heard)
    )
    assert np.arctan2(one.y, one.x) == pytest.approx(azimuth, abs=np.radians(3.0))
    assert (one.x, one.y) == pytest.approx((other.x, other.y), rel=0.02, abs=0.02)


def test_in_the_dark_no_diode_is_believed():
    dark = np.random.default_rng(2).normal(200.0, 3.0, (1000, 8)).astype(np.uint16)
    (came,) = through(dark, LightBoard(LIGHT, 8, finds_peaks=True))
    assert (came.peaks.snr < DemodulationSettings().threshold).all()
    found = FINDER.find_lamp(came.peaks, DemodulationSettings().threshold, LampPrior())
    assert found == (None, None, None)


def test_peaks_that_nobody_asked_for_and_other_windows_are_one_sentence():
    link = LightBoard(LIGHT, 8)
    assert through(lamp(0.0), link) == []
    assert 'start with light_peaks:=true' in link.fault
    link = LightBoard(LIGHT, 8, finds_peaks=True)
    assert through(lamp(0.0)[:500], link) == []
    assert 'over 500 rows, but the vehicle has 8 diodes and a block has 1000' in link.fault


def test_samples_where_peaks_were_asked_for_and_peaks_of_no_number_are_one_sentence():
    link = LightBoard(LIGHT, 8, finds_peaks=True)
    board = EmulatedBoard(BOOT)
    assert (
        list(link.receive_bytes(board.encode_light(lamp(0.0)) + board.encode_status(), BOOT + 1))
        == []
    )
    assert 'sends samples instead of peaks; start without light_peaks:=true' in link.fault
    assert list(through(lamp(0.0), link)) != []
    assert link.fault == ''
    frame = build_frame('LTA_LIGHT_PEAKS', diodes=8, window=1000, frequency=np.nan)
    assert list(link.receive_bytes(frame, BOOT + 1)) == []
    assert 'sends peaks outside the range of its ADC' in link.fault
