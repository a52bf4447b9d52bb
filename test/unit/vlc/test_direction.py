# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The fit of a direction: exact without noise, the best there is with it, and honest about it."""

from dataclasses import replace
import math

from hypothesis import given
from hypothesis import strategies as st
from lta_config.compilation.compiler import compile_functions
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import build_even_ring, DiodeArray
from lta_vlc.direction_fit import fit_direction
from lta_vlc.lamp import (
    build_direction_prior,
    build_fit_inputs,
    LampFinder,
    LampPrior,
    RAYLEIGH_SHARE,
)
from lta_vlc.reading_model import (
    BEND_DEVIATION,
    DirectionPrior,
    FALL_BEND,
    FALL_BEND_DEVIATION,
    FALL_DEVIATION,
    FALL_SLOPE,
    FALL_SLOPE_DEVIATION,
    FIT_SCRATCH,
    GROUND_SLOPE,
    PATTERN_DEVIATION,
    pedestal_unevenness,
    SLOPE_DEVIATION,
)
import numpy as np
import pytest
from scipy.optimize import least_squares

FAR = LampPrior(distance=50.0, distance_deviation=0.0, height_deviation=20.0)
EXACT = 3e-5  # where the fit stops, 0.002 degrees [rad]
SMALL = 0.07  # radius of the shipped ring [m]


def tetrahedral(count, spread=0.0, response=1.2):
    """Return diodes that look out at 40 degrees above and below the horizon in turn."""
    angle = 2.0 * math.pi * np.arange(count) / count
    lift = np.radians(40.0) * (-1.0) ** np.arange(count)
    axes = np.stack([np.cos(angle) * np.cos(lift), np.sin(angle) * np.cos(lift), np.sin(lift)], 1)
    axes = tuple(map(tuple, axes.tolist()))
    return DiodeArray(axes, tuple((0.0,) * 3 for _ in axes), response, (1.0,) * count, spread)


def readings(diodes, ray, strength=200.0, pedestal=40.0, distance=math.inf):
    """Return what diodes read of a small lamp, by the inverse square, in an average room."""
    axes, places = np.array(diodes.axes), np.array(diodes.places)
    way = np.array(ray) - places / distance
    away = np.linalg.norm(way, axis=1)
    cosine = np.maximum(np.einsum('ij,ij->i', axes, way) / away, 0.0)
    diffuse = pedestal + GROUND_SLOPE * pedestal_unevenness(strength, pedestal) * (
        axes @ np.array(ray)
    )
    return np.array(diodes.gains) * (strength * cosine**diodes.response / away**2 + diffuse)


def heard(amplitude, noise=1e-9):
    """Return readings with as much noise on each diode."""
    noise = np.full(amplitude.shape, noise / RAYLEIGH_SHARE)
    return Peaks(amplitude, amplitude / noise, np.full(amplitude.shape, 150.0), noise)


def ray(azimuth, elevation=0.0):
    """Return a unit vector."""
    level = math.cos(elevation)
    return level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)


def apart(a, b):
    """Return the angle from b to a, in [-pi, pi]."""
    return math.remainder(a - b, math.tau)


@pytest.mark.parametrize('elevation', [-0.6, 0.1, 0.8])
@pytest.mark.parametrize('azimuth', [-2.0, 0.3])
def test_diodes_that_look_up_and_down_tell_the_elevation(azimuth, elevation):
    diodes = tetrahedral(8)
    amplitude = readings(diodes, ray(azimuth, elevation), pedestal=0.0)
    found = LampFinder(diodes).find_direction(heard(amplitude), 6.0, FAR)
    assert apart(found.azimuth, azimuth) == pytest.approx(0.0, abs=EXACT)
    assert found.elevation == pytest.approx(elevation, abs=1e-4)


def test_a_level_ring_leaves_the_elevation_to_what_was_expected():
    diodes, prior = build_even_ring(8), LampPrior(distance=4.0, height_deviation=1.0)
    found = LampFinder(diodes).find_direction(heard(readings(diodes, ray(0.2, 0.3))), 6.0, prior)
    assert found.azimuth == pytest.approx(0.2, abs=3e-4)
    assert found.elevation == 0.0
    assert math.sqrt(found.elevation_variance) == pytest.approx(math.atan2(1.0, 4.0), rel=1e-6)


