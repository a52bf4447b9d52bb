"""Dryden turbulence against the published spectra: the filters, their variance, and a record."""

from functools import cache
import math

from lta_model.effects.air import TURBULENCE
from lta_model.effects.protocol import AirEffectInput
from lta_model.state import NOISE
import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov
from scipy.signal import welch
from scipy.stats import chi2

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


PERIOD, COUNT = 0.05, 40_000


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


@cache
def record(speed):
    """Return the turbulence of 2000 s, noise held for each control period; shape (COUNT, 3)."""
    generator = np.random.default_rng(7)
    noise = generator.standard_normal((COUNT, 3)) / math.sqrt(PERIOD)
    # One step is linear in memory and noise: its matrices, from the effect, and then the record.
    at_rest = np.zeros(STATES)
    move = np.transpose([runge_kutta(row, CALM, speed) for row in np.eye(STATES)])
    drive = np.transpose([runge_kutta(at_rest, unit(3, i), speed) for i in range(3)])
    _, _, c = filters(speed)
    memory, states = at_rest, np.empty((COUNT, STATES))
    for k, row in enumerate(noise @ drive.T):
        memory = move @ memory + row
        states[k] = memory
    skip = 1000  # 50 s, 30 times the longest T
    return states[skip:] @ c.T


@pytest.mark.parametrize('speed', SPEEDS)
@pytest.mark.parametrize('axis', [0, 1, 2])
def test_a_record_has_the_intensity(axis, speed):
    turns = record(speed)[:, axis]
    time = LENGTH[axis] / speed
    # The variance of a variance: 2 / duration times the integral of the squared correlation over
    # all lags, T for the first order, and for the second (1 - tau / 2 T) e^(-tau / T): 5 T / 8.
    integral = time * (1.0 if axis == 0 else 0.625)
    spread = math.sqrt(2.0 * integral / (len(turns) * PERIOD))
    assert np.mean(turns**2) / SIGMA[axis] ** 2 == pytest.approx(1.0, abs=3.5 * spread)
    assert spread < 0.04


@pytest.mark.parametrize('speed', SPEEDS)
@pytest.mark.parametrize('axis', [0, 1, 2])
def test_a_record_has_the_spectrum(axis, speed):
    turns = record(speed)[:, axis]
    length = 1024
    f, power = welch(turns, 1.0 / PERIOD, nperseg=length, detrend=False)
    used = (f > 0.04) & (f < 1.0)  # away from the window's width; the held noise loses 1 % at 1 Hz
    theory = 2.0 * math.pi * np.array([military(axis, 2.0 * math.pi * x, speed) for x in f[used]])
    # Hann windows that overlap by half count 0.947 each (Welch 1967), two degrees of freedom.
    segments = 2 * len(turns) // length - 1
    freedom = 2.0 * 0.947 * segments
    ratio = power[used] / theory
    low, high = chi2.ppf([0.5e-4, 1.0 - 0.5e-4], freedom) / freedom
    assert np.all((ratio > low) & (ratio < high))
    # Neighbouring bins of a Hann window share: half of them are independent.
    spread = math.sqrt(2.0 / freedom / (0.5 * np.count_nonzero(used)))
    assert np.mean(ratio) == pytest.approx(1.0, abs=3.5 * spread)


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
