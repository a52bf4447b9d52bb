# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tuning: what is turned, how it is searched and kept, and the verb around it."""

from io import StringIO
import json
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_control.laws import load_gains
from lta_report.study_store import StudyStore
from lta_report.workers import ItemFailure, LocalWorkers
from lta_studies.tune import compare, helium_limit
from lta_studies.tune import run as tuning
from lta_studies.tune.cma_search import (
    format_gains,
    GainSearchResult,
    iterate_parameters,
    replace_parameters,
    robust_cost,
    search_gains,
    select_parameters,
    TunableParameter,
    write_gains,
)
from lta_studies.tune.compare import (
    compare_costs,
    compute_quartiles,
    compute_step_metrics,
    evaluate_jobs,
    fly_to_lamp,
    GainEvaluation,
    LampFlightResult,
    ResponseMetrics,
    SEARCH_STORE,
)
from lta_studies.tune.step_response import fly_steps, SetpointStep, TuningCase, TuningScene
import numpy as np
import pytest
from rich.console import Console
import worker_functions


class Inner(Settings):
    kd: float = setting(0.2, 's', 0.0, 3.0)
    """Damping."""


class Toy(Settings):
    kp: float = setting(1.0, '1/s', 0.5, 2.0)
    """Stiffness."""
    limit: float = setting(5.0, low=0.0, high=9.0)
    """Largest output."""
    off: float = setting(0.0, low=0.0, high=1.0)
    """Not used."""
    inner: Inner = setting(Inner())
    """Within."""


def test_numbers_are_found_with_their_bounds():
    found = {number.path: number for number in iterate_parameters(Toy())}
    assert list(found) == ['kp', 'limit', 'off', 'inner.kd']
    kd = found['inner.kd']
    assert (kd.value, kd.low, kd.high, kd.unit) == (0.2, 0.0, 3.0, 's')
    assert found['kp'].search_bounds(6.0) == (0.5, 2.0)
    assert kd.search_bounds(6.0) == pytest.approx((0.2 / 6.0, 1.2))


def test_gains_are_turned_and_limits_are_not():
    assert [number.path for number in select_parameters(Toy())] == ['kp', 'inner.kd']
    assert [number.path for number in select_parameters(Toy(), ['limit'])] == ['limit']
    with pytest.raises(BadInput, match='limt'):
        select_parameters(Toy(), ['limt'])
    with pytest.raises(BadInput, match='off starts at 0'):
        select_parameters(Toy(), ['off'])


def toy_costs(candidate):
    # Plant 1/s^2 under u = -y - kd y': the integral of the squared step error is (1 + kd^2) /
    # (2 kd), least at kd = 1 (Parseval).
    return [0.5 * (1.0 + candidate['kd'] ** 2) / candidate['kd']]


def tuned(folder, budget=61, fly=toy_costs):
    two = [TunableParameter('kd', 0.3, 0.0, 100.0), TunableParameter('kp', 1.0, 0.9, 1.1)]
    with StudyStore(folder, SEARCH_STORE, 'toy') as store:
        return search_gains(two, fly, store, budget, 1)


def test_a_toy_plant_is_tuned(tmp_path):
    found = tuned(tmp_path)
    assert found.numbers['kd'] == pytest.approx(1.0, rel=0.02)
    assert 0.9 <= found.numbers['kp'] <= 1.1
    assert found.first == pytest.approx(0.5 * (1.0 + 0.09) / 0.3)
    assert len(found.history) == 61
    assert list(found.history) == sorted(found.history, reverse=True)


def test_one_number_is_tuned(tmp_path):
    with StudyStore(tmp_path, SEARCH_STORE, 'toy') as store:
        one = [TunableParameter('kd', 0.3, 0.0, 100.0)]
        found = search_gains(one, toy_costs, store, 61, 1)
    assert found.numbers['kd'] == pytest.approx(1.0, rel=0.02)


def test_a_stopped_search_goes_on_where_it_was(tmp_path):
    every, flown = [], []

    def fly(candidate):
        every.append(candidate)
        return toy_costs(candidate)

    whole = tuned(tmp_path / 'whole', fly=fly)

    def stop(candidate):
        if len(flown) == 17:
            raise KeyboardInterrupt
        flown.append(candidate)
        return toy_costs(candidate)

    part = tuned(tmp_path / 'part', fly=stop)
    assert part.stopped
    assert flown == every[:17]
    # A kill may tear the last line off: it is flown again.
    path = tmp_path / 'part' / 'search.jsonl'
    path.write_text(path.read_text()[:-4])
    again = []

    def go_on(candidate):
        again.append(candidate)
        return toy_costs(candidate)

    assert tuned(tmp_path / 'part', fly=go_on) == whole
    assert again == every[16:]