@pytest.mark.parametrize('distance', [1.5, 3.0])
def test_a_lamp_close_by_is_seen_from_where_each_diode_is(distance):
    diodes = build_even_ring(8, SMALL, 1.2)
    amplitude = readings(diodes, ray(0.3), distance=distance)
    known = LampPrior(distance=distance, distance_deviation=0.0)
    found = LampFinder(diodes).find_direction(heard(amplitude), 6.0, known)
    assert found.azimuth == pytest.approx(0.3, abs=EXACT)
    blind = replace(diodes, places=((0.0, 0.0, 0.0),) * 8)
    off = LampFinder(blind).find_direction(heard(amplitude), 6.0, known).azimuth - 0.3
    assert abs(off) > math.radians(0.2)


@pytest.mark.parametrize('spoilt', range(8))
def test_a_spoilt_diode_is_left_out(spoilt):
    diodes = build_even_ring(8, 0.0, 1.2)
    amplitude = readings(diodes, ray(0.3))
    amplitude[spoilt] = 3000.0
    peaks = heard(amplitude)
    peaks.snr[spoilt] = 0.0
    found = LampFinder(diodes).find_direction(peaks, 6.0, FAR)
    assert found.azimuth == pytest.approx(0.3, abs=1e-5)


def test_nothing_is_found_below_the_gate_or_in_even_light():
    finder = LampFinder(build_even_ring(8))
    assert finder.find_direction(heard(np.full(8, 40.0)), 6.0, FAR) is None
    dim = heard(readings(build_even_ring(8), ray(0.0)), noise=60.0)
    assert dim.snr.max() < 6.0
    assert finder.find_direction(dim, 6.0, FAR) is None
    spoilt = heard(readings(build_even_ring(8), ray(0.0)))
    spoilt.snr[:] = 0.0
    assert finder.find_direction(spoilt, 6.0, FAR) is None


ANGLES = st.floats(-math.pi, math.pi)
NOISY = st.lists(st.floats(-1.0, 1.0), min_size=8, max_size=8).map(np.array)


@given(azimuth=ANGLES, noise=NOISY, turns=st.integers(1, 7))
def test_turning_the_readings_round_the_ring_turns_the_direction(azimuth, noise, turns):
    finder = LampFinder(build_even_ring(8, SMALL, 1.2, 0.02))
    amplitude = readings(build_even_ring(8, SMALL, 1.2), ray(azimuth)) + noise
    one = finder.find_direction(heard(amplitude, 1.0), 6.0, LampPrior())
    other = finder.find_direction(heard(np.roll(amplitude, turns), 1.0), 6.0, LampPrior())
    turned = apart(other.azimuth - one.azimuth, turns * math.pi / 4.0)
    # Both stop within a step of 1e-5.
    assert turned == pytest.approx(0.0, abs=1e-5)
    assert other.azimuth_variance == pytest.approx(one.azimuth_variance, rel=1e-3)


@given(azimuth=ANGLES, noise=NOISY, order=st.permutations(range(8)))
def test_the_order_of_the_diodes_does_not_matter(azimuth, noise, order):
    diodes = tetrahedral(8, 0.02)
    amplitude = readings(diodes, ray(azimuth, 0.2)) + noise
    other = replace(diodes, axes=tuple(diodes.axes[k] for k in order))
    one = LampFinder(diodes).find_direction(heard(amplitude, 1.0), 6.0, LampPrior())
    two = LampFinder(other).find_direction(heard(amplitude[list(order)], 1.0), 6.0, LampPrior())
    assert apart(two.azimuth, one.azimuth) == pytest.approx(0.0, abs=1e-5)
    assert two.covariance == pytest.approx(one.covariance, rel=1e-3, abs=1e-7)


