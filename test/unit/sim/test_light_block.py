# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Blocks of counts: levels by hand, noise by theory, the filter by a fine simulation."""

import math

from lta_model.light.field import Albedo, Ambient, LightField, PlaneIlluminance, Room
from lta_model.light.lamp import BeaconLamp, SquareWave
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_vlc.demodulation import demodulate_beacon, plan_bins
from lta_vlc.diodes import build_even_ring
from lta_vlc.lamp import estimate_bearing
from lta_vlc.settings import DemodulationSettings
import numpy as np
import pytest

from .diode_noise import noise_volts
from .even_light import illuminance, synthesise

START = 1_763_000_000_000_000_000
STEP = 3.3 / 4096
SUN, LED = 105.0, 300.0  # lm/W
# Responsivity of the OPT101 averaged over sunlight and over white LED light [A/W]
IN_SUN, IN_LED = 0.316064, 0.373978


def ring(**given) -> PhotodiodeArray:
    """Return a ring of eight photodiodes, with other numbers where given."""
    usual = {'count': 8, 'depth': 0.33, 'radius': 0.05, 'feedback_resistance': 1e5}
    return PhotodiodeArray(**{**usual, **given})


SILENT = ring(feedback_resistance=1e6, noise=0.0, count=1)
DARK = Ambient(SUN)


def scene(ambient: Ambient = DARK, frequency: float = 150.0) -> LightField:
    """Return the shared scene's lamp, 7 m from the origin."""
    lamp = BeaconLamp((7.0, 0.0, 1.0), (-1.0, 0.0, 0.0), 10_000.0, SquareWave(frequency), LED)
    return LightField((lamp,), ambient)


def light(modulated, steady=0.0, mains=0.0) -> PlaneIlluminance:
    """Return given light on one diode at given instants."""
    column = np.array(modulated, dtype=float)[:, None]
    return PlaneIlluminance(
        column[None], np.full_like(column, steady), np.full_like(column, mains)
    )


