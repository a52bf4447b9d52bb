"""Dryden turbulence against the published spectra: the filters and their variance."""

import math

from lta_model.effects.air import TURBULENCE
from lta_model.effects.protocol import AirEffectInput
from lta_model.state import NOISE
import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

CALM = (0.0,) * 3
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
    """Return the one-sided spectrum of MIL-F-8785C over angular frequency. [m2/s2 per rad/s]"""
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


def test_an_eddy_that_goes_along_turns_over():
    a, _, _ = filters(0.0)
    assert a[0, 0] == -SIGMA[0] / LENGTH[0]
    a, _, _ = filters(0.31)
    assert a[0, 0] == -0.31 / LENGTH[0]


PERIOD = 0.05  # s


def runge_kutta(memory, noise, speed):
    """Return the memory after one control period with the noise held."""

    def slope(state):
        return np.array(TURBULENCE.rate(P, tuple(state.tolist()), where))

    where = place(speed, noise)
    one = slope(memory)
    two = slope(memory + 0.5 * PERIOD * one)
    three = slope(memory + 0.5 * PERIOD * two)
    four = slope(memory + PERIOD * three)
    return memory + PERIOD / 6.0 * (one + 2.0 * two + 2.0 * three + four)


def test_along_is_the_way_of_the_mean_wind():
    memory = (1.0, 0.0, 0.0, 0.0, 0.0)
    air = TURBULENCE.air(P, memory, place(0.0, wind=(0.0, -2.0, 0.1)))
    np.testing.assert_allclose(air, (0.0, -0.3, 0.0, 0.0, 0.0, 0.0), atol=1e-16)
    side = TURBULENCE.air(P, (0.0, 0.0, 1.0, 0.0, 0.0), place(0.0, wind=(0.0, -2.0, 0.1)))
    np.testing.assert_allclose(side[:2], (0.25 * (1.0 - math.sqrt(3.0)), 0.0), atol=1e-16)
    # In still air, along is x. Frozen turbulence: the acceleration of the air is zero.
    assert TURBULENCE.air(P, memory, place(1.0)) == (0.3, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Below 1 mm/s the mean wind counts as still.
    for north, turned in ((0.9e-3, False), (1.1e-3, True)):
        head = TURBULENCE.air(P, memory, place(0.0, wind=(0.0, north, 0.0)))
        assert head[:2] == pytest.approx((0.0, 0.3) if turned else (0.3, 0.0))


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


def test_held_noise_keeps_the_variance_that_is_stated():
    """The docstring's tanh: the stationary variance of the first order, exactly discretised."""
    ratio = PERIOD * SPEEDS[0] / LENGTH[0]
    decay = math.exp(-ratio)
    exact = 2.0 / ratio * (1.0 - decay) ** 2 / (1.0 - decay**2)
    assert exact == pytest.approx(2.0 / ratio * math.tanh(0.5 * ratio), rel=1e-12)
    move, _ = runge_kutta(np.eye(STATES)[0], CALM, SPEEDS[0])[0], None
    drive = runge_kutta(np.zeros(STATES), unit(3, 0), SPEEDS[0])[0]
    assert drive**2 / PERIOD / (1.0 - move**2) == pytest.approx(exact, rel=1e-5)


def test_turbulence_without_a_length_is_refused():
    named = dict(zip((parameter.name for parameter in TURBULENCE.parameters), P, strict=True))
    assert TURBULENCE.check(named) == ''
    assert 'across_length' in TURBULENCE.check({**named, 'across_length': 0.0})
    assert TURBULENCE.rate((0.0,) * 8, (0.0,) * STATES, place(1.0)) == (0.0,) * STATES