def independent(diodes, amplitude, noise, prior, found):
    """Return azimuth, elevation and strength by scipy, from the docstring of `readings` alone."""
    axes, places = np.array(diodes.axes), np.array(diodes.places)
    expected: DirectionPrior = build_direction_prior(prior)
    uneven = pedestal_unevenness(found.strength, found.pedestal)

    def direct(azimuth, elevation, strength, near, fall, p):
        towards = np.array(ray(azimuth, elevation))
        left = np.array([-math.sin(azimuth), math.cos(azimuth), 0.0])
        way = towards - near * places
        away = np.linalg.norm(way, axis=1)
        facing = np.maximum(np.einsum('ij,ij->i', axes, way) / away, 0.0) ** p / away**2
        return strength * facing * (1.0 + near * fall * (places @ left))

    first = (found.azimuth, found.elevation, found.strength, found.pedestal)
    mean, wide = diodes.response, diodes.response_deviation
    start = np.array([*first, *(0.0,) * 5, expected.nearness, 0.0, mean])
    typical = direct(found.azimuth, found.elevation, found.strength, expected.nearness, 0.0, mean)
    unequal = diodes.spread * (typical + found.pedestal)
    error = np.sqrt(noise**2 + unequal**2 + (PATTERN_DEVIATION * uneven) ** 2)

    def residuals(v):
        pattern = axes @ v[4:7] + v[7] * (axes[:, 0] ** 2 - axes[:, 1] ** 2)
        pattern += v[8] * 2.0 * axes[:, 0] * axes[:, 1]
        model = direct(v[0], v[1], v[2], v[9], v[10], v[11]) + v[3] + pattern
        # Harmonics along the direction and across it, over B
        turn = np.exp(-1j * v[0])
        slope = (v[4] + 1j * v[5]) * turn / uneven
        bend = (v[7] + 1j * v[8]) * turn**2 / uneven
        return np.concatenate(
            [
                (amplitude - model) / error,
                [(v[1] - expected.elevation) / expected.elevation_deviation],
                [(slope.real - GROUND_SLOPE * math.cos(v[1])) / SLOPE_DEVIATION],
                [(slope.imag - FALL_SLOPE * v[10]) / FALL_SLOPE_DEVIATION],
                [(v[6] / uneven - GROUND_SLOPE * math.sin(v[1])) / SLOPE_DEVIATION],
                [
                    bend.real / BEND_DEVIATION,
                    (bend.imag - FALL_BEND * v[10]) / FALL_BEND_DEVIATION,
                ],
                [(v[9] - expected.nearness) / expected.nearness_deviation, v[10] / FALL_DEVIATION],
                [(v[11] - mean) / wide],
            ]
        )

    return least_squares(residuals, start, x_scale=np.maximum(np.abs(start), 0.1)).x


@pytest.mark.parametrize('diodes', [build_even_ring(8, SMALL, 1.2, 0.02), tetrahedral(8, 0.02)])
@pytest.mark.parametrize('wide', [0.01, 0.3])
def test_another_solver_finds_the_same_minimum(diodes, wide):
    diodes = replace(diodes, response_deviation=wide)
    generator = np.random.default_rng(8)
    prior, differences = LampPrior(), []
    for _ in range(20):
        azimuth, elevation = generator.uniform(-3.0, 3.0), generator.normal(0.0, 0.2)
        amplitude = readings(diodes, ray(azimuth, elevation), distance=4.0)
        amplitude = amplitude * generator.normal(1.0, 0.02, 8) + generator.normal(0.0, 0.5, 8)
        found = LampFinder(diodes).find_direction(heard(amplitude, 0.5), 6.0, prior)
        other = independent(diodes, amplitude, 0.5, prior, found)
        sigma = np.sqrt(np.diag(found.covariance))
        off = [apart(other[0], found.azimuth), other[1] - found.elevation]
        differences.append(np.abs(off) / sigma)
        assert other[2] == pytest.approx(found.strength, rel=0.02)
    # The fit takes its slopes over the edge of a diode's view, and weighs by its own model.
    assert np.max(differences) < 0.4
    assert np.median(differences) < 0.05


