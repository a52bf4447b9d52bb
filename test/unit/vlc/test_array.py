# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The paper's bearing: exact where it must be, wrong where the paper's study needs it wrong."""

import math

from lta_model.sensors.photodiode import DiodeRing, spread_azimuths
from lta_vlc.demodulation import demodulate_beacon, Peaks, plan_bins
from lta_vlc.diodes import build_even_ring
from lta_vlc.lamp import estimate_bearing, weighted_mean_bearing
from lta_vlc.settings import DemodulationSettings
import numba
import numpy as np
import pytest

SURE = 1e6  # an SNR that passes every gate


def seen(count: int, angle: float, response) -> Peaks:
    """Return the peaks of a ring that sees a lamp at an angle through an angular response."""
    towards = np.cos(np.array(spread_azimuths(count)) - angle)
    amplitude = response(np.maximum(towards, 0.0))
    return Peaks(
        amplitude, np.where(amplitude > 1e-12, SURE, 0.0), np.full(count, 150.0), np.ones(count)
    )


def difference(a: float, b: float) -> float:
    """Return the angle from b to a, in [-pi, pi]."""
    return math.remainder(a - b, 2.0 * math.pi)


@pytest.mark.parametrize('count', [4, 6, 8, 16])
@pytest.mark.parametrize('angle', np.radians(np.arange(-180.0, 180.0, 7.5)).tolist())
def test_cosine_diodes_are_exact_at_every_angle(count, angle):
    found = estimate_bearing(seen(count, angle, lambda c: c), build_even_ring(count).ring, 6.0)
    assert difference(found.angle, angle) == pytest.approx(0.0, abs=1e-12)


def test_squared_cosine_with_four_diodes_errs_as_computed():
    angle = math.radians(22.5)
    found = estimate_bearing(seen(4, angle, np.square), build_even_ring(4).ring, 6.0)
    # atan(tan^2 22.5) = 9.736 degrees.
    assert math.degrees(found.angle) == pytest.approx(9.7356, abs=1e-4)


def test_vector_by_hand():
    # Four diodes reading 3, 1, 0, 0: v = (3, 1) / 4.
    ring = build_even_ring(4).ring
    peaks = Peaks(
        np.array([3.0, 1.0, 0.5, 0.5]), np.array([9.0, 6.0, 5.9, 0.0]), np.zeros(4), np.ones(4)
    )
    found = estimate_bearing(peaks, ring, 6.0)
    assert (found.x, found.y) == pytest.approx((0.75, 0.25), abs=1e-15)
    assert found.angle == pytest.approx(math.atan2(1.0, 3.0), abs=1e-15)


def test_deviation_by_hand():
    # Readings 1 and 1 forward and left with SNR 10; the gated diode behind reads 0.1.
    ring = DiodeRing((1.0, 0.0, -1.0), (0.0, 1.0, 0.0))
    peaks = Peaks(np.array([1.0, 1.0, 0.1]), np.array([10.0, 10.0, 1.0]), np.zeros(3), np.ones(3))
    # Length sqrt(2), all axes at 45 degrees to it: each adds (error / 2)^2.
    each = 0.1 * math.sqrt(2.0 / math.pi)
    hand = 0.5 * math.sqrt(2.0 * each**2 + 0.1**2)
    assert estimate_bearing(peaks, ring, 6.0).deviation == pytest.approx(hand, rel=1e-12)


def test_no_bearing_when_every_diode_is_gated():
    peaks = Peaks(np.ones(8), np.full(8, 5.99), np.zeros(8), np.ones(8))
    assert estimate_bearing(peaks, build_even_ring(8).ring, 6.0) is None


@pytest.mark.parametrize('level', [0.0, 1e-300, 1.0, 4095.0])
@pytest.mark.parametrize('count', [4, 8, 16])
def test_no_bearing_in_even_light(level, count):
    peaks = Peaks(np.full(count, level), np.full(count, SURE), np.zeros(count), np.ones(count))
    assert estimate_bearing(peaks, build_even_ring(count).ring, 6.0) is None


def test_core_compiles_to_the_same_numbers():
    compiled = numba.njit(weighted_mean_bearing)
    generator = np.random.default_rng(7)
    ring = build_even_ring(8).ring
    for _ in range(50):
        amplitudes = tuple(generator.uniform(0.0, 100.0, 8).tolist())
        snrs = tuple(generator.uniform(0.0, 12.0, 8).tolist())
        given = (amplitudes, snrs, ring.cosines, ring.sines, 6.0)
        # LLVM may round atan2 and hypot otherwise than the C library: in the last bit.
        assert compiled(*given) == pytest.approx(
            weighted_mean_bearing(*given), rel=1e-14, abs=1e-300
        )
    silent = ((1.0,) * 8, (0.0,) * 8, ring.cosines, ring.sines, 6.0)
    assert compiled(*silent) == weighted_mean_bearing(*silent) == (False, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(('amplitude', 'pedestal'), [(40.0, 30.0), (30.0, 0.0), (200.0, 120.0)])
def test_deviation_is_that_of_many_noisy_blocks(amplitude, pedestal):
    generator = np.random.default_rng(21)
    ring, angle, trials = build_even_ring(8).ring, 0.3, 1000
    towards = np.maximum(np.cos(np.array(spread_azimuths(8)) - angle), 0.0)
    time = np.arange(250) / 2500.0
    tone = np.sin(2.0 * math.pi * 150.0 * time)
    signal = tone[:, None] * (amplitude * towards + pedestal)
    noise = generator.normal(0.0, 20.0, size=(250, trials, 8))
    bins = plan_bins(DemodulationSettings(), 2500.0, 250)
    peaks = demodulate_beacon((signal[:, None, :] + noise).reshape(250, -1), bins)
    errors, stated = [], []
    for k in range(trials):
        part = slice(8 * k, 8 * k + 8)
        each = Peaks(
            peaks.amplitude[part], peaks.snr[part], peaks.frequency[part], peaks.noise[part]
        )
        found = estimate_bearing(each, ring, 6.0)
        errors.append(difference(found.angle, angle))
        stated.append(found.deviation)
    if pedestal:
        # All diodes pass: noise is all there is. 1000 trials know a deviation to 2.2 %.
        assert np.std(errors) == pytest.approx(np.mean(stated), rel=0.10)
        assert abs(np.mean(errors)) < 0.15 * np.std(errors)
    inside = np.mean(np.abs(errors) < 1.96 * np.array(stated))
    assert 0.93 <= inside <= (0.97 if pedestal else 1.0)
