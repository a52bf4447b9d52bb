# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sensor biases learned at rest, and the limits beyond which a drone is not at rest."""

import math

from lta_control.bias_calibration import (
    is_tilted,
    is_turning,
    rest_step,
    RestSums,
    SensorBiases,
)
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


@pytest.mark.parametrize('axis', AXES)
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_a_bias_above_3_degrees_a_second_is_a_turn_and_above_0_06_g_a_tilt(axis, sign):
    told = (0.2, -0.1, 0.3)
    for share, beyond in ((0.999, False), (1.001, True)):
        rates = at(told, axis, share * sign * math.radians(3.0))
        force = at(told, axis, share * sign * 0.06 * G)
        assert is_turning(SensorBiases(rates=rates), told) is beyond
        assert is_tilted(SensorBiases(force=force), told) is beyond