def generator(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_levels_by_hand():
    # 78.22 lx: 0.507 V and the dark 7.5 mV: 514.5 mV / 0.80566 mV = 638.6; dark alone 9.3.
    block, _ = synthesise(SILENT, scene(), light([78.215]), START, 1e4, 1000, generator())
    assert block.shape == (1000, 1)
    assert block.dtype == np.uint16
    assert block.flags.c_contiguous
    # Each of the 30 edges is caught on its slope by one sample at most, shot noise tips 638.6.
    assert np.isin(block, [9, 638, 639]).sum() >= 970
    assert (block == 639).sum() > (block == 638).sum() > 0
    assert block.min() == 9
    assert block.max() == 639


def test_steady_light_by_hand():
    # 142.377 lx of sun at 1 Mohm: 2.22857 V + 0.0075 V is step 2775.4; shot noise 0.13 mV.
    quiet, _ = synthesise(
        SILENT, scene(), light([0.0], steady=142.377), START, 1e4, 1000, generator()
    )
    assert np.abs(quiet.astype(int) - 2775).max() <= 1
    assert quiet.mean() == pytest.approx(2775.4, abs=0.25)


def test_mains_by_hand():
    # 361 lx of LED with 240.66 lx of flicker: 0.156 V either side, a sine of 193.6 counts.
    array = ring(feedback_resistance=1e5, noise=0.0, count=1)
    field = scene(Ambient(LED, 361.0, 240.66, mains_frequency=120.0))
    block, _ = synthesise(array, field, light([0.0], 361.0, 240.66), 0, 1e4, 1000, generator())
    peaks = demodulate_beacon(block, plan_bins(DemodulationSettings(frequency=120.0), 1e4, 1000))
    assert peaks.amplitude[0] == pytest.approx(0.156 / STEP, abs=0.1)
    assert peaks.frequency[0] == pytest.approx(120.0, abs=1e-3)
    # It rises from its mean, 0.234 + 0.0075 V; one sample is a step of 14.6 counts.
    assert block[0, 0] == pytest.approx(0.2415 / STEP, abs=1.0)
    assert block[1, 0] == pytest.approx(0.2415 / STEP + 14.6, abs=1.0)


def test_a_lux_of_sun_is_worth_more_than_one_of_a_led():
    def mean(efficacy):
        field, lit = scene(Ambient(efficacy)), light([0.0], 100.0)
        block, _ = synthesise(SILENT, field, lit, START, 1e4, 1000, generator())
        return block.mean() - 7.5e-3 / STEP

    worth = LED / SUN * IN_SUN / IN_LED
    assert mean(SUN) / mean(LED) == pytest.approx(worth, rel=1e-3)


def test_saturation_clips_at_full_scale():
    block, _ = synthesise(SILENT, scene(), light([600.0]), START, 1e4, 1000, generator())
    assert block.max() == 4095
    assert 490 <= (block == 4095).sum() <= 510
    flooded, _ = synthesise(SILENT, scene(), light([0.0], 1e5), START, 1e4, 1000, generator())
    assert (flooded == 4095).all()
    # An amplifier on 3.3 V ends at 2.15 V.
    weak = ring(feedback_resistance=1e6, noise=0.0, count=1, output_limit=2.15)
    flooded, _ = synthesise(weak, scene(), light([0.0], 1e5), START, 1e4, 1000, generator())
    assert (flooded == 2669).all()


def test_noise_never_goes_below_zero_counts():
    noisy = ring(dark_offset=0.0, noise=0.01, feedback_resistance=1e6, count=1)
    block, _ = synthesise(noisy, scene(), light([0.0]), START, 1e4, 1000, generator())
    # 10 mV is 12.4 steps: half of the samples stand at the bottom.
    assert (block == 0).mean() == pytest.approx(0.5, abs=0.07)
    assert block.max() < 60


@pytest.mark.parametrize(
    ('resistance', 'noise', 'lux'),
    [(1e6, 3e-3, 0.0), (1e5, 0.0, 1000.0), (1e6, 3e-3, 100.0)],
)
def test_variance_is_the_theorys(resistance, noise, lux):
    # Sixteen bits resolve the shot noise; the offset keeps clear of zero.
    array = ring(feedback_resistance=resistance, noise=noise, adc_bits=16, dark_offset=0.5)
    lit = PlaneIlluminance(np.zeros((1, 1, 8)), np.full((1, 8), lux), np.zeros((1, 8)))
    block, _ = synthesise(array, scene(), lit, START, 1e4, 10_000, generator(4))
    step = 3.3 / 65_536
    volts = lux / SUN * 5.2e-6 * IN_SUN * resistance
    theory = noise_volts(array, volts) ** 2 + step**2 / 12.0
    # 80 000 samples know a variance to 0.5 %.
    assert block.astype(float).var(axis=0).mean() * step**2 == pytest.approx(theory, rel=0.02)


def test_noise_is_as_correlated_as_the_pole_makes_it():
    # A pole at 500 Hz keeps exp(-2 pi 0.05) = 0.7304 from sample to sample.
    slow = ring(bandwidth=500.0, noise=0.03, feedback_resistance=1e6, dark_offset=0.5)
    dark = PlaneIlluminance(np.zeros((1, 1, 8)), np.zeros((1, 8)), np.zeros((1, 8)))
    state, blocks = None, []
    for k in range(20):
        block, state = synthesise(
            slow, scene(), dark, START + k * 100_000_000, 1e4, 1000, generator(k), state
        )
        blocks.append(block)
    counts = np.concatenate(blocks)[1000:].astype(float)
    counts -= counts.mean(axis=0)
    variance = (counts**2).mean()
    # The start is without noise; a pole of 3 samples has forgotten it after a block.
    assert math.sqrt(variance) * STEP == pytest.approx(0.03, rel=0.02)
    following = (counts[1:] * counts[:-1]).mean() / variance
    assert following == pytest.approx(math.exp(-0.1 * math.pi), abs=0.01)


@pytest.mark.parametrize('bandwidth', [14e3, 300.0])
def test_two_blocks_are_one(bandwidth):
    array = ring(bandwidth=bandwidth, noise=1e-3, feedback_resistance=1e6, adc_bits=16)
    bright = PlaneIlluminance(
        np.linspace(20.0, 90.0, 11 * 8).reshape(1, 11, 8), np.full((11, 8), 9.0), np.ones((11, 8))
    )
    field = scene(Ambient(LED, 9.0, 1.0))
    first = PlaneIlluminance(bright.modulated[:, :6], bright.steady[:6], bright.mains[:6])
    second = PlaneIlluminance(bright.modulated[:, 5:], bright.steady[5:], bright.mains[5:])
    whole, end = synthesise(array, field, bright, START, 1e4, 1000, generator())
    draws = generator()
    head, middle = synthesise(array, field, first, START, 1e4, 500, draws)
    tail, last = synthesise(array, field, second, START + 50_000_000, 1e4, 500, draws, middle)
    # The light of the sample at the seam comes from the same instant in both.
    assert np.array_equal(np.concatenate([head, tail]), whole)
    assert last.volts == pytest.approx(end.volts, rel=1e-12)


def test_first_block_starts_in_the_middle_of_the_flicker():
    # A pole of 5 ms, near the lamp's period: after a block it has forgotten how it started.
    slow = ring(bandwidth=30.0, noise=0.0, feedback_resistance=1e6, count=1)
    before = START - 100_000_000
    _, state = synthesise(slow, scene(), light([65.0], 20.0), before, 1e4, 1000, generator())
    running, _ = synthesise(
        slow, scene(), light([65.0], 20.0), START, 1e4, 1000, generator(), state
    )
    fresh, _ = synthesise(slow, scene(), light([65.0], 20.0), START, 1e4, 1000, generator())
    assert np.abs(fresh.astype(int) - running).max() <= 1


def test_light_between_the_instants_is_linear():
    array = ring(feedback_resistance=1e6, noise=0.0, adc_bits=16, count=1)
    ramp = PlaneIlluminance(
        np.zeros((1, 3, 1)), np.array([[10.0], [50.0], [30.0]]), np.zeros((3, 1))
    )
    block, _ = synthesise(array, scene(), ramp, START, 1e4, 1000, generator())
    lux = (block[:, 0] * (3.3 / 65_536) - 7.5e-3) / 15.65271e-3
    assert lux[[0, 250, 500, 750, 999]] == pytest.approx([10.0, 30.0, 50.0, 40.0, 30.04], abs=0.1)


def pose(distance: float, yaw: float):
    """Return the diodes' places and axes at a distance before the lamp, in its height."""
    turn = np.array(
        [
            [math.cos(yaw), -math.sin(yaw), 0.0],
            [math.sin(yaw), math.cos(yaw), 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
    array = ring()
    return array.transform_to_map(np.array([7.0 - distance, 0.0, 1.0 + array.depth]), turn)


@pytest.mark.parametrize('room', [None, Room((10.0, 8.0, 3.0), Albedo(0.5, 0.5, 0.5))])
@pytest.mark.parametrize('yaw', [0.0, 0.4, 2.0, -3.0])
def test_lamp_is_heard_and_found_at_seven_metres(room, yaw):
    lamp = scene().first_lamp
    field = LightField((lamp,), Ambient(LED, steady=300.0, mains=30.0), room)
    here = illuminance(field, *pose(7.0, yaw))
    lit = PlaneIlluminance(here.modulated[:, None], here.steady[None], here.mains[None])
    block, _ = synthesise(ring(), field, lit, START, 1e4, 1000, generator(8))
    peaks = demodulate_beacon(block, plan_bins(DemodulationSettings(), 1e4, 1000))
    assert peaks.snr.max() > 10.0
    found = estimate_bearing(peaks, build_even_ring(8).ring, DemodulationSettings().threshold)
    # A ring of 5 cm sees 7 m with 0.4 % less light behind: under 0.2 degrees.
    assert math.remainder(found.angle + yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=0.02)


def test_amplitude_at_seven_metres_by_hand():
    field = scene()
    here = illuminance(field, *pose(7.0, 0.0))
    lit = PlaneIlluminance(here.modulated[:, None], here.steady[None], here.mains[None])
    block, _ = synthesise(ring(), field, lit, START, 1e4, 1000, generator(8))
    peaks = demodulate_beacon(block, plan_bins(DemodulationSettings(), 1e4, 1000))
    # The forward diode is at 6.95 m: 65.90 lx x 0.64823 mV/lx x 2/pi / 0.80566 mV = 33.75.
    assert peaks.amplitude[0] == pytest.approx(33.75, abs=0.1)
    assert peaks.amplitude[[1, 7]] == pytest.approx([23.7, 23.7], abs=0.3)
    assert peaks.amplitude[[3, 4, 5]].max() < 0.1
