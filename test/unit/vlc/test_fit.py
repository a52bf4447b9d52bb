"""The parts of the fit of a direction, each checked against numpy or by hand."""

import math
import sys

from lta_vlc.direction_fit import (
    build_direction_fit,
    factorize_cholesky,
    failed_fit,
    fit_direction,
    guess_direction,
    rotate_direction,
    solve_cholesky,
    update_unknowns,
    variance_inflation,
)
from lta_vlc.reading_model import (
    AZIMUTH,
    DiodeFitInputs,
    DirectionPrior,
    ELEVATION,
    FALL,
    FIT_SCRATCH,
    MISFIT,
    NEARNESS,
    NORMAL,
    PEDESTAL,
    RESPONSE,
    RIGHT_SIDE,
    STRENGTH,
    UNKNOWNS,
    VALUES,
)
import numpy as np
import pytest

CROSS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
NONE = (0.0,) * 4
SURE = (1.0,) * 4
EXPECTED = DirectionPrior(0.3, 0.1, 0.25, 0.1)


def four(gains=SURE):
    """Return four level diodes at right angles, the first facing forward."""
    x, y = zip(*CROSS, strict=True)
    return DiodeFitInputs(x, y, NONE, NONE, NONE, NONE, gains, 1.0, 0.3, 0.0)


def normal(seed=1):
    """Return scratch with a normal matrix and a right-hand side in it, and both as arrays."""
    chance = np.random.default_rng(seed)
    factor = chance.normal(size=(UNKNOWNS, UNKNOWNS))
    matrix = 4.0 * np.eye(UNKNOWNS) + factor @ factor.T
    pulls = chance.normal(size=UNKNOWNS)
    scratch = np.zeros(FIT_SCRATCH)
    scratch[NORMAL:VALUES] = np.tril(matrix).ravel()
    scratch[RIGHT_SIDE:NORMAL] = pulls
    return scratch, matrix, pulls


@pytest.mark.parametrize('seed', range(3))
def test_the_normal_equations_are_solved(seed):
    scratch, matrix, pulls = normal(seed)
    assert factorize_cholesky(scratch)
    factor = np.tril(scratch[NORMAL:VALUES].reshape(UNKNOWNS, UNKNOWNS))
    assert factor == pytest.approx(np.linalg.cholesky(matrix), abs=1e-12)
    solve_cholesky(scratch)
    assert scratch[RIGHT_SIDE:NORMAL] == pytest.approx(np.linalg.solve(matrix, pulls), abs=1e-12)


@pytest.mark.parametrize('worst', [0.0, -1.0, math.nan])
@pytest.mark.parametrize('unknown', [0, UNKNOWNS - 1])
def test_a_matrix_that_is_not_positive_definite_has_no_factor(worst, unknown):
    scratch, _, _ = normal()
    scratch[NORMAL + UNKNOWNS * unknown : NORMAL + UNKNOWNS * unknown + UNKNOWNS] = 0.0
    scratch[NORMAL + (UNKNOWNS + 1) * unknown] = worst
    assert not factorize_cholesky(scratch)


@pytest.mark.parametrize('seed', range(3))
def test_the_covariance_is_the_inverse_of_the_normal_matrix(seed):
    """Azimuth is the step to the left over cos(elevation) = 0.8; 2.5 scales all variances."""
    scratch, matrix, _ = normal(seed)
    factorize_cholesky(scratch)
    scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL] = 70.0, 8.0
    inverse = np.linalg.inv(matrix)
    found = build_direction_fit(scratch, 0.48, -0.64, 0.6, 2.5)
    assert found[:4] == (True, 0.48, -0.64, 0.6)
    assert found.azimuth_variance == pytest.approx(2.5 * inverse[AZIMUTH, AZIMUTH] / 0.8**2)
    assert found.covariance == pytest.approx(2.5 * inverse[AZIMUTH, ELEVATION] / 0.8)
    assert found.elevation_variance == pytest.approx(2.5 * inverse[ELEVATION, ELEVATION])
    assert found.strength_variance == pytest.approx(2.5 * inverse[STRENGTH, STRENGTH])
    assert (found.strength, found.pedestal) == (70.0, 8.0)


@pytest.mark.parametrize(
    ('side', 'level', 'found'), [(0.5, 0.5, False), (0.5, 0.51, True), (1e-9, 0.0, False)]
)
def test_an_azimuth_deviation_of_a_radian_or_more_gives_no_direction(side, level, found):
    scratch = np.zeros(FIT_SCRATCH)
    for unknown in range(UNKNOWNS):
        scratch[NORMAL + (UNKNOWNS + 1) * unknown] = 1.0 / side
    told = build_direction_fit(scratch, level, 0.0, math.sqrt(1.0 - level**2), 1.0)
    assert told.found is found
    assert (told == failed_fit()) is not found
    assert failed_fit() == (False, *(0.0,) * 9)


def test_the_variance_factor_weighs_the_misfit_with_ten_readings_of_one_and_is_at_least_one():
    scratch = np.zeros(FIT_SCRATCH)
    errors = (1.0, math.inf, 2.0, 3.0, 1.0, 1.0)  # five valid readings, three free unknowns
    for misfit, strange in ((2.0, 1.0), (26.0, 3.0), (0.8, 1.0)):
        scratch[MISFIT] = misfit
        assert variance_inflation(scratch, errors) == pytest.approx(strange)