def test_a_stopped_tuning_writes_the_best_gains_and_compares_nothing(tmp_path, monkeypatch):
    def search(numbers, *_):
        kept = {number.path: number.value for number in numbers}
        return GainSearchResult(kept, 2.0, 2.0, (2.0, 2.0), stopped=True)

    monkeypatch.setattr(tuning, 'search_gains', search)
    told = StringIO()
    order = tuning.TuningRequest(budget=101, workers=1, out=tmp_path / 'out')
    with pytest.raises(KeyboardInterrupt):
        tuning.tune_once(order, Console(file=told))
    gains = tmp_path / 'out' / 'gains.yaml'
    assert load_gains(str(gains)) == load_gains('gtmab')
    assert '2 of 101 candidates were flown; the best gains so far are in ' in told.getvalue()


def test_metrics_come_in_the_order_of_the_jobs_and_a_failure_stops_the_search():
    with LocalWorkers(worker_functions.square_late, 2) as workers:
        assert evaluate_jobs([0, 3, 1, 2], workers) == [0, 9, 1, 4]
    with LocalWorkers(worker_functions.fail_at_odd, 1) as workers:
        assert evaluate_jobs([2, 3], workers) == ItemFailure('3 is not even.')


def test_a_failed_candidate_is_stored_until_it_is_repeated(tmp_path):
    def fail(numbers):
        return ItemFailure('It crashed.')

    for fly in (fail, toy_costs):  # the second run does not fly it again
        with pytest.raises(BadInput, match=r'^A test flight failed\. It crashed\. .*--retry-'):
            tuned(tmp_path, fly=fly)
    with StudyStore(tmp_path, SEARCH_STORE, 'toy', retry_failed=True) as store:
        assert not store.failures


def test_the_worst_counts_as_much_as_the_mean():
    assert robust_cost([1.0, 2.0, 6.0]) == pytest.approx(4.5)


def test_marks_of_a_second_order_step():
    # Damping 0.5: overshoot exp(-pi 0.5 / sqrt(0.75)) = 16.3 %.
    time = np.arange(0.0, 20.0, 0.05)
    w = math.sqrt(0.75)
    value = 1.0 - np.exp(-0.5 * time) * (np.cos(w * time) + 0.5 / w * np.sin(w * time))
    mark = compute_step_metrics(
        time + 7.0, 3.0 - 2.0 * value, SetpointStep(7.0, 27.0, 'altitude', 3.0, 1.0)
    )
    assert mark.overshoot == pytest.approx(0.163, abs=1e-3)
    outside = np.abs(value - 1.0) > 0.1
    assert mark.settle == pytest.approx(time[np.flatnonzero(outside)[-1] + 1], abs=1e-9)
    assert mark.steady < 1e-3


def test_a_step_that_never_settles_is_infinitely_long():
    time = np.arange(0.0, 10.0, 0.1)
    mark = compute_step_metrics(time, np.zeros(100), SetpointStep(0.0, 10.0, 'speed', 0.0, 0.4))
    assert (mark.settle, mark.overshoot, mark.steady, mark.error) == (math.inf, 0.0, 1.0, 1.0)
    assert compute_quartiles([1.0, 2.0, math.inf]).median == 2.0


def test_the_difference_has_students_interval():
    def flights(*holds):
        return GainEvaluation(
            (0.0,) * 3, tuple(ResponseMetrics((MARK,), h, 0.0, 0.0, False, 0.0) for h in holds)
        )

    gap = compare_costs(flights(0.4, 0.4, 0.4), flights(0.0, 0.04, 0.08))
    # Differences -1, -0.9, -0.8: mean -0.9, s 0.1, t(0.975, 2) = 4.303.
    assert gap.value == pytest.approx(-0.9)
    assert gap.high - gap.value == pytest.approx(4.303 * 0.1 / math.sqrt(3.0), rel=1e-3)


MARK = compute_step_metrics(np.arange(4.0), np.zeros(4), SetpointStep(0.0, 4.0, 'speed', 0.0, 1.0))


def test_written_gains_are_read_back(tmp_path):
    gains = replace_parameters(load_gains('gtmab'), {'climb.kp': 0.8123, 'altitude_kp': 0.45})
    path = tmp_path / 'gains.yaml'
    write_gains(gains, ['Found by: lta tune'], path)
    assert load_gains(str(path)) == gains
    assert format_gains(gains, ['Found by: lta tune']).startswith('# Found by: lta tune\n/**/')


