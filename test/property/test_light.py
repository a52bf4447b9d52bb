# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Laws of the light and of the paper's bearing, over arbitrary scenes."""

import math

from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lta_model.light.field import Ambient, LightField, PlaneIlluminance
from lta_model.light.lamp import BeaconLamp, direct_illuminance, phase_in_cycles, SquareWave
from lta_model.sensors.photodiode import DiodeRing, PhotodiodeArray, spread_azimuths
from lta_model.sensors.photodiode_adc import PhotodiodeBoard
from lta_vlc.demodulation import demodulate_beacon, Peaks, plan_bins
from lta_vlc.diodes import build_even_ring
from lta_vlc.lamp import estimate_bearing
from lta_vlc.settings import DemodulationSettings
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

RING = PhotodiodeArray(count=8, depth=0.33, radius=0.05, feedback_resistance=1e5)
ANGLES = st.floats(-math.pi, math.pi)
METRES = st.floats(-5.0, 5.0)
POINTS = st.tuples(METRES, METRES, st.floats(0.1, 3.0))
READINGS = st.lists(st.floats(1.0, 4000.0), min_size=8, max_size=8).map(np.array)
WAVES = st.builds(
    SquareWave, st.floats(1.0, 5000.0), st.floats(0.05, 0.95), st.floats(-10.0, 10.0)
)
TIMES = st.integers(0, 2 * 10**18)


def peaks(readings: np.ndarray) -> Peaks:
    """Return readings that all pass the gate."""
    each = np.ones(readings.size)
    return Peaks(readings, 100.0 * each, 150.0 * each, each)


def turned(scene_turn: Rotation, position, attitude: Rotation, lamp_axis) -> np.ndarray:
    """Return the light on the diodes with the whole scene, lamp and drone, turned."""
    lamp = BeaconLamp(
        tuple(scene_turn.apply([2.0, 1.0, 1.5])),
        tuple(scene_turn.apply(lamp_axis)),
        10_000.0,
        SquareWave(150.0),
        300.0,
    )
    place = RING.transform_to_map(scene_turn.apply(position), (scene_turn * attitude).as_matrix())
    return direct_illuminance(lamp, *place)


@given(
    turn=st.tuples(ANGLES, ANGLES, ANGLES),
    tilt=st.tuples(ANGLES, ANGLES, ANGLES),
    position=POINTS,
    axis=st.tuples(METRES, METRES, METRES),
)
def test_turning_lamp_and_drone_together_changes_nothing(turn, tilt, position, axis):
    assume(math.hypot(*axis) > 0.1)
    assume(math.dist(position, (2.0, 1.0, 1.5)) > 0.6)
    attitude = Rotation.from_euler('zyx', tilt)
    still = turned(Rotation.identity(), position, attitude, axis)
    moved = turned(Rotation.from_euler('zyx', turn), position, attitude, axis)
    assert moved == pytest.approx(still, rel=1e-9, abs=1e-9)


@settings(max_examples=25)
@given(yaw=ANGLES, distance=st.floats(1.5, 7.0))
def test_turning_lamp_and_drone_together_leaves_the_counts(yaw, distance):
    blocks = []
    for turn in (0.0, yaw):
        about = Rotation.from_euler('z', turn)
        lamp = BeaconLamp(
            tuple(about.apply([distance, 0.0, 1.0])),
            tuple(about.apply([-1.0, 0.0, 0.0])),
            10_000.0,
            SquareWave(150.0),
            300.0,
        )
        field = LightField((lamp,), Ambient(300.0, 100.0, 10.0))
        place = RING.transform_to_map(np.array([[0.0, 0.0, 1.3]]), about.as_matrix()[None])
        even = np.ones((1, 8))
        light = PlaneIlluminance(direct_illuminance(lamp, *place)[None], 100.0 * even, 10.0 * even)
        block, _ = PhotodiodeBoard(RING, field, 1e4, 1000).sample_block(
            light, 10**18, np.random.default_rng(3)
        )
        blocks.append(block.astype(int))
    # Rounding may tip a sample that stands between two counts, never more.
    assert np.abs(blocks[1] - blocks[0]).max() <= 1
    assert (blocks[1] != blocks[0]).mean() < 1e-3


