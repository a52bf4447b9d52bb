# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Attitude against scipy, and the biases at rest."""

import math
import warnings

from lta_control.bias_calibration import (
    is_tilted,
    is_turning,
    rest_step,
    RestSums,
    SensorBiases,
)
from lta_control.motion import up_in_body, yaw_from_quaternion
from lta_control.motion_filters import attitude_step
from lta_model.attitude import to_euler_angles
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

G = 9.80665
LEVEL = (0.0, 0.0, 0.0, 1.0)
DT = 0.01


def angle_between(a, b):
    return (Rotation.from_quat(a).inv() * Rotation.from_quat(b)).magnitude()


@pytest.mark.parametrize('seed', range(3))
def test_rates_are_integrated_as_by_scipy(seed):
    generator = np.random.default_rng(seed)
    q, exact = LEVEL, Rotation.identity()
    rates = generator.uniform(-1.0, 1.0, 3)
    for _ in range(1000):
        rates = np.clip(rates + 0.1 * generator.normal(size=3), -2.0, 2.0)
        q = attitude_step(q, tuple(rates), (0.0, 0.0, G), 0.0, DT)
        exact = exact * Rotation.from_rotvec(rates * DT)
    # One step turns by 2 atan(w dt / 2) about the right axis: at most (w dt)^3 / 12 short.
    bound = 1000 * (math.sqrt(12.0) * DT) ** 3 / 12.0
    assert angle_between(q, exact.as_quat()) < bound
    assert np.linalg.norm(q) == pytest.approx(1.0, rel=1e-12)


def test_euler_angles_are_those_of_scipy():
    generator = np.random.default_rng(1)
    free = 3.0 * generator.normal(size=(200, 4))
    yaw, roll = generator.uniform(-3.0, 3.0, (2, 200))
    nose = 0.5 * np.pi * np.sign(roll)  # straight down or up: only a sum of the others is known
    locked = Rotation.from_euler('ZYX', np.stack([yaw, nose, roll], axis=1)).as_quat()
    with warnings.catch_warnings(action='ignore'):
        for turns in (free, locked):
            expected = Rotation.from_quat(turns).as_euler('ZYX')
            np.testing.assert_array_equal(np.stack(to_euler_angles(turns), axis=1), expected)
    assert np.isnan(to_euler_angles([[0.0, 0.0, 0.0, 0.0], [np.nan, 0.0, 0.0, 1.0]])).all()


@pytest.mark.parametrize('turn', [(0.4, -0.2, 1.1), (-0.3, 0.5, -2.9)])
def test_up_and_heading_are_those_of_the_rotation(turn):
    rotation = Rotation.from_euler('ZYX', turn[::-1])
    q = tuple(rotation.as_quat())
    np.testing.assert_allclose(up_in_body(q), rotation.inv().apply((0, 0, 1)), atol=1e-15)
    assert yaw_from_quaternion(q) == pytest.approx(turn[2], abs=1e-12)


@pytest.mark.parametrize('axis', [0, 1])
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_gravity_corrects_a_tilt_with_the_time_constant(axis, sign):
    """A standing vehicle believed tilted: sin(tilt) pulls, so that tan(tilt / 2) decays by e."""
    gain, tilt = 0.5, 0.2 * sign
    q = tuple(Rotation.from_rotvec(np.eye(3)[axis] * tilt).as_quat())
    for _ in range(round(1.0 / gain / 0.001)):
        q = attitude_step(q, (0.0, 0.0, 0.0), (0.0, 0.0, G), gain, 0.001)
    left = 2.0 * math.atan(math.tan(tilt / 2.0) / math.e)
    assert Rotation.from_quat(q).as_rotvec()[axis] == pytest.approx(left, rel=1e-3)


@pytest.mark.parametrize('seed', range(4))
def test_the_correction_turns_about_the_axis_between_force_and_up(seed):
    """Whatever the attitude: gain times force x up, of unit vectors, added to the rates."""
    generator = np.random.default_rng(seed)
    rotation = Rotation.random(rng=generator)
    rates, force = generator.normal(size=3), generator.normal(size=3)
    q = attitude_step(tuple(rotation.as_quat()), tuple(rates), tuple(force), 0.7, 1e-5)
    up = rotation.inv().apply((0.0, 0.0, 1.0))
    turned = (rotation.inv() * Rotation.from_quat(q)).as_rotvec() / 1e-5
    pull = 0.7 * np.cross(force / np.linalg.norm(force), up)
    np.testing.assert_allclose(turned, rates + pull, atol=1e-6)


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
