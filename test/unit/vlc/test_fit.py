# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parts of the fit of a direction, each checked against numpy or by hand."""

import math
import sys

from lta_vlc.direction_fit import (
    build_direction_fit,
    failed_fit,
    fit_direction,
    rotate_direction,
    update_unknowns,
)
from lta_vlc.reading_model import (
    AZIMUTH,
    DiodeFitInputs,
    DirectionPrior,
    ELEVATION,
    FALL,
    FIT_SCRATCH,
    MISFIT_AT,
    NEARNESS,
    NORMAL_AT,
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


@pytest.mark.parametrize(
    ('side', 'level', 'found'), [(0.5, 0.5, False), (0.5, 0.51, True), (1e-9, 0.0, False)]
)
def test_an_azimuth_deviation_of_a_radian_or_more_gives_no_direction(side, level, found):
    scratch = np.zeros(FIT_SCRATCH)
    for unknown in range(UNKNOWNS):
        scratch[NORMAL_AT + (UNKNOWNS + 1) * unknown] = 1.0 / side
    told = build_direction_fit(scratch, level, 0.0, math.sqrt(1.0 - level**2), 1.0)
    assert told.found is found
    assert (told == failed_fit()) is not found
    assert failed_fit() == (False, *(0.0,) * 9)


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
    scratch[VALUES:MISFIT_AT] = 1.0
    scratch[RIGHT_SIDE:NORMAL_AT] = 0.25
    update_unknowns(scratch, 100.0)
    assert scratch[VALUES:MISFIT_AT].tolist() == [1.25] * ELEVATION
    scratch[RIGHT_SIDE:NORMAL_AT] = 9.0
    update_unknowns(scratch, 100.0)
    assert (scratch[VALUES + NEARNESS], scratch[VALUES + FALL]) == (2.0, 3.0)
    assert scratch[VALUES + STRENGTH] == 10.25
    scratch[RIGHT_SIDE:NORMAL_AT] = -99.0
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
            scratch[NORMAL_AT + (UNKNOWNS + 1) * unknown] = 4.0
        scratch[RIGHT_SIDE + AZIMUTH] = 4.0 * pull

    monkeypatch.setattr(sys.modules['lta_vlc.direction_fit'], 'build_normal_equations', pulling)
    level = EXPECTED._replace(elevation=0.0)
    found = fit_direction(four(), level, (50.0, 10.0, 10.0, 10.0), SURE, [0.0] * FIT_SCRATCH)
    assert found.found
    apart = math.remainder(math.atan2(found.y, found.x) - azimuth, math.tau)
    assert apart == pytest.approx(0.0, abs=1e-9)
    assert sorted(set(faints)) == pytest.approx([5e-5])
