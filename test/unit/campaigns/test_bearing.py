# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Scoring bearings: poses, scores by hand, and both estimators through the whole chain."""

from argparse import Namespace
import math

from campaigns.bearing import (
    bearing_bound,
    draw_pose,
    KINDS,
    LARGEST_OFF_AXIS,
    median_interval,
    median_normal_error,
    NEAREST,
    OTHERS,
    score_bearings,
    score_readings,
    WALL_DISTANCE,
)
from campaigns.harness import Case
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_studies.light.bearing.bench import (
    BEARING_PLACES,
    BearingBench,
    BearingReading,
    build_flight_spec,
    list_directions,
    pose_for_lamp_direction,
    STUDY_DISTANCE,
)
from lta_vlc.demodulation import Peaks
from lta_vlc.lamp import RAYLEIGH_SHARE
import numpy as np
import pytest
from scipy.optimize import least_squares

SCENE = load_scenario('lamp_room')
LAMP = np.array(SCENE.goal_lamp.position.vector)


@pytest.fixture(scope='module')
def bench():
    return BearingBench(build_flight_spec(BEARING_PLACES['indoor'], 'gtmab', 8))


def test_poses_are_in_the_room_and_within_the_beam():
    chance = np.random.default_rng(3)
    for _ in range(200):
        x, y, z, *_ = draw_pose(SCENE, chance)
        away = math.hypot(LAMP[0] - x, LAMP[1] - y)
        assert abs(x) <= 5.0 - WALL_DISTANCE
        assert abs(y) <= 4.0 - WALL_DISTANCE
        assert 0.5 <= z <= 1.5
        assert away >= NEAREST
        # The lamp faces -x.
        assert (LAMP[0] - x) / away >= math.cos(LARGEST_OFF_AXIS) - 1e-6


def test_scores_by_hand():
    nan, peaks = math.nan, None
    readings = [
        BearingReading(9.0, 0.1, 0.02, 0.01, peaks, 0.0, 0.0),
        BearingReading(7.0, -0.3, -0.01, 0.01, peaks, 0.0, 0.0),
        BearingReading(8.0, 0.2, 0.015, 0.01, peaks, 0.0, 0.0),
        BearingReading(1.0, nan, nan, nan, peaks, 0.0, 0.0),
    ]
    found = score_readings(readings, [0.01] * 4)
    assert found['snr'] == 7.5
    assert found['paper'][0] == pytest.approx(0.2)
    assert found['ours'][0] == pytest.approx(0.015)
    # 0.02 is more than 1.96 x 0.01.
    assert found['holds'] == pytest.approx(2.0 / 3.0)
    assert found['bound'] == pytest.approx(0.01 * 0.6744898)


def test_a_median_has_the_interval_of_its_order():
    """Of six errors none is below the median once in 64 times, of five once in 32."""
    errors = np.array([0.3, -0.1, 0.2, 0.5, -0.4, 0.6, math.nan])
    assert median_interval(errors) == (0.1, 0.6)
    assert all(map(math.isnan, median_interval(errors[:5])))
    # Of 100 errors the 40th and the 61st (tables of the sign test)
    assert median_interval(np.arange(1.0, 101.0)) == (40.0, 61.0)


def test_the_bound_of_unequal_poses_is_the_median_of_their_mixture():
    assert median_normal_error(np.array([2.0, 2.0])) == pytest.approx(2.0 * 0.6744898, rel=1e-6)
    chance = np.random.default_rng(1)
    deviations = np.repeat([0.5, 5.0], 200_000)
    found = np.median(np.abs(chance.normal(0.0, deviations)))
    # More than the median of the deviations times 0.674 where they are 0.5 or 5
    assert median_normal_error(deviations) == pytest.approx(found, rel=0.01)


@pytest.mark.parametrize('direction', list_directions()[::3])
def test_the_study_turns_the_ring_and_not_the_lamp(bench, direction):
    pose = pose_for_lamp_direction(bench, direction)
    azimuth, _ = bench.true_direction(pose)
    assert math.remainder(azimuth - direction, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert math.hypot(LAMP[0] - pose[0], LAMP[1] - pose[1]) == pytest.approx(STUDY_DISTANCE)


def score(kind, poses, seed):
    return score_bearings(Case(kind, 0), Namespace(poses=poses, seed=seed))


def test_the_fit_is_better_than_the_papers_mean_where_walls_reflect_and_knows_how_good_it_is():
    found = score('indoor | 8', 150, 5)
    assert found['ours'][0] < min(math.radians(1.0), found['paper'][0])
    # 150 readings know a share of 95 % to 1.8 %.
    assert 0.9 <= found['holds'] <= 1.0
    assert found['wrong'] == ''
    assert score('indoor | 8', 3, 2) == score('indoor | 8', 3, 2)


@pytest.mark.parametrize('kind', OTHERS)
def test_the_fit_is_no_worse_than_the_mean_with_diodes_other_than_the_file_says(kind):
    assert KINDS[kind].diodes.gain_spread == 0.05
    found = score(kind, 200, 6)
    assert found['wrong'] == ''
    assert found['ours'][0] < 1.1 * found['paper'][0]
    assert found['ours_most'] < 1.1 * found['paper_most']
    assert found['bound'] < found['ours'][0]


def test_the_bound_is_that_of_many_fits_of_a_known_model():
    """Readings of the bound's own model, fitted by scipy: their spread is the bound."""
    diodes = load_vehicle('gtmab').diodes.model_copy(update={'gain_spread': 0.02})
    generator = np.random.default_rng(4)
    azimuth, elevation, noise = 0.4, 0.1, 1.5
    axes = diodes.planes[:, 3:]

    def expect(v):
        level = math.cos(elevation)
        ray = np.array([level * math.cos(v[0]), level * math.sin(v[0]), math.sin(elevation)])
        return v[1] * np.maximum(axes @ ray, 0.0) ** diodes.response + v[2]

    truth = np.array([azimuth, 200.0, 30.0])
    clean = expect(truth)
    deviation = np.hypot(noise, 0.02 * clean)
    found = []
    for _ in range(600):
        read = clean + deviation * generator.standard_normal(8)
        fit = least_squares(
            lambda v, read=read: (expect(v) - read) / deviation, truth, x_scale=truth
        )
        found.append(fit.x[0])
    level = np.full(8, noise / RAYLEIGH_SHARE)
    peaks = Peaks(clean, clean / level, np.full(8, 150.0), level)
    # 600 fits know a deviation to 3 %.
    bound = bearing_bound(diodes, peaks, azimuth, elevation)
    assert np.std(found) == pytest.approx(bound, rel=0.1)