def test_a_first_guess_is_the_weighted_mean_lifted_to_the_expected_elevation():
    """Over their gains the readings are 60, 40, 20 and dead: (40, 20) above the lowest."""
    scratch = np.full(FIT_SCRATCH, 9.0)
    array = four((1.0, 2.0, 1.0, 0.0))
    x, y, z, top = guess_direction(array, EXPECTED, (60.0, 80.0, 20.0, 9.0), SURE, scratch)
    length = math.hypot(40.0, 20.0)
    flat = math.cos(0.3)
    assert (x, y, z) == pytest.approx((40 * flat / length, 20 * flat / length, math.sin(0.3)))
    assert top == 60.0
    values = scratch[VALUES:MISFIT].tolist()
    assert (values[STRENGTH], values[PEDESTAL], values[NEARNESS]) == (40.0, 20.0, 0.25)
    assert values[RESPONSE] == array.response
    others = set(range(ELEVATION)) - {STRENGTH, PEDESTAL, NEARNESS, RESPONSE}
    assert [values[k] for k in others] == [0.0] * 6


def test_a_diode_with_an_infinite_error_does_not_affect_the_first_guess():
    scratch, errors = np.zeros(FIT_SCRATCH), (1.0, 1.0, math.inf, 1.0)
    x, y, _, top = guess_direction(four(), EXPECTED, (30.0, 10.0, 900.0, 10.0), errors, scratch)
    assert (x, y) == pytest.approx((math.cos(0.3), 0.0))
    assert (top, scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL]) == (30.0, 20.0, 10.0)


@pytest.mark.parametrize('readings', [(5.0,) * 4, (math.inf, 1.0, 1.0, 1.0)])
def test_equal_or_infinite_readings_give_no_first_guess(readings):
    found = guess_direction(four(), EXPECTED, readings, SURE, np.zeros(FIT_SCRATCH))
    assert found == (1.0, 0.0, 0.0, 0.0)
    assert fit_direction(four(), EXPECTED, readings, SURE, np.zeros(FIT_SCRATCH)) == failed_fit()


def test_a_step_goes_to_the_left_and_up_on_the_sphere():
    """At azimuth a, left is (-sin a, cos a, 0), and up is the cross product of here and left."""
    a, e = 0.7, -0.4
    here = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    left = np.array([-math.sin(a), math.cos(a), 0.0])
    there = here + 0.2 * left - 0.1 * np.cross(here, left)
    found = rotate_direction(*here.tolist(), 0.2, -0.1)
    assert found == pytest.approx(there / np.linalg.norm(there))
    assert rotate_direction(0.0, 0.0, 1.0, 0.0, 0.0) == pytest.approx((0.0, 0.0, 1.0))


def test_a_step_keeps_the_values_within_their_limits():
    """Nearness is at most 1 / (0.5 m), fall at most 3, strength at least 1/1000 of the top."""
    scratch = np.zeros(FIT_SCRATCH)
    scratch[VALUES:MISFIT] = 1.0
    scratch[RIGHT_SIDE:NORMAL] = 0.25
    update_unknowns(scratch, 100.0)
    assert scratch[VALUES:MISFIT].tolist() == [1.25] * ELEVATION
    scratch[RIGHT_SIDE:NORMAL] = 9.0
    update_unknowns(scratch, 100.0)
    assert (scratch[VALUES + NEARNESS], scratch[VALUES + FALL]) == (2.0, 3.0)
    assert scratch[VALUES + STRENGTH] == 10.25
    scratch[RIGHT_SIDE:NORMAL] = -99.0
    update_unknowns(scratch, 100.0)
    assert (scratch[VALUES + NEARNESS], scratch[VALUES + FALL]) == (0.0, -3.0)
    assert scratch[VALUES + STRENGTH] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ('pull', 'azimuth'),
    [
        (1.0, 12 * math.atan(0.3)),  # twelve steps of the longest, 0.3
        (0.2, 5 * math.atan(0.2) + 7 * math.atan(0.1)),  # halved after five steps
        (0.4, 5 * math.atan(0.3) + 7 * math.atan(0.2)),
        (1.1e-5, 5 * 1.1e-5 + 7 * 0.55e-5),
        (0.9e-5, 0.9e-5),  # less than 1e-5 rad: the last step
    ],
)
def test_at_most_twelve_steps_are_limited_and_halved_after_five(monkeypatch, pull, azimuth):
    """Stubbed equations ask for the same step to the left each time; s turns by atan(s)."""
    faints = []

    def pulling(array, expected, readings, errors, scratch, x, y, z, faint):
        faints.append(faint)
        scratch[RIGHT_SIDE:VALUES] = [0.0] * (VALUES - RIGHT_SIDE)
        for unknown in range(UNKNOWNS):
            scratch[NORMAL + (UNKNOWNS + 1) * unknown] = 4.0
        scratch[RIGHT_SIDE + AZIMUTH] = 4.0 * pull

    monkeypatch.setattr(sys.modules['lta_vlc.direction_fit'], 'build_normal_equations', pulling)
    level = EXPECTED._replace(elevation=0.0)
    found = fit_direction(four(), level, (50.0, 10.0, 10.0, 10.0), SURE, [0.0] * FIT_SCRATCH)
    assert found.found
    apart = math.remainder(math.atan2(found.y, found.x) - azimuth, math.tau)
    assert apart == pytest.approx(0.0, abs=1e-9)
    assert sorted(set(faints)) == pytest.approx([5e-5])
