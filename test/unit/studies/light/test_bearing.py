"""Judging bearings: poses, scores by hand, and both estimators through the whole chain."""

from dataclasses import replace
import json
import math
import sys

from lta_cli import app
from lta_config.errors import BadInput
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.formatting import MISSING
from lta_report.report import TextTable
from lta_studies.light.bearing.bench import (
    bearing_bound,
    BEARING_PLACES,
    BearingBench,
    BearingReading,
    build_flight_spec,
    draw_pose,
    LARGEST_OFF_AXIS,
    NEAREST,
    TrueDiodes,
    WALL_DISTANCE,
)
from lta_studies.light.bearing.report import build_report
from lta_studies.light.bearing.run import (
    BearingScore,
    BearingTrialRequest,
    BearingTrialResult,
    median_interval,
    median_normal_error,
    score_readings,
)
from lta_studies.light.bearing.study import (
    list_directions,
    pose_for_lamp_direction,
    STUDY_DISTANCE,
)
from lta_vlc.demodulation import Peaks
from lta_vlc.direction import RAYLEIGH_SHARE
import numpy as np
import pytest
from scipy.optimize import least_squares

SCENE = load_scenario('lamp_room')
LAMP = np.array(SCENE.goal_lamp.position.vector)


@pytest.fixture(scope='module')
def bench():
    return BearingBench(build_flight_spec(BEARING_PLACES['indoor'], 'gtmab', 8))


@pytest.mark.parametrize('distance', [3.0, 6.0, None])
def test_poses_are_in_the_room_and_within_the_beam(distance):
    chance = np.random.default_rng(3)
    for _ in range(200):
        x, y, z, *_ = draw_pose(SCENE, distance, chance)
        away = math.hypot(LAMP[0] - x, LAMP[1] - y)
        assert abs(x) <= 5.0 - WALL_DISTANCE
        assert abs(y) <= 4.0 - WALL_DISTANCE
        assert 0.5 <= z <= 1.5
        assert away == pytest.approx(distance) if distance else away >= NEAREST
        # The lamp faces -x.
        assert (LAMP[0] - x) / away >= math.cos(LARGEST_OFF_AXIS) - 1e-6


def test_a_distance_that_the_room_does_not_have_is_refused():
    with pytest.raises(BadInput, match='20 m'):
        draw_pose(SCENE, 20.0, np.random.default_rng(1))


def test_scores_by_hand():
    nan = math.nan
    readings = [
        BearingReading(9.0, 0.1, 0.02, 0.01, 0.3, 0.2, 0.01),
        BearingReading(7.0, -0.3, -0.01, 0.01, -0.1, 0.2, 0.01),
        BearingReading(8.0, 0.2, 0.015, 0.01, 0.5, 0.2, 0.02),
        BearingReading(1.0, nan, nan, nan, nan, nan, 0.03),
    ]
    found = score_readings(readings)
    assert found.snr == 7.5
    assert found.paper == pytest.approx(0.2)
    assert found.ours == pytest.approx(0.015)
    assert (found.paper_lost, found.ours_lost) == (0.25, 0.25)
    # 0.02 is more than 1.96 x 0.01; 0.5 more than 1.96 x 0.2.
    assert found.holds == pytest.approx(2.0 / 3.0)
    assert found.elevation_holds == pytest.approx(2.0 / 3.0)
    assert score_readings(readings[3:]).to_json()['ours'] is None


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


def ask(**options):
    return BearingTrialRequest(place='indoor', **options)


def test_the_fit_is_better_than_the_papers_mean_where_walls_reflect_and_knows_how_good_it_is():
    asked = ask(diodes=8, range=3.0, poses=150, seed=5)
    (found,) = map(asked.evaluate, asked.list_cases())
    assert found.score.ours < math.radians(1.0)
    assert found.score.ours < 0.7 * found.score.paper
    # 150 readings know a share of 90 % to 2.4 %.
    assert 0.82 <= found.score.holds <= 1.0
    assert found.score.ours_lost == 0.0


@pytest.mark.parametrize(
    ('diodes', 'share'),
    [
        (TrueDiodes(1.0, 0.02), 1.0),
        (TrueDiodes(2.0, 0.02), 1.0),
        (TrueDiodes(1.2, 0.0), 0.7),
        # Gains are all that matters: no better than the mean, but no worse
        (TrueDiodes(1.2, 0.05), 1.1),
        (TrueDiodes(2.0, 0.05), 1.1),
    ],
)
def test_the_fit_is_no_worse_than_the_mean_with_diodes_other_than_the_file_says(diodes, share):
    asked = ask(
        diodes=8, range='any', poses=200, seed=6, response=diodes.response,
        gain_spread=100.0 * diodes.gain_spread,
    )  # fmt: skip
    (found,) = map(asked.evaluate, asked.list_cases())
    assert found.score.ours < share * found.score.paper
    assert found.score.ours_most < share * found.score.paper_most
    # 200 readings know a share of 95 % to 1.5 %.
    assert found.score.holds > 0.9
    assert found.score.bound < found.score.ours


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


def test_headline_tile_and_tables_of_a_score():
    score = BearingScore(
        9, 7.5, 0.02, (0.01, 0.03), 0.1, 0.25, 0.01, (0.008, 0.012), 0.03, math.nan, 0.01, 0.9,
        0.2, 0.1, 1.0, 0.005,
    )  # fmt: skip
    result = BearingTrialResult('indoor', 8, 3.0, TrueDiodes(None, 0.05), (), score)
    request = ask(diodes=8, range=3.0, poses=9)
    report = build_report([replace(result, count=4, range=None), result], request)
    assert report.headline.startswith(
        'Indoor, 8 diodes, at 3 m: the median bearing error is 0.57°'
    )
    assert [tile[:2] for tile in report.tiles] == [
        ('indoor, 4, any range', '0.57'), ('indoor, 8, 3 m', '0.57'),
    ]  # fmt: skip
    bearing, elevation = (each for each in report.blocks if isinstance(each, TextTable))
    assert bearing.rows[1] == [
        'indoor', '8', '3', 'file', '5', '8', '0.29', '1.15 (0.57 to 1.72)', '5.7',
        '0.57 (0.46 to 0.69)', '1.7', '0.57', '90.0',
    ]  # fmt: skip
    assert elevation.rows[0] == ['indoor', '4', 'any', '11.5', '100.0', f'25.0, {MISSING}']


def test_one_seed_is_one_result(bench):
    asked = ask(diodes=4, range='any', poses=3, seed=2)
    (case,) = asked.list_cases()
    assert asked.evaluate(case) == asked.evaluate(case)


def lta(*words, monkeypatch):
    """Return the status of the command."""
    monkeypatch.setattr(sys, 'argv', ['lta', *map(str, words)])
    return app.run_command_line()


def test_the_command_writes_a_table_and_a_page(tmp_path, monkeypatch, capsys):
    words = ('light', 'bearing', '--place', 'indoor', '--diodes', 4, '--range', 3, '--poses', 4)
    out = tmp_path / 'bearing'
    assert lta(*words, '--json', '--out', out, monkeypatch=monkeypatch) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed['rows'][0]['diodes'] == 4
    assert (out / 'report.html').stat().st_size > 1000
    assert json.loads((out / 'bearing.json').read_text())['rows'] == printed['rows']
