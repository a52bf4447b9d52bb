"""The parts of the fit of a direction, each against numpy or by hand."""

import math
import sys

from lta_vlc.fit import (
    blind,
    by_cholesky,
    cholesky,
    concluded,
    first_guess,
    fit,
    renewed,
    strangeness,
    turned_by,
)
from lta_vlc.readings import (
    Array,
    AZIMUTH,
    ELEVATION,
    Expected,
    FALL,
    FIT_SCRATCH,
    MISFIT,
    NEARNESS,
    NORMAL,
    PEDESTAL,
    PULLS,
    STRENGTH,
    UNKNOWNS,
    VALUES,
)
import numpy as np
import pytest

CROSS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
NONE = (0.0,) * 4
SURE = (1.0,) * 4
EXPECTED = Expected(0.3, 0.1, 0.25, 0.1)


def four(gains=SURE):
    """Return four level diodes, the first forward."""
    x, y = zip(*CROSS, strict=True)
    return Array(x, y, NONE, NONE, NONE, NONE, gains, 1.0, 0.0)


def normal(seed=1):
    """Return scratch numbers with a normal matrix and a right side in them, and both."""
    chance = np.random.default_rng(seed)
    factor = chance.normal(size=(UNKNOWNS, UNKNOWNS))
    matrix = 4.0 * np.eye(UNKNOWNS) + factor @ factor.T
    pulls = chance.normal(size=UNKNOWNS)
    scratch = np.zeros(FIT_SCRATCH)
    scratch[NORMAL:VALUES] = np.tril(matrix).ravel()
    scratch[PULLS:NORMAL] = pulls
    return scratch, matrix, pulls


@pytest.mark.parametrize('seed', range(3))
def test_the_normal_equations_are_solved(seed):
    scratch, matrix, pulls = normal(seed)
    assert cholesky(scratch)
    factor = np.tril(scratch[NORMAL:VALUES].reshape(UNKNOWNS, UNKNOWNS))
    assert factor == pytest.approx(np.linalg.cholesky(matrix), abs=1e-12)
    by_cholesky(scratch)
    assert scratch[PULLS:NORMAL] == pytest.approx(np.linalg.solve(matrix, pulls), abs=1e-12)


@pytest.mark.parametrize('worst', [0.0, -1.0, math.nan])
@pytest.mark.parametrize('unknown', [0, UNKNOWNS - 1])
def test_a_matrix_that_is_not_positive_has_no_factor(worst, unknown):
    scratch, _, _ = normal()
    scratch[NORMAL + UNKNOWNS * unknown : NORMAL + UNKNOWNS * unknown + UNKNOWNS] = 0.0
    scratch[NORMAL + (UNKNOWNS + 1) * unknown] = worst
    assert not cholesky(scratch)


@pytest.mark.parametrize('seed', range(3))
def test_the_covariance_is_the_inverse_of_the_normal_matrix(seed):
    """Of azimuth a step to the side is over the cosine of the elevation; all grows by 2.5."""
    scratch, matrix, _ = normal(seed)
    cholesky(scratch)
    scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL] = 70.0, 8.0
    inverse = np.linalg.inv(matrix)
    found = concluded(scratch, 0.48, -0.64, 0.6, 2.5)
    assert found[:4] == (True, 0.48, -0.64, 0.6)
    assert found.azimuth_variance == pytest.approx(2.5 * inverse[AZIMUTH, AZIMUTH] / 0.8**2)
    assert found.covariance == pytest.approx(2.5 * inverse[AZIMUTH, ELEVATION] / 0.8)
    assert found.elevation_variance == pytest.approx(2.5 * inverse[ELEVATION, ELEVATION])
    assert found.strength_variance == pytest.approx(2.5 * inverse[STRENGTH, STRENGTH])
    assert (found.strength, found.pedestal) == (70.0, 8.0)


@pytest.mark.parametrize(
    ('side', 'level', 'found'), [(0.5, 0.5, False), (0.5, 0.51, True), (1e-9, 0.0, False)]
)
def test_an_azimuth_known_to_a_radian_is_none(side, level, found):
    scratch = np.zeros(FIT_SCRATCH)
    for unknown in range(UNKNOWNS):
        scratch[NORMAL + (UNKNOWNS + 1) * unknown] = 1.0 / side
    told = concluded(scratch, level, 0.0, math.sqrt(1.0 - level**2), 1.0)
    assert told.found is found
    assert (told == blind()) is not found
    assert blind() == (False, *(0.0,) * 9)


def test_the_misfit_of_the_readings_that_count_is_strange_beyond_one():
    scratch = np.zeros(FIT_SCRATCH)
    errors = (1.0, math.inf, 2.0, 3.0)
    for misfit, strange in ((12.0, 4.0), (3.0, 1.0), (0.5, 1.0)):
        scratch[MISFIT] = misfit
        assert strangeness(scratch, errors) == strange


