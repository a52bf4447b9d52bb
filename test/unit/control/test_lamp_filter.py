# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The filter of lamp and drift: against matrices in numpy, and on flights made by hand."""

import math

from lta_control.strategies.lamp_ekf import (
    bearing_deviation,
    expected_strength,
    initialize_fix,
    LampFilterPrior,
    LampFix,
    normalized_innovation,
    predict_fix,
    update_fix,
)
import numpy as np
import pytest

OPTICS = LampFilterPrior(math.log(2000.0), 0.5, 0.03, 0.15, 0.4, 0.1)
STILL = (0.0, 0.0)


def state_of(fix):
    return np.array(fix[:5]), np.array(fix.rows)


def told(x, p, slopes, error, noise):
    """Return mean and covariance after one number, in the textbook's form."""
    h = np.array([slopes])
    gain = p @ h.T / (h @ p @ h.T + noise)
    return x + gain[:, 0] * error, (np.eye(5) - gain @ h) @ p


def noises(x, deviation):
    squared = x[0] ** 2 + x[1] ** 2
    # The lamp may stand 10 cm beside where it seems to be, and 80 cm higher or lower.
    across = deviation**2 + OPTICS.bearing_noise**2 + 0.1**2 / squared
    return across, OPTICS.strength_noise**2 + (0.8**2 / squared) ** 2


def test_it_is_the_textbook_s_filter():
    chance = np.random.default_rng(4)
    fix = initialize_fix(OPTICS, 0.4, 0.05, 60.0, (0.1, 0.0))
    x, p = state_of(fix)
    ahead = np.eye(5)
    ahead[0, 2] = ahead[1, 3] = -0.1
    growth = np.diag([0.01**2, 0.01**2, 0.01, 0.01, 0.15**2])
    for _ in range(60):
        moved = chance.normal(0.03, 0.02, 2)
        fix = predict_fix(OPTICS, fix, *moved.tolist(), 0.1)
        x = ahead @ x - np.array([*moved, 0.0, 0.0, 0.0])
        p = ahead @ p @ ahead.T + 0.1 * growth
        bearing, strength = (
            0.4 + float(chance.normal(0.0, 0.05)),
            60.0 * math.exp(float(chance.normal(0.0, 0.1))),
        )
        squared = x[0] ** 2 + x[1] ** 2
        error = bearing - math.atan2(x[1], x[0])
        slopes = [-x[1] / squared, x[0] / squared, 0.0, 0.0, 0.0]
        x, p = told(x, p, slopes, error, noises(x, 0.05)[0])
        squared = x[0] ** 2 + x[1] ** 2
        error = math.log(strength) - x[4] + math.log(squared)
        slopes = [-2.0 * x[0] / squared, -2.0 * x[1] / squared, 0.0, 0.0, 1.0]
        x, p = told(x, p, slopes, error, noises(x, 0.05)[1])
        fix = update_fix(fix, OPTICS, bearing, 0.05, strength)
        assert state_of(fix)[0] == pytest.approx(x, rel=1e-9, abs=1e-12)
        assert state_of(fix)[1] == pytest.approx(p, rel=1e-7, abs=1e-12)


def test_a_first_sight_gives_the_range_by_the_inverse_square():
    """2000 counts at 1 m are 20 at 10 m; the range is known to half of what the brightness is."""
    fix = initialize_fix(OPTICS, math.pi / 2, 0.0, 20.0, STILL)
    assert (fix.x, fix.y) == (pytest.approx(0.0, abs=1e-12), pytest.approx(10.0))
    assert fix.rows[1][1] == pytest.approx((0.5 * 10.0) ** 2 * (0.5**2 + 0.15**2))
    assert fix.rows[0][0] == pytest.approx((10.0 * 0.03) ** 2)
    assert fix.rows[1][4] == pytest.approx(0.5 * 10.0 * 0.5**2)


