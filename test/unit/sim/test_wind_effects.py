# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Steady wind, profile, gradient, gust and turbulence by hand, quadrature and spectra."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_model.effects.air import GUSTS, TURBULENCE, WIND_GRADIENT, WIND_PROFILE
from lta_model.effects.protocol import AirEffectInput
from lta_model.scenario_air import low_altitude_turbulence, sheared_turbulence
from lta_model.state import NOISE
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_continuous_lyapunov

CALM = (0.0,) * 3
NO_AIR = (0.0,) * 6


def at(x=0.0, y=0.0, z=0.0, velocity=CALM, wind=CALM):
    return AirEffectInput((x, y, z), velocity, wind, (0.0,) * 8)


# 8 m/s from west to east at 10 m over 0.3 m, as the seed paper's outdoor flight is read.
OUTDOORS = (8.0, 0.0, 10.0, 0.3)


def test_profile_at_half_a_metre_as_the_paper_is_read():
    wind = WIND_PROFILE.air((*OUTDOORS, 0.0), (), at(z=0.5))
    assert wind[0] == pytest.approx(8.0 * math.log(0.5 / 0.3) / math.log(10.0 / 0.3), rel=1e-14)
    assert round(wind[0], 1) == 1.2
    assert wind[1:] == (0.0,) * 5
    assert WIND_PROFILE.air((*OUTDOORS, 0.0), (), at(z=10.0))[0] == pytest.approx(8.0, rel=1e-14)


def quadrature(z, half):
    def speed(height):
        return max(0.0, math.log(height / 0.3)) if height > 0.0 else 0.0

    area, _ = quad(speed, z - half, z + half, points=[0.3], epsabs=1e-13)
    return 8.0 * area / (2.0 * half * math.log(10.0 / 0.3))