def test_a_first_guess_is_the_weighted_mean_lifted_to_the_expected_elevation():
    """By gain: 60, 40, 20 counts and a dead diode: (40, 20) beyond the lowest."""
    scratch = np.full(FIT_SCRATCH, 9.0)
    array = four((1.0, 2.0, 1.0, 0.0))
    x, y, z, top = first_guess(array, EXPECTED, (60.0, 80.0, 20.0, 9.0), SURE, scratch)
    length = math.hypot(40.0, 20.0)
    flat = math.cos(0.3)
    assert (x, y, z) == pytest.approx((40 * flat / length, 20 * flat / length, math.sin(0.3)))
    assert top == 60.0
    values = scratch[VALUES:MISFIT].tolist()
    assert (values[STRENGTH], values[PEDESTAL], values[NEARNESS]) == (40.0, 20.0, 0.25)
    others = set(range(ELEVATION)) - {STRENGTH, PEDESTAL, NEARNESS}
    assert [values[k] for k in others] == [0.0] * 6


def test_a_spoilt_diode_has_no_part_in_the_first_guess():
    scratch, errors = np.zeros(FIT_SCRATCH), (1.0, 1.0, math.inf, 1.0)
    x, y, _, top = first_guess(four(), EXPECTED, (30.0, 10.0, 900.0, 10.0), errors, scratch)
    assert (x, y) == pytest.approx((math.cos(0.3), 0.0))
    assert (top, scratch[VALUES + STRENGTH], scratch[VALUES + PEDESTAL]) == (30.0, 20.0, 10.0)


@pytest.mark.parametrize('readings', [(5.0,) * 4, (math.inf, 1.0, 1.0, 1.0)])
def test_even_or_endless_light_has_no_first_guess(readings):
    found = first_guess(four(), EXPECTED, readings, SURE, np.zeros(FIT_SCRATCH))
    assert found == (1.0, 0.0, 0.0, 0.0)
    assert fit(four(), EXPECTED, readings, SURE, np.zeros(FIT_SCRATCH)) == blind()


def test_a_step_goes_to_the_left_and_up_on_the_sphere():
    """From azimuth a, elevation e: left is (-sin a, cos a, 0), up is left's other normal."""
    a, e = 0.7, -0.4
    here = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    left = np.array([-math.sin(a), math.cos(a), 0.0])
    there = here + 0.2 * left - 0.1 * np.cross(here, left)
    found = turned_by(*here.tolist(), 0.2, -0.1)
    assert found == pytest.approx(there / np.linalg.norm(there))
    assert turned_by(0.0, 0.0, 1.0, 0.0, 0.0) == pytest.approx((0.0, 0.0, 1.0))


def test_values_stay_within_what_can_be():
    """No lamp is nearer than half a metre or falls by more than 3; a strength is above 0."""
    scratch = np.zeros(FIT_SCRATCH)
    scratch[VALUES:MISFIT] = 1.0
    scratch[PULLS:NORMAL] = 0.25
    renewed(scratch, 100.0)
    assert scratch[VALUES:MISFIT].tolist() == [1.25] * ELEVATION
    scratch[PULLS:NORMAL] = 9.0
    renewed(scratch, 100.0)
    assert (scratch[VALUES + NEARNESS], scratch[VALUES + FALL]) == (2.0, 3.0)
    assert scratch[VALUES + STRENGTH] == 10.25
    scratch[PULLS:NORMAL] = -99.0
    renewed(scratch, 100.0)
    assert (scratch[VALUES + NEARNESS], scratch[VALUES + FALL]) == (0.0, -3.0)
    assert scratch[VALUES + STRENGTH] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ('pull', 'azimuth'),
    [
        (1.0, 12 * math.atan(0.3)),  # no step is longer than 0.3, and there are twelve
        (0.2, 5 * math.atan(0.2) + 7 * math.atan(0.1)),  # after five they are halved
        (0.4, 5 * math.atan(0.3) + 7 * math.atan(0.2)),
        (1.1e-5, 5 * 1.1e-5 + 7 * 0.55e-5),
        (0.9e-5, 0.9e-5),  # done
    ],
)
def test_steps_are_limited_halved_and_twelve_at_most(monkeypatch, pull, azimuth):
    """Normal equations that always pull to the left."""
    faints = []

    def pulling(array, expected, readings, errors, scratch, x, y, z, faint):
        faints.append(faint)
        scratch[PULLS:VALUES] = [0.0] * (VALUES - PULLS)
        for unknown in range(UNKNOWNS):
            scratch[NORMAL + (UNKNOWNS + 1) * unknown] = 4.0
        scratch[PULLS + AZIMUTH] = 4.0 * pull

    monkeypatch.setattr(sys.modules['lta_vlc.fit'], 'normal_equations', pulling)
    level = EXPECTED._replace(elevation=0.0)
    found = fit(four(), level, (50.0, 10.0, 10.0, 10.0), SURE, [0.0] * FIT_SCRATCH)
    assert found.found
    apart = math.remainder(math.atan2(found.y, found.x) - azimuth, math.tau)
    assert apart == pytest.approx(0.0, abs=1e-9)
    assert sorted(set(faints)) == pytest.approx([5e-5])