@pytest.mark.parametrize('bearing', [0.4, 2.5, -1.0])
def test_the_covariance_of_a_first_sight_follows_from_that_of_its_inputs(bearing):
    """J diag(variances) J', with J of (x, y, brightness) by (brightness, strength, bearing)."""
    fix = initialize_fix(OPTICS, bearing, 0.05, 80.0, (0.1, -0.2))
    cos, sin, away = math.cos(bearing), math.sin(bearing), 5.0
    slopes = np.array(
        [
            [0.5 * away * cos, -0.5 * away * cos, -away * sin],
            [0.5 * away * sin, -0.5 * away * sin, away * cos],
            [1.0, 0.0, 0.0],
        ]
    )
    spread = slopes @ np.diag([0.5**2, 0.15**2, 0.05**2 + 0.03**2]) @ slopes.T
    rows = np.zeros((5, 5))
    rows[np.ix_([0, 1, 4], [0, 1, 4])] = spread
    rows[2, 2] = rows[3, 3] = 0.4**2
    assert fix[:5] == pytest.approx((away * cos, away * sin, 0.1, -0.2, math.log(2000.0)))
    assert np.array(fix.rows) == pytest.approx(rows, abs=1e-12)


def test_a_first_range_is_between_40_cm_and_50_m():
    assert initialize_fix(OPTICS, 0.0, 0.05, 1e6, STILL).x == pytest.approx(0.4)
    assert initialize_fix(OPTICS, 0.0, 0.05, 1e-3, STILL).x == pytest.approx(50.0)


@pytest.mark.parametrize(('x', 'y'), [(3.0, -2.0), (-2.0, 0.01), (0.1, 0.2)])
def test_a_fix_predicts_bearing_and_strength(x, y):
    """The bearing's variance is h P h' by its gradient h, which is that at 40 cm if nearer."""
    factor = np.random.default_rng(5).normal(0.0, 0.3, (5, 5))
    spread = factor @ factor.T
    fix = LampFix(x, y, 0.0, 0.0, math.log(1800.0), tuple(map(tuple, spread.tolist())))
    squared = max(x * x + y * y, 0.16)
    slopes = np.array([-y, x, 0.0, 0.0, 0.0]) / squared
    variance = slopes @ spread @ slopes
    assert bearing_deviation(fix) == pytest.approx(math.sqrt(variance))
    noise = 0.05**2 + 0.03**2 + 0.1**2 / squared
    for off in (-0.3, 0.2):  # by 0.2 the bearing of the second fix exceeds pi
        bearing = math.atan2(y, x) + off
        deviations = abs(off) / math.sqrt(variance + noise)
        assert normalized_innovation(fix, OPTICS, bearing, 0.05) == pytest.approx(deviations)
        assert normalized_innovation(fix, OPTICS, bearing - math.tau, 0.05) == pytest.approx(
            deviations
        )
    assert expected_strength(fix) == pytest.approx(1800.0 / (x * x + y * y + 0.64))


def test_a_lamp_above_the_diodes_is_nearer_than_its_strength_alone_tells():
    """At its place, ln S = c - ln(r^2 + h^2) is what is expected: such a light changes nothing."""
    fix = LampFix(2.0, 0.0, 0.0, 0.0, 7.0, tuple(map(tuple, (0.01 * np.eye(5)).tolist())))
    optics, strength = OPTICS._replace(over=0.8), math.exp(7.0) / (2.0**2 + 0.8**2)
    assert update_fix(fix, optics, 0.0, 0.05, strength)[:5] == pytest.approx(fix[:5])
    assert update_fix(fix, OPTICS, 0.0, 0.05, strength).x > 2.001


def test_nearer_than_40_cm_gradients_and_noise_are_those_at_40_cm():
    """The expected fix is that of two updates in numpy, by bearing and then by strength."""
    fix = LampFix(0.1, 0.2, 0.0, 0.0, 7.0, tuple(map(tuple, (0.01 * np.eye(5)).tolist())))
    x, p = state_of(fix)
    error = 0.9 - math.atan2(0.2, 0.1)
    noise = 0.05**2 + 0.03**2 + 0.1**2 / 0.16
    x, p = told(x, p, [-0.2 / 0.16, 0.1 / 0.16, 0.0, 0.0, 0.0], error, noise)
    squared = max(x[0] ** 2 + x[1] ** 2, 0.16)
    slopes = [-2.0 * x[0] / squared, -2.0 * x[1] / squared, 0.0, 0.0, 1.0]
    error = math.log(9000.0) - x[4] + math.log(squared)
    x, p = told(x, p, slopes, error, 0.15**2 + (0.64 / squared) ** 2)
    found = state_of(update_fix(fix, OPTICS, 0.9, 0.05, 9000.0))
    assert found[0] == pytest.approx(x)
    assert found[1] == pytest.approx(p, abs=1e-12)