@given(readings=READINGS, turn=ANGLES)
def test_bearing_turns_with_the_ring(readings, turn):
    ring = build_even_ring(8).ring
    angles = [azimuth + turn for azimuth in spread_azimuths(8)]
    moved = DiodeRing(tuple(map(math.cos, angles)), tuple(map(math.sin, angles)))
    before, after = (
        estimate_bearing(peaks(readings), ring, 6.0),
        estimate_bearing(peaks(readings), moved, 6.0),
    )
    assume(before is not None)
    assume(math.hypot(before.x, before.y) > 1e-3)
    assert math.remainder(after.angle - before.angle - turn, math.tau) == pytest.approx(
        0.0, abs=1e-9
    )
    assert after.deviation == pytest.approx(before.deviation, rel=1e-6)


@given(readings=READINGS, shift=st.integers(0, 7))
def test_bearing_steps_with_the_diodes(readings, shift):
    before = estimate_bearing(peaks(readings), build_even_ring(8).ring, 6.0)
    assume(before is not None)
    assume(math.hypot(before.x, before.y) > 1e-3)
    after = estimate_bearing(peaks(np.roll(readings, shift)), build_even_ring(8).ring, 6.0)
    step = after.angle - before.angle - shift * math.pi / 4.0
    assert math.remainder(step, math.tau) == pytest.approx(0.0, abs=1e-9)


@given(readings=READINGS, scale=st.floats(1e-3, 1e3))
def test_brighter_light_has_the_same_bearing(readings, scale):
    before = estimate_bearing(peaks(readings), build_even_ring(8).ring, 6.0)
    assume(before is not None)
    assume(math.hypot(before.x, before.y) > 1e-3)
    after = estimate_bearing(peaks(scale * readings), build_even_ring(8).ring, 6.0)
    assert (after.x, after.y) == pytest.approx((before.x, before.y), rel=1e-9, abs=1e-12)
    assert math.remainder(after.angle - before.angle, math.tau) == pytest.approx(0.0, abs=1e-9)


@given(readings=READINGS, pedestal=st.floats(0.0, 1e4))
def test_light_from_all_sides_leaves_the_bearing(readings, pedestal):
    before = estimate_bearing(peaks(readings), build_even_ring(8).ring, 6.0)
    assume(before is not None)
    assume(math.hypot(before.x, before.y) > 1e-2)
    after = estimate_bearing(peaks(readings + pedestal), build_even_ring(8).ring, 6.0)
    assert math.remainder(after.angle - before.angle, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert math.hypot(after.x, after.y) <= math.hypot(before.x, before.y) + 1e-12


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**32 - 1),
    amplitude=st.floats(5.0, 100.0),
    growth=st.floats(1.01, 10.0),
    phase=ANGLES,
)
def test_more_light_gives_more_snr(seed, amplitude, growth, phase):
    time = np.arange(500)
    tone = np.sin(2.0 * math.pi * 15 * time / 500.0 + phase)
    noise = np.random.default_rng(seed).normal(size=500)
    bins = plan_bins(DemodulationSettings(harmonics=1), 5000.0, 500)
    # Far above the noise in its own bin, 0.06 to 0.3, a longer phasor is a higher peak.
    faint = demodulate_beacon((amplitude * tone + noise)[:, None], bins).snr[0]
    bright = demodulate_beacon((amplitude * growth * tone + noise)[:, None], bins).snr[0]
    assert bright > faint


@given(wave=WAVES, start=TIMES, time_constant=st.floats(1e-6, 10.0))
def test_lagged_wave_stays_between_off_and_on(wave, start, time_constant):
    times = start + np.arange(0, 10**8, 1_234_567, dtype=np.int64)
    lagged = wave.sample_filtered(times, time_constant)
    assert (lagged >= 0.0).all()
    assert (lagged <= 1.0).all()


@given(wave=WAVES, start=TIMES, periods=st.integers(1, 1000))
def test_wave_repeats_after_whole_seconds(wave, start, periods):
    whole = SquareWave(float(round(wave.frequency)), wave.duty, wave.phase)
    first = whole.phase_in_cycles(np.array([start], dtype=np.int64))
    later = whole.phase_in_cycles(np.array([start + periods * 10**9], dtype=np.int64))
    assert later == first
    assert phase_in_cycles(np.array([start]), whole.frequency, whole.phase) == first