def test_lost_lift_is_carried_by_the_rotors_and_not_told():
    scene = TuningScene('gtmab')
    assert scene.build_true_vehicle(3e-3).collect_effects()['net_lift']['force'] == pytest.approx(
        -3e-3 * STANDARD_GRAVITY
    )
    assert 'net_lift' not in scene.nominal_vehicle.collect_effects()
    short = (SetpointStep(12.0, 14.0, 'altitude', 1.0, 1.0 + 1e-9),)
    one, same = (
        fly_steps(scene, load_gains('gtmab'), TuningCase(3e-3, 5), short) for _ in range(2)
    )
    assert np.array_equal(one.altitude, same.altitude)
    assert one.altitude[-1] == pytest.approx(1.0, abs=0.1)


@pytest.mark.long
def test_a_mission_that_is_too_heavy_is_not_reached():
    # The climb may ask for 0.2 N: 20.4 g, 18.4 g beyond the trim.
    scene, gains = TuningScene('gtmab'), load_gains('gtmab')
    light, heavy = (fly_to_lamp(scene, gains, TuningCase(loss, 1)) for loss in (0.0, 24e-3))
    assert light.reached
    assert 0.1 < light.time < 0.5
    assert heavy == LampFlightResult(False, pytest.approx(1.0))


def test_what_the_rotors_carry():
    # Two rotors of 0.0915 + 0.0677 N, 0.961 of it upwards, less the 2 g of the trim.
    most = 2 * 0.961 * (0.0915 + 0.0677) / STANDARD_GRAVITY - 2e-3
    assert helium_limit.rotor_lift_loss_limit(
        TuningScene('gtmab').nominal_vehicle
    ) == pytest.approx(most, rel=1e-9)


def test_a_limit_is_bracketed():
    low, high = helium_limit.bracket_limit(lambda value: value < 17.0, 30.0)
    assert low < 17.0 <= high
    assert high - low == pytest.approx(5.0 / 2**helium_limit.HALVINGS)
    assert helium_limit.bracket_limit(lambda value: True, 30.0) == (30.0, math.inf)
    assert helium_limit.bracket_limit(lambda value: False, 30.0) == (None, 0.0)


@pytest.mark.long
def test_gains_that_may_ask_for_less_hold_less(monkeypatch):
    monkeypatch.setattr(helium_limit, 'TRIED_LOSSES', 2)
    monkeypatch.setattr(helium_limit, 'HALVINGS', 0)
    shipped = load_gains('gtmab')
    weak = replace_parameters(
        shipped, {'climb.limit': 0.1}
    )  # N; carries 10.2 g, 8.2 g beyond the trim
    strong, feeble = (
        helium_limit.find_tolerable_helium_loss('gtmab', gains) for gains in (shipped, weak)
    )
    assert feeble.demand == pytest.approx(1e3 * 0.1 / STANDARD_GRAVITY - 2.0)
    assert (feeble.grams, feeble.fails) == (0.0, pytest.approx(14.6, abs=0.05))
    assert strong.grams == pytest.approx(14.6, abs=0.05)
    # 0.5 to 2.3 g a day through 2.5 m2 (lta_model.effects.gas).
    assert strong.days == pytest.approx((14.6 / 2.3, 14.6 / 0.5), rel=0.05)


@pytest.mark.long
def test_the_verb_tunes(call, tmp_path, monkeypatch):
    monkeypatch.setattr(helium_limit, 'TRIED_LOSSES', 1)
    monkeypatch.setattr(helium_limit, 'HALVINGS', 0)
    monkeypatch.setattr(compare, 'fly_to_lamp', lambda *_: LampFlightResult(True, 0.3))
    folder = tmp_path / 't'
    words = ('--budget=2', '--draws=2', '--cases=1', '--workers=1', '--number=climb.kp', '--json')
    status, said = call('tune', 'gtmab', '--most=0 g', *words, f'--out={folder}')
    assert status == 0
    told = json.loads(said.out)
    assert (told['candidates'], told['flights']) == (2, 2)
    out = folder / 'gains.yaml'
    assert told['file'] == str(out)
    assert load_gains(str(out)).climb.kp == pytest.approx(told['gains']['climb.kp'], rel=1e-3)
    assert 'lta tune gtmab' in out.read_text().splitlines()[0]
    altitude = next(row for row in told['old']['margins'] if row['loop'] == 'altitude')
    assert altitude['phase'] == pytest.approx(31.6, abs=0.5)
    page = (folder / 'report.html').read_text(encoding='utf-8')
    assert 'Stability margins' in page
    assert page.count('class="plot"') == 6
