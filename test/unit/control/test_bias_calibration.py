"""Sensor biases learned at rest, and the limits beyond which a drone is not at rest."""

import math

from lta_control.bias_calibration import (
    compute_biases,
    is_tilted,
    is_turning,
    reset_unless_still,
    rest_step,
    RestSums,
    SensorBiases,
)
import numpy as np
import pytest

G = 9.80665
RATES, FORCE = (0.1, -0.2, 0.3), (0.4, -0.5, 9.7)
AXES = [0, 1, 2]


def at(vector, axis, change):
    """Return a vector with a change added on one axis."""
    return tuple(x + change * (k == axis) for k, x in enumerate(vector))


def rested(samples=4, pressure=101_000.0):
    rest = RestSums()
    for _ in range(samples):
        rest = rest_step(rest, RATES, FORCE, pressure)
    return rest


def test_each_sample_is_added_and_its_pressure_if_it_is_a_number():
    rest = rest_step(RestSums(), RATES, FORCE, math.nan)
    assert rest == RestSums(1, RATES, FORCE, 0.0, 0)
    rest = rest_step(rest, (0.11, -0.19, 0.29), (0.5, -0.6, 9.8), 99_000.0)
    assert rest[0] == 2
    assert rest.rates == pytest.approx((0.21, -0.39, 0.59))
    assert rest.force == pytest.approx((0.9, -1.1, 19.5))
    assert rest[3:] == (99_000.0, 1)
    assert rest_step(rest, RATES, FORCE, 1000.0)[3:] == (100_000.0, 2)


@pytest.mark.parametrize('axis', AXES)
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_sums_restart_beyond_10_degrees_a_second_or_a_tenth_of_g_off_the_mean(axis, sign):
    """0.1 % less makes a fifth sample; 0.1 % more leaves a sum of this sample alone."""
    rest = rested()
    for share, samples in ((0.999, 5), (1.001, 1)):
        turn, push = share * sign * math.radians(10.0), share * sign * 0.1 * G
        turned, pushed = at(RATES, axis, turn), at(FORCE, axis, push)
        assert rest_step(rest, turned, FORCE, 1.0).samples == samples
        assert rest_step(rest, RATES, pushed, 1.0).samples == samples
    anew = rest_step(rest, at(RATES, axis, sign), FORCE, 1.0)
    assert anew == RestSums(1, at(RATES, axis, sign), FORCE, 1.0, 1)


def test_the_first_sample_is_accepted_whatever_it_is():
    assert rest_step(RestSums(), (9.0, 9.0, 9.0), (9.0, 9.0, 9.0), 1.0).samples == 1


def test_sums_are_kept_or_reset_to_zero():
    assert reset_unless_still(rested(), True) == rested()
    assert reset_unless_still(rested(), False) == RestSums()
    assert RestSums() == (0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0)
    assert SensorBiases() == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)


@pytest.mark.parametrize('axis', AXES)
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_a_bias_above_3_degrees_a_second_is_a_turn_and_above_0_06_g_a_tilt(axis, sign):
    told = (0.2, -0.1, 0.3)
    for share, beyond in ((0.999, False), (1.001, True)):
        rates = at(told, axis, share * sign * math.radians(3.0))
        force = at(told, axis, share * sign * 0.06 * G)
        assert is_turning(SensorBiases(rates=rates), told) is beyond
        assert is_tilted(SensorBiases(force=force), told) is beyond


def test_biases_are_the_means_and_the_pressure_is_that_at_the_floor():
    rest = RestSums(4, (0.4, -0.8, 1.2), (2.0, -1.0, 40.0), 202_000.0, 2)
    found = compute_biases(rest, 0.5, 1.2)
    assert found.rates == pytest.approx((0.1, -0.2, 0.3))
    np.testing.assert_allclose(found.force, (0.5, -0.25, 10.0 - G), rtol=1e-12)
    assert found.pressure == pytest.approx(101_000.0 + 1.2 * G * 0.5, rel=1e-12)
