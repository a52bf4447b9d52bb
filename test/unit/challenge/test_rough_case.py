"""Rough cases: wrong vehicle files, and logs as laboratories have them."""

from pathlib import Path

from lta_challenge.case_score import score_case, ScoredCase
from lta_challenge.make import ChallengeRequest, draw_case, read_vehicle_text
from lta_challenge.roughness import (
    add_spikes,
    cut_gaps,
    distort_vehicle_file,
    NUMBERS,
    prepend_floor,
    prepend_hold,
)
from lta_challenge.score_statistics import compute_score_figures, FAULTY
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
import yaml

TIME = np.arange(0.0, 20.0, 0.01)
DRAW = np.random.default_rng(4)
POSES = np.column_stack([
    DRAW.standard_normal((len(TIME), 6)) * 1e-3 + (0.0, 0.0, 1.5, 0.0, 0.0, 0.0),
    np.ones(len(TIME)),
])  # fmt: skip
STREAMS = {
    'ground_truth/odom': (TIME, POSES),
    'motors': (TIME, 0.3 + 0.1 * np.sin(TIME)[:, None] * np.ones(4)),
}


@pytest.mark.parametrize('seed', range(8))
def test_one_or_two_numbers_of_the_file_are_wrong_and_it_still_loads(
    seed: int, tmp_path: Path
) -> None:
    right = yaml.safe_load(read_vehicle_text())
    text, factors = distort_vehicle_file(read_vehicle_text(), np.random.default_rng(seed))
    wrong = yaml.safe_load(text)
    assert 1 <= len(factors) <= 2
    for name, factor in factors.items():
        assert 0.3 <= factor <= 3.0
        path = tuple(name.split('.'))
        assert path in NUMBERS
        before, after = right, wrong
        for key in path:
            before, after = before[key], after[key]
        np.testing.assert_allclose(after['value'], factor * np.array(before['value']))
        after['value'] = before['value']
    assert wrong == right
    (tmp_path / 'wrong.yaml').write_text(text, encoding='utf-8')
    load_vehicle(str(tmp_path / 'wrong.yaml'))


def test_a_hand_holds_with_idle_motors_and_lets_go_where_the_flight_begins() -> None:
    made = prepend_hold(STREAMS, 3.0, np.random.default_rng(1))
    time, poses = made['ground_truth/odom']
    told, duties = made['motors']
    assert (np.diff(time) > 0.0).all()
    assert (duties[told < 3.0] == 0.0).all()
    np.testing.assert_array_equal(duties[told >= 3.0], STREAMS['motors'][1])
    np.testing.assert_allclose(poses[time < 3.0][-1, :3], (0.0, 0.0, 1.5), atol=0.01)
    assert np.linalg.norm(poses[0, :3] - (0.0, 0.0, 1.5)) > 0.05


def test_a_start_on_the_floor_rises_to_the_flight() -> None:
    time, poses = prepend_floor(STREAMS, 2.0, 0.42, np.random.default_rng(1))['ground_truth/odom']
    np.testing.assert_allclose(poses[time < 2.0, 2], 0.42, atol=0.01)
    np.testing.assert_allclose(poses[time > 4.0, 2], 1.5, atol=0.01)


def test_spikes_are_single_and_gaps_take_poses_away() -> None:
    spiked = add_spikes(STREAMS, 5, np.random.default_rng(1))['motors'][1]
    changed = np.flatnonzero((spiked != STREAMS['motors'][1]).any(axis=1))
    assert 1 <= len(changed) <= 5
    assert np.abs(spiked[changed]).max() > 2.0
    time, _ = cut_gaps(STREAMS, 2, np.random.default_rng(1))['ground_truth/odom']
    assert np.diff(time).max() > 0.2


def test_a_case_depends_on_its_numbers_only() -> None:
    order = ChallengeRequest(3, 1, 'rough')
    first, second = draw_case(order, 0), draw_case(order, 0)
    assert first.vehicle_file == second.vehicle_file
    assert first.answer['factors'] == second.answer['factors']
    assert [one.name for one in first.flights] == [one.name for one in second.flights]
    for one, other in zip(first.flights, second.flights, strict=True):
        for topic, (time, values) in one.streams.items():
            np.testing.assert_array_equal(time, other.streams[topic][0])
            np.testing.assert_array_equal(values, other.streams[topic][1])
    assert draw_case(order, 1).vehicle_file != first.vehicle_file


def scored(tuned: float, after: float, traceback: str = '') -> ScoredCase:
    """Return a scored rough case with errors on the flights of the fit, by those of the file."""
    answer = {'kind': 'clean', 'row': 'rough', 'outside': '', 'floors': 0.0, 'hidden': [],
              'nominal': {'given': {}}}  # fmt: skip
    error = {'channel': 'attitude', 'horizon_s': 3.0, 'before': 2.0, 'tuned': 2.0 * tuned,
             'after': 2.0 * after}  # fmt: skip
    result = {'verdict': 'none', 'refused': '', 'effects': [], 'cpu_s': 1.0,
              'training': [error, {**error, 'horizon_s': 5.0, 'tuned': 99.0}],
              'traceback': traceback}  # fmt: skip
    return score_case(0, answer, result)


def test_the_score_counts_tracebacks_and_fits_that_are_worse_than_the_file() -> None:
    cases = [scored(0.9, 1.2), scored(1.04, 1.0), scored(1.06, 1.0, 'Traceback')]
    shares = {one.name: one.share for one in compute_score_figures(cases)}
    own = 'predicts its own flights as well as the vehicle file'
    assert (shares[FAULTY].hits, shares[FAULTY].of) == (1, 3)
    assert shares[f'tuned model {own}'].hits == 2
    assert shares[f'final model {own}'].hits == 2
    # What should be named is unknown
    assert shares['no hidden effect: an effect named'].of == 0