@pytest.mark.parametrize('z', [0.1, 0.5, 0.599, 0.601, 1.0, 10.0])
@pytest.mark.parametrize('half', [0.05, 0.3])
def test_profile_is_the_mean_over_the_hull(z, half):
    wind = WIND_PROFILE.air((*OUTDOORS, half), (), at(z=z))
    assert wind[0] == pytest.approx(quadrature(z, half), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(('height', 'roughness'), [(10.0, 0.0), (0.3, 0.3), (0.2, 0.3)])
def test_profile_without_ground_or_reference_above_it_is_no_wind(height, roughness):
    """Its logarithm would be of nothing, or turn the wind round."""
    assert WIND_PROFILE.air((3.0, -4.0, height, roughness, 0.3), (), at(z=2.0)) == NO_AIR


@given(z=st.floats(-1.0, 20.0), half=st.sampled_from([0.0, 0.01, 0.3]))
def test_profile_has_no_step(z, half):
    p, step = (8.0, 0.0, 10.0, 0.3, half), 1e-7
    one, two = (
        WIND_PROFILE.air(p, (), at(z=z)),
        WIND_PROFILE.air(p, (), at(z=z + step)),
    )
    # The steepest slope is that of the log at the roughness length: 8 / ln(10 / 0.3) / 0.3.
    assert abs(two[0] - one[0]) <= 7.7 * step
    # The integral cancels at a thin hull: 1e-16 of 100 m over 0.02 m.
    assert two[0] >= one[0] - 1e-12


@pytest.mark.parametrize('z', [0.2, 0.45, 1.0, 5.0])
@pytest.mark.parametrize('half', [0.0, 0.3])
def test_air_that_rises_through_the_profile_speeds_up(z, half):
    p, w, step = (8.0, -3.0, 10.0, 0.3, half), 0.7, 1e-5
    air = WIND_PROFILE.air(p, (), at(z=z, wind=(0.0, 0.0, w)))
    above = np.array(WIND_PROFILE.air(p, (), at(z=z + step)))
    below = np.array(WIND_PROFILE.air(p, (), at(z=z - step)))
    rise = w * (above - below)[:3] / (2.0 * step)
    np.testing.assert_allclose(air[3:], rise, rtol=1e-7, atol=1e-9)


def test_profile_without_ground_is_refused():
    named = dict(zip(('x', 'y', 'height', 'roughness'), OUTDOORS, strict=True))
    assert WIND_PROFILE.check(named) == ''
    assert 'roughness' in WIND_PROFILE.check({**named, 'roughness': 0.0})
    assert 'height' in WIND_PROFILE.check({**named, 'height': 0.2})
    assert WIND_PROFILE.check({'x': 0.0, 'y': 0.0, 'height': 10.0, 'roughness': 0.0}) == ''


G = np.array([[0.3, -0.2, 0.1], [0.5, -0.1, 0.7], [-0.4, 0.6, -0.2]])
CURRENT = (1.0, 2.0, 3.0, *G.ravel()[:8].tolist())


def test_gradient_keeps_the_volume_of_the_air():
    def flow(place):
        return np.array(WIND_GRADIENT.air(CURRENT, (), at(*place.tolist()))[:3])

    edges = np.eye(3)
    rise = sum((flow(edge) - flow(-edge))[i] for i, edge in enumerate(edges))
    assert rise == pytest.approx(0.0, abs=1e-14)


def test_air_follows_its_own_acceleration():
    """A parcel carried along for a moment has changed its velocity by DU/Dt."""
    place, step = np.array([0.3, -0.8, 1.1]), 1e-6
    air = np.array(WIND_GRADIENT.air(CURRENT, (), at(*place.tolist())))
    later = np.array(WIND_GRADIENT.air(CURRENT, (), at(*(place + step * air[:3]).tolist())))
    np.testing.assert_allclose((later - air)[:3] / step, air[3:], rtol=1e-7)


GUST = (2.0, -1.0, 0.5, 3.0, 0.8, 1.5)  # begins at 3 s, rises in 0.8 s, stands for 1.5 s


def gust(time):
    return np.array(GUSTS.air(GUST, (time,), at()))


def test_gust_rises_stands_and_falls():
    full = np.array(GUST[:3])
    for time, share in [(0.0, 0.0), (3.0, 0.0), (3.4, 0.5), (3.8, 1.0), (5.0, 1.0), (5.7, 0.5)]:
        np.testing.assert_allclose(gust(time)[:3], share * full, atol=1e-14)
    assert not gust(6.11).any()
    assert not gust(1e4).any()
    # A quarter of the way of the cosine: (1 - cos 45 deg) / 2.
    assert gust(3.2)[0] == pytest.approx(1.0 - math.sqrt(0.5), rel=1e-12)


@given(time=st.floats(2.5, 7.0))
def test_gust_accelerates_as_it_changes(time):
    step = 1e-6
    slope = (gust(time + step) - gust(time - step))[:3] / (2.0 * step)
    # The slope has a kink where the gust begins and ends: half a step of its second derivative.
    kink = 2.0 * 0.5 * (math.pi / 0.8) ** 2 * step
    np.testing.assert_allclose(gust(time)[3:], slope, atol=kink)


def test_gust_without_a_length_is_refused_and_blows_nothing():
    named = {'x': 1.0, 'y': 0.0, 'z': 0.0, 'length': 0.0}
    assert 'length' in GUSTS.check(named)
    assert GUSTS.check({**named, 'length': 0.5}) == ''
    assert GUSTS.air((1.0, 0.0, 0.0, 0.0, 0.0, 5.0), (1.0,), at()) == NO_AIR


def test_military_turbulence_by_hand():
    # At 100 ft, 0.177 + 0.0823 = 0.2593; 30 knots are 15.43 m/s.
    found = low_altitude_turbulence(30.48, 15.43)
    assert found['up'] == pytest.approx(1.543)
    assert found['along'] == found['across'] == pytest.approx(1.543 / 0.2593**0.4, rel=1e-12)
    assert found['along_length'] == pytest.approx(30.48 / 0.2593**1.2, rel=1e-12)
    assert found['up_length'] == 30.48
    sheared = sheared_turbulence(lambda _: 15.43)
    assert list(sheared) == [parameter.name for parameter in TURBULENCE.parameters]
    assert [*found, 'mean', 'height'] == list(sheared)
    # What the seed paper's wind would be at 6.1 m, and at half a metre if it reached there.
    speed = WIND_PROFILE.air((*OUTDOORS, 0.0), (), at(z=6.096))[0]
    assert round(0.1 * speed / (0.177 + 0.000823 * 0.5 / 0.3048) ** 0.4, 1) == 1.4
    # At 1000 ft it is isotropic: 0.177 + 0.823 = 1.
    top = low_altitude_turbulence(304.8, 10.0)
    assert top['along'] == pytest.approx(top['up'], rel=1e-12)
    assert top['along_length'] == pytest.approx(304.8, rel=1e-12)


# Intensities and lengths: along, across, up.
SIGMA, LENGTH = (0.3, 0.25, 0.2), (1.0, 0.8, 0.6)
P = (*SIGMA, *LENGTH, 0.0, 0.0)  # the same at all heights
SPEEDS = (2.0, 0.8)
STATES = 5


def place(speed, noise=CALM, wind=CALM):
    """Return a place at which the vehicle meets the mean wind at that speed, along x."""
    surroundings = [0.0] * 8
    surroundings[NOISE : NOISE + 3] = noise
    return AirEffectInput(CALM, (wind[0] + speed, wind[1], wind[2]), wind, tuple(surroundings))


def unit(count, i):
    return tuple(float(j == i) for j in range(count))


def filters(speed, p=P):
    """Return A, B and C of the linear filters, from the effect itself."""
    rest = (0.0,) * STATES
    a = [TURBULENCE.rate(p, unit(STATES, i), place(speed)) for i in range(STATES)]
    b = [TURBULENCE.rate(p, rest, place(speed, unit(3, i))) for i in range(3)]
    c = [TURBULENCE.air(p, unit(STATES, i), place(speed))[:3] for i in range(STATES)]
    return np.transpose(a), np.transpose(b), np.transpose(c)


def military(axis, omega, speed):
    """Return the one-sided spectrum of MIL-F-8785C over angular frequency [m2/s2 per rad/s]."""
    sigma, length = SIGMA[axis], LENGTH[axis]
    x = (length * omega / speed) ** 2
    if axis == 0:
        return sigma**2 * 2.0 * length / (math.pi * speed) / (1.0 + x)
    return sigma**2 * length / (math.pi * speed) * (1.0 + 3.0 * x) / (1.0 + x) ** 2


@pytest.mark.parametrize('speed', SPEEDS)
@pytest.mark.parametrize('axis', [0, 1, 2])
def test_filters_have_the_published_spectrum(axis, speed):
    a, b, c = filters(speed)
    for omega in (1e-3, 0.1, 1.0, 3.0, 10.0, 300.0):
        gain = c @ np.linalg.solve(1j * omega * np.eye(STATES) - a, b)
        # White noise of unit intensity: 1 per Hz on both sides, 1 / pi per rad/s on one.
        spectrum = abs(gain[axis, axis]) ** 2 / math.pi
        assert spectrum == pytest.approx(military(axis, omega, speed), rel=1e-12)
        assert not np.any(gain[axis, np.arange(3) != axis])


@pytest.mark.parametrize('speed', [*SPEEDS, 0.0])
def test_filters_have_the_intensity_at_any_speed(speed):
    a, b, c = filters(speed)
    variance = c @ solve_continuous_lyapunov(a, -b @ b.T) @ c.T
    np.testing.assert_allclose(np.diag(variance), np.square(SIGMA), rtol=1e-12)


PERIOD = 0.05  # s


@pytest.mark.parametrize(
    ('wind', 'height', 'strong', 'long'),
    [(1.5, 1.0, 0.5, 0.5), (3.0, 2.0, 1.0, 1.0), (9.0, 9.0, 1.0, 1.0), (0.3, 0.0, 0.1, 0.05)],
)
def test_near_the_ground_rms_follows_the_mean_wind_and_length_the_height(
    wind, height, strong, long
):
    p, memory = (*SIGMA, *LENGTH, 3.0, 2.0), (1.0, 0.0, 0.0, 0.0, 0.0)
    here = place(1.0, wind=(wind, 0.0, 0.0))._replace(position=(0.0, 0.0, height))
    air = TURBULENCE.air(p, memory, here)
    assert air[:3] == pytest.approx((strong * SIGMA[0], 0.0, 0.0))
    # Rate of the filter along: V / L, or sigma / L if that is faster
    rate = TURBULENCE.rate(p, memory, here)[0]
    assert -rate == pytest.approx(max(1.0, strong * SIGMA[0]) / (long * LENGTH[0]))


def test_turbulence_without_a_length_is_refused():
    named = dict(zip((parameter.name for parameter in TURBULENCE.parameters), P, strict=True))
    assert TURBULENCE.check(named) == ''
    assert 'across_length' in TURBULENCE.check({**named, 'across_length': 0.0})
    assert TURBULENCE.rate((0.0,) * 8, (0.0,) * STATES, place(1.0)) == (0.0,) * STATES