def test_the_interval_holds_what_the_light_does_by_its_priors():
    """Rooms drawn from the priors themselves: the fit linearises, and that is all it may lose."""
    generator = np.random.default_rng(12)
    diodes, prior = build_even_ring(8, SMALL, 1.2, 0.02), LampPrior()
    diodes = replace(diodes, response_deviation=0.3)
    expected, axes = build_direction_prior(prior), np.array(diodes.axes)
    finder = LampFinder(diodes)
    inside, trials = 0, 2000
    for _ in range(trials):
        azimuth = generator.uniform(-math.pi, math.pi)
        near = max(expected.nearness + expected.nearness_deviation * generator.normal(), 0.02)
        true = replace(diodes, response=max(generator.normal(1.2, 0.3), 0.3))
        amplitude = readings(true, ray(azimuth), distance=1.0 / near, pedestal=0.0)
        left = np.array([-math.sin(azimuth), math.cos(azimuth), 0.0])
        fall = FALL_DEVIATION * generator.normal()
        amplitude *= 1.0 + near * fall * (np.array(diodes.places) @ left)
        uneven = pedestal_unevenness(200.0, 40.0)
        draw = generator.standard_normal(4)
        slope = (
            GROUND_SLOPE
            + SLOPE_DEVIATION * draw[0]
            + 1j * (FALL_SLOPE * fall + FALL_SLOPE_DEVIATION * draw[1])
        )
        bend = BEND_DEVIATION * draw[2] + 1j * (FALL_BEND * fall + FALL_BEND_DEVIATION * draw[3])
        # A harmonic h along the direction and across it reads Re(h conj(n)) at the axis n
        axis = (axes[:, 0] + 1j * axes[:, 1]) * np.exp(-1j * azimuth)
        pattern = (slope * axis.conj()).real + (bend * axis.conj() ** 2).real
        pattern += PATTERN_DEVIATION * generator.standard_normal(8)
        amplitude = (amplitude + 40.0 + uneven * pattern) * generator.normal(1.0, 0.02, 8)
        found = finder.find_direction(
            heard(np.abs(amplitude + generator.normal(0, 0.5, 8)), 0.5), 6.0, prior
        )
        inside += abs(apart(found.azimuth, azimuth)) < 1.96 * math.sqrt(found.azimuth_variance)
    # 2000 trials know a share of 95 % to 0.5 %; linearising loses a little.
    assert inside / trials == pytest.approx(0.95, abs=0.015)


@pytest.mark.parametrize('count', [4, 8, 16])
def test_compiled_it_is_the_same_to_the_last_bit(count):
    """With readings that follow the model, and with some that follow none."""
    generator = np.random.default_rng(count)
    diodes = build_even_ring(count, SMALL, 1.2, 0.02)
    prior = build_direction_prior(LampPrior())
    compiled = compile_functions(fit_direction)[0]
    for k in range(200):
        truth = readings(diodes, ray(generator.uniform(-3.1, 3.1)), distance=3.0)
        read = np.abs(truth + generator.normal(0.0, 2.0 + k % 100, count))
        errors = np.full(count, 1.6)
        errors[generator.integers(count)] = math.inf
        plain = fit_direction(
            build_fit_inputs(diodes), prior, read.tolist(), errors.tolist(), [0.0] * FIT_SCRATCH
        )
        array, scratch = build_fit_inputs(diodes, np.array), np.zeros(FIT_SCRATCH)
        assert compiled(array, prior, read, errors, scratch) == plain


def test_readings_that_follow_no_model_widen_the_interval():
    """A lamp half behind the hull: a diode that should be lit reads as if it looked away."""
    diodes = build_even_ring(8, SMALL, 1.2, 0.02)
    amplitude = readings(diodes, ray(0.3), distance=4.0)
    whole = LampFinder(diodes).find_direction(heard(amplitude, 0.5), 6.0, LampPrior())
    amplitude[0] = amplitude[4]
    shaded = LampFinder(diodes).find_direction(heard(amplitude, 0.5), 6.0, LampPrior())
    assert whole.azimuth == pytest.approx(0.3, abs=0.02)
    assert shaded.azimuth_variance > 4.0 * whole.azimuth_variance
