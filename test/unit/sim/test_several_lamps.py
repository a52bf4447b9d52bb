# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lamps at their own frequencies, clocks that are off, slow edges, diodes that are not alike."""

from dataclasses import replace
import math

from lta_model.light.direct_light import angular_response, build_beam, DiodeResponse, direct_light
from lta_model.light.field import Ambient, LightField, PlaneIlluminance
from lta_model.light.flicker import BlockSampling, sample_lamp_wave, sample_mains_wave
from lta_model.light.lamp import BeaconLamp, DriftingClock, lambertian_order, SquareWave
from lta_model.sensors.photodiode import PhotodiodeArray
import numpy as np
import pytest
from square_waves import sample_wave

from .even_light import synthesise
from .lamp_room import build, fly

LED = 300.0
RATE, SAMPLES = 1e4, 1000
LAMP = BeaconLamp((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 10_000.0, SquareWave(150.0), LED)
TAU = 1.0 / (2.0 * math.pi * 14e3)


def ring(**given) -> PhotodiodeArray:
    usual = {'count': 4, 'depth': 0.3, 'radius': 0.05, 'feedback_resistance': 1e6, 'noise': 0.0}
    return PhotodiodeArray(**{**usual, **given})


def block(array, lamps, lux, start=0, seed=1):
    """Return the counts of diodes that all read so much of each lamp [lx]."""
    field = LightField(tuple(lamps), Ambient(LED))
    lit = np.array(lux)[:, None, None] * np.ones((1, 1, array.count))
    nothing = np.zeros((1, array.count))
    light = PlaneIlluminance(lit, nothing, nothing)
    return synthesise(array, field, light, start, RATE, SAMPLES, np.random.default_rng(seed))[0]


def tone(counts, frequency, rate=RATE):
    """Return the amplitude of a frequency in the counts of the first diode, by its definition."""
    turn = np.exp(-2j * math.pi * frequency * np.arange(len(counts)) / rate)
    return 2.0 * abs(np.mean(counts[:, 0] * turn))


def test_each_lamp_is_heard_at_its_own_frequency():
    other = replace(LAMP, wave=SquareWave(330.0))
    counts = block(ring(), (LAMP, other), (60.0, 25.0)).astype(float)
    # 6.482 mV a lux; the fundamental of a square wave has 2 / pi of its height; 1241.2 counts a V.
    a_lux = 6.4823e-3 * 2.0 / math.pi * 4096 / 3.3
    assert tone(counts, 150.0) == pytest.approx(60.0 * a_lux, rel=2e-3)
    assert tone(counts, 330.0) == pytest.approx(25.0 * a_lux, rel=2e-3)
    assert tone(counts, 270.0) < 0.5


def test_a_block_of_two_lamps_is_the_sum_of_theirs():
    array = ring(adc_bits=16, dark_offset=0.0)
    other = replace(LAMP, wave=SquareWave(330.0, 0.3), efficacy=200.0)
    both = block(array, (LAMP, other), (20.0, 15.0)).astype(int)
    apart = block(array, (LAMP,), (20.0,)).astype(int) + block(array, (other,), (15.0,))
    # Rounding, and shot noise of 0.05 mV in 0.05 mV steps.
    assert np.abs(both - apart).max() <= 8
    assert abs((both - apart).mean()) < 0.1


def test_a_fast_clock_moves_the_line_by_its_part():
    """A lamp that is 1000 ppm fast and a converter 1000 ppm slow: 150 Hz look like 150.3."""
    lamp = replace(LAMP, clock=DriftingClock(1e-3))
    array = ring(clock_error=-1e-3)
    field = LightField((lamp,), Ambient(LED))
    light = PlaneIlluminance(np.full((1, 1, 4), 60.0), np.zeros((1, 4)), np.zeros((1, 4)))
    chance = np.random.default_rng(1)
    counts, _ = synthesise(array, field, light, 10**9, RATE, 20_000, chance)
    found = [tone(counts.astype(float), f) for f in np.arange(149.5, 151.0, 0.05)]
    assert 149.5 + 0.05 * int(np.argmax(found)) == pytest.approx(150.3, abs=0.026)


def test_a_drifting_clock_is_a_chirp():
    """Phase f (o t + d t^2 / 2) against the edges of the wave, half a minute after time zero."""
    clock = DriftingClock(20e-6, 3e-6)
    start = 30 * 10**9
    times = start + np.arange(0, 10**8, 1000, dtype=np.int64)
    seconds = times * 1e-9
    phase = 150.0 * (seconds * (1.0 + 20e-6) + 0.5 * 3e-6 * seconds**2)
    told = clock.distort_wave(SquareWave(150.0), start).phase_in_cycles(times)
    apart = (told - phase + 0.5) % 1.0 - 0.5
    assert np.abs(apart).max() < 150.0 * 0.5 * 3e-6 * 0.1**2 * 1.01


def test_a_rise_time_is_that_of_the_edges():
    """From 10 to 90 % in 0.4 ms, behind an amplifier that is much faster."""
    lamp = replace(LAMP, wave=SquareWave(10.0), rise=0.4e-3)
    sampling = BlockSampling(1e6, 50_000)
    wave = sample_lamp_wave(lamp, 0, sampling, 1e-7)
    took = np.searchsorted(wave[1:], 0.9) - np.searchsorted(wave[1:], 0.1)
    assert took * 1e-6 == pytest.approx(0.4e-3, abs=2e-6)


def test_two_poles_are_those_of_a_fine_simulation():
    lamp = replace(LAMP, wave=SquareWave(137.0, 0.4), rise=1e-3)
    own, behind = 1e-3 / math.log(9.0), 0.7e-3
    fine = np.arange(-60_000, 20_000, dtype=np.int64) * 1000
    drive, first, second, told = sample_wave(lamp.wave, fine), 0.0, 0.0, []
    for level in drive.tolist():
        told.append(second)
        second += (first - second) * 1e-6 / behind
        first += (level - first) * 1e-6 / own
    expected = np.array(told)[60_000::100]
    wave = sample_lamp_wave(lamp, 0, BlockSampling(1e4, 200), behind)[1:]
    assert np.abs(wave - expected).max() < 2e-3


def test_poles_that_are_alike_are_no_trouble():
    alike = replace(LAMP, rise=TAU * math.log(9.0))
    near = replace(LAMP, rise=TAU * math.log(9.0) * 1.01)
    sampling = BlockSampling(RATE, SAMPLES)
    apart = sample_lamp_wave(alike, 0, sampling, TAU) - sample_lamp_wave(near, 0, sampling, TAU)
    assert np.abs(apart).max() < 0.01


def test_late_samples_see_the_wave_later():
    slow = replace(LAMP, wave=SquareWave(7.0), rise=10e-3)
    late = np.full(SAMPLES, 2e-4)
    shaken = sample_lamp_wave(slow, 0, BlockSampling(RATE, SAMPLES), TAU, late)
    still = sample_lamp_wave(slow, 0, BlockSampling(RATE, SAMPLES + 2), TAU)
    np.testing.assert_allclose(shaken[1:], still[3:], atol=1e-9)


def test_jitter_is_as_strong_as_asked_and_hits_all_diodes_alike():
    """On a slope every microsecond of lateness is a step: 1 us rms of 0.1 V/ms is 0.1 mV."""
    array = ring(jitter=60e-6, adc_bits=16)
    lamp = replace(LAMP, wave=SquareWave(2.0), rise=0.2)
    counts = block(array, (lamp,), (100.0,)).astype(float)
    still = block(ring(adc_bits=16), (lamp,), (100.0,)).astype(float)
    moved = (counts - still)[1:]
    slope = np.diff(still, axis=0) * 1e4
    share = moved[:, 0] @ slope[:, 0] / (slope[:, 0] @ slope[:, 0])
    assert abs(share) < 4 * 60e-6 / math.sqrt(SAMPLES)
    wanted = 60e-6 * np.sqrt((slope**2).mean())
    # Two draws of shot noise and two roundings stand beside it.
    assert moved.std() == pytest.approx(wanted, rel=0.05)
    assert np.corrcoef(moved[:, 0], moved[:, 1])[0, 1] > 0.5


def test_harmonics_of_the_mains_add_up():
    ambient = Ambient(LED, 100.0, 20.0, 100.0, mains_harmonics=(0.5, 0.25))
    wave = sample_mains_wave(ambient, 0, BlockSampling(RATE, SAMPLES))
    turn = 2.0 * math.pi * 100.0 * np.arange(SAMPLES) / RATE
    by_hand = np.sin(turn) + 0.5 * np.sin(2 * turn) + 0.25 * np.sin(3 * turn)
    np.testing.assert_allclose(wave, by_hand, atol=1e-9)


def test_a_diode_reads_as_a_power_of_the_cosine_up_to_its_edge():
    light, towards = direct_light(build_beam(LAMP), (7.0, 0.0, 1.0))
    assert light == pytest.approx(64.96, abs=0.01)
    assert towards == (-1.0, 0.0, 0.0)
    aside = (-math.cos(1.0), math.sin(1.0), 0.0)
    assert angular_response(DiodeResponse(1.2, 0.0), aside, towards) == pytest.approx(
        math.cos(1.0) ** 1.2
    )
    assert angular_response(DiodeResponse(1.2, math.cos(0.9)), aside, towards) == 0.0
    assert angular_response(DiodeResponse(1.2, math.cos(1.1)), aside, towards) > 0.0


def test_gains_are_those_of_the_spread_and_dead_diodes_read_nothing():
    array = ring(count=64, gain_spread=0.02, dead=(3, 5))
    gains = np.array([array.draw_gains(np.random.default_rng(k)).gains for k in range(100)])
    assert gains.mean() == pytest.approx(1.0, abs=1e-3)
    assert gains.std() == pytest.approx(0.02, rel=0.05)
    counts = block(array, (LAMP,), (60.0,))
    assert not counts[:, [3, 5]].any()
    assert counts[:, 4].max() > 400


def test_a_gain_scales_every_light():
    array = ring(gains=(1.0, 0.5, 1.0, 1.0), dark_offset=0.0)
    counts = block(array, (LAMP,), (100.0,)).astype(float)
    assert counts[:, 1].max() / counts[:, 0].max() == pytest.approx(0.5, abs=2e-3)


def test_axes_may_look_anywhere():
    axes = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.6, -0.8), (0.0, 1.0, 0.0))
    planes = ring(axes=axes).planes
    np.testing.assert_array_equal(planes[:, 3:], axes)
    np.testing.assert_allclose(planes[2, :3], [0.0, 0.03, -0.34])


def test_a_flight_draws_its_own_gains():
    spread = {'sensors/diodes/gain_spread': {'value': 5, 'unit': '%', 'source': 'test'}}
    blocks = []
    for seed in (1, 1, 2):
        readings = fly(build(seed=seed, vehicle=spread), 11)
        blocks.append(next(r.block[1] for r in readings if r.block is not None))
    assert np.array_equal(blocks[0], blocks[1])
    assert not np.array_equal(blocks[0], blocks[2])


def test_sixty_degrees_of_half_power_are_the_order_one():
    assert lambertian_order(math.radians(60.0)) == pytest.approx(1.0, rel=1e-12)
    # Half as bright at 20 degrees: cos^m = 0.5.
    assert math.cos(math.radians(20.0)) ** lambertian_order(math.radians(20.0)) == pytest.approx(
        0.5
    )
