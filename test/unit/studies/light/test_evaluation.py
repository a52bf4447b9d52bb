"""The evaluation of strategies: its statistics, its sets, and that it goes on where it was."""

from collections import Counter
from dataclasses import replace
from importlib import import_module
import io
from itertools import product
import json
import math
import sys

from lta_cli import app
from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_config.schema.sweep_file import load_sweep
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.sweep.job_runner import SweepRow
from lta_flight.sweep.plan import SweepPlan
from lta_report.report import TextTable
from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_sim.readings import FlightOutcome
from lta_sim.termination import OUTCOMES
from lta_studies.light.evaluation import flights, sets
from lta_studies.light.evaluation.cells import (
    bootstrap_mean,
    bootstrap_ratio,
    EvaluationCell,
    ordered_share,
)
from lta_studies.light.evaluation.flights import (
    build_sweep_plan,
    count_flights_per_seed,
    iterate_tasks,
    PILOT,
)
from lta_studies.light.evaluation.report import build_report
from lta_studies.light.evaluation.run import EvaluationRequest, run_evaluation
from lta_studies.light.evaluation.sets import FlightSet, SETS
import numpy as np
import pytest
from rich.console import Console
import yaml

ONE = StudyOptions(workers=1)
QUIET = Console(file=io.StringIO())
LONG = ('uniform', 'range', 'winds', 'roughness', 'ambient')  # built as the others are
NEAR = {
    'schema': 1, 'name': 'near', 'about': 'From close by.', 'vehicle': 'gtmab',
    'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab', 'seeds': {'count': 3},
    'set': {'scenario.start.position.0': '2.2 m', 'scenario.goal.time_limit': '12 s',
            'scenario.start.heading': '0 deg', 'scenario.start.heading_spread': '20 deg'},
    'cases': {'as_flown': {}, 'draught': {'scenario.air.wind': '[-0.05, 0, 0] m/s'}},
    'vary': {'strategy': ['bag']},
}  # fmt: skip


def cell(paths, strategy='bag', lost=0, case='as_flown'):
    """Return a cell of flights over such paths, and of some that did not arrive."""
    rows = {
        seed: SweepRow(seed, seed, {}, 'reached', '', figures={'path_length': path})
        for seed, path in enumerate(paths)
    }
    rows |= {100 + k: SweepRow(100 + k, 100 + k, {}, 'timeout', '') for k in range(lost)}
    return EvaluationCell(strategy, case, '', math.nan, rows)


def test_a_mean_has_the_interval_of_all_ways_to_resample_it():
    """Of three flights there are 27 ways; the draws come to the same ends."""
    values = [1.0, 2.0, 6.0]
    ways = [np.mean(way) for way in product(values, repeat=3)]
    found = bootstrap_mean(values)
    assert found.value == 3.0
    expected = np.percentile(ways, (2.5, 97.5), method='inverted_cdf')
    assert (found.low, found.high) == pytest.approx(tuple(expected))
    assert bootstrap_mean([4.0])[:1] == (4.0,)
    assert math.isnan(bootstrap_mean([4.0]).low)
    assert math.isnan(bootstrap_mean([]).value)


def test_a_ratio_is_of_means_over_the_same_seeds():
    """Flights that are all the same multiple of the best have no spread at all."""
    best = [6.0, 7.0, 9.0, 6.5]
    found = bootstrap_ratio([1.1 * each for each in best], best)
    assert found[:3] == pytest.approx((1.1, 1.1, 1.1))
    assert bootstrap_ratio([6.0, 12.0], [6.0, 6.0]).value == pytest.approx(1.5)


def test_a_cell_is_compared_over_the_seeds_with_which_both_arrived():
    ours, best = cell([8.0, 9.0, 30.0]), cell([4.0, 4.0], 'pilot', lost=1)
    assert ours.ratio_to(best)[::3] == (pytest.approx(17.0 / 8.0), 2)
    assert math.isnan(ours.ratio_to(None).value)
    assert cell([5.0], lost=3).reached_share.value == 0.25


def test_the_share_of_draws_in_an_order():
    # Of flights that are 0 or 2 the mean of five draws is below 1 in as many cases as above it.
    assert ordered_share([[0.0, 2.0] * 3, [1.0] * 6]) == pytest.approx(
        0.5 - 0.5 * 20 / 64, abs=0.03
    )
    assert ordered_share([[6.0 + 0.3 * k for k in range(5)], [9.0] * 5]) == 1.0
    assert math.isnan(ordered_share([[1.0] * 5, []]))


@pytest.mark.parametrize(
    'name', [pytest.param(name, marks=pytest.mark.long if name in LONG else ()) for name in SETS]
)
def test_a_set_is_a_sweep_that_can_be_flown(name):
    """Each case builds; the pilot is there; places on the axis differ from case to case."""
    plan = build_sweep_plan(name)
    own = SweepPlan(load_sweep(SETS[name].file))
    assert own.file.draws_per_point == 50
    assert {'bag', 'dga', 'des'} <= set(own.lists['strategy'])
    assert len(plan.lists['strategy']) == len(own.lists['strategy']) + SETS[name].piloted
    assert count_flights_per_seed(plan) * 50 == own.count // len(own.lists['strategy']) * len(
        plan.lists['strategy']
    )
    axis = SETS[name].axis
    if axis is not None:
        flights = [own.build_job(k) for k in range(0, own.count, own.file.draws_per_point)]
        made = [own.base.with_values(job.changes) for job in flights]
        assert len({round(axis.place(each), 6) for each in made}) > 3


def test_every_shipped_sweep_of_the_light_is_a_set():
    assert {part.file for part in SETS.values()} == {
        name for name in list_shipped_names('sweeps') if name.startswith('light_')
    }


def test_the_pilot_keeps_its_track_straight():
    """The 3-4-5 triangle; and the bounds: no more than the top, and slowly only where it must."""
    assert flights.solve_wind_triangle(0.0, 0.3, 0.5, 1.0) == pytest.approx((0.4, -0.3))
    assert flights.solve_wind_triangle(-0.4, 0.0, 0.5, 1.0) == pytest.approx((1.0, 0.0))
    assert flights.solve_wind_triangle(0.0, -0.6, 0.5, 1.0) == pytest.approx((0.8, 0.6))
    assert flights.solve_wind_triangle(0.0, 2.0, 0.5, 1.0) == pytest.approx((0.0, -1.0))
    assert flights.solve_wind_triangle(0.9, 0.0, 0.5, 1.0) == pytest.approx((0.5, 0.0))


@pytest.fixture(scope='module')
def shipped(tmp_path_factory):
    """Take a small sweep for two of the sets, whoever asks."""
    # Its help names the sets when it is first imported, for every later test of this process.
    import_module('lta_studies.light.evaluation.run')
    path = tmp_path_factory.mktemp('sweep') / 'near.yaml'
    path.write_text(yaml.safe_dump(NEAR))
    small = {
        sets.INDOORS: FlightSet(str(path), 'Near', 'From close by.'),
        sets.ABLATIONS: FlightSet(str(path), 'Changed', 'From close by.', piloted=False),
    }
    # All at once, and back: what monkeypatch deletes one by one comes back in another order.
    before = dict(SETS)
    SETS.clear()
    SETS.update(small)
    yield
    SETS.clear()
    SETS.update(before)


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp('evaluation') / 'out'


@pytest.fixture(scope='module')
def done(shipped, folder):
    """An evaluation of two seeds, flown once by one process."""
    order = EvaluationRequest(sets=(sets.INDOORS, sets.ABLATIONS), seeds=2)
    return run_evaluation(order, run_in(folder))


def run_in(folder):
    return StudyRun(QUIET, folder, options=ONE)


def test_two_seeds_are_flown_from_end_to_end(done):
    assert (done.new_flights, done.total, done.stopped) == (12, 12, False)
    cells = {(each.case, each.strategy): each for each in done.cells[sets.INDOORS]}
    assert set(cells) == set(product(('as_flown', 'draught'), ('bag', 'pilot')))
    for each in cells.values():
        assert sorted(each.rows) == [1, 2]
        assert (each.failed, each.reached_share.value) == (0, 1.0)
    # 1.3 m away, the goal circle 0.3 m ahead.
    paths = cells['as_flown', 'bag'].arrival_values('path_length')
    assert all(0.29 < path < 0.6 for path in paths.values())
    best = cells['draught', 'pilot']
    assert cells['draught', 'bag'].ratio_to(best).value == pytest.approx(1.0, abs=0.1)


def test_batches_fly_all_strategies_and_leave_the_pilot_alone(done, tmp_path, monkeypatch):
    batches = []

    def fly_many(flights, seeds, device, *, closed, which, on):
        batches.append((len(flights), list(seeds), device, closed))
        # A kernel for all batches has the effects of every flight
        assert all((each.model.on <= on).all() for each in flights)
        out = np.zeros((len(seeds), len(FIGURES)))
        out[:, FIGURES.index('outcome')] = OUTCOMES.index(FlightOutcome.REACHED)
        out[:, FIGURES.index('path_length')] = 10.0 * which + seeds
        return out

    monkeypatch.setattr('lta_flight.sweep.batch_workers.fly_many', fly_many)
    order, run = done.order.replace(device='cpu-batch'), run_in(tmp_path / 'out')
    batched = run_evaluation(order, run)
    assert (batched.new_flights, batched.total) == (12, 12)
    # Two sets of two cases with two seeds each
    assert batches == [(2, [1, 1, 1, 1, 2, 2, 2, 2], 'cpu-batch', True)]
    for name, own in done.cells.items():
        for single, each in zip(own, batched.cells[name], strict=True):
            if each.strategy == PILOT:
                # Single flights as before, but for the time that they took
                found = {seed: replace(row, wall=0.0) for seed, row in each.rows.items()}
                assert found == {seed: replace(row, wall=0.0) for seed, row in single.rows.items()}
            else:
                begin = 10.0 * (each.case == 'draught')
                assert each.arrival_values('path_length') == {1: begin + 1.0, 2: begin + 2.0}
    # Flights of another kind are not taken for these
    with pytest.raises(BadInput, match='other'):
        run_evaluation(order.replace(device=None), run)


def test_what_was_flown_is_not_flown_again_and_more_seeds_only_add(done, folder, monkeypatch):
    again = run_evaluation(done.order, run_in(folder))
    assert again.new_flights == 0
    assert again.cells == done.cells
    flown = []

    class Here:
        """A crew that flies nothing, and says what it should."""

        lost = 0

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def run(self, tasks):
            for task in tasks:
                job = task.job
                flown.append(job)
                yield task, SweepRow(job.index, job.seed, dict(job.values), 'timeout', 'made up')
                if len(flown) == 4:
                    raise KeyboardInterrupt

    monkeypatch.setattr('lta_report.study.open_workers', lambda *_: Here())
    stopped = run_evaluation(done.order.replace(seeds=3), run_in(folder))
    assert stopped.stopped
    assert {job.seed for job in flown} == {3}
    assert Counter(job.values['strategy'] for job in flown)['pilot'] == 2
    assert (stopped.new_flights, stopped.total) == (4, 18)
    for name, own in done.cells.items():  # the flights of two seeds are as they were
        kept = {(each.case, each.strategy): each for each in stopped.cells[name]}
        for each in own:
            rows = kept[each.case, each.strategy].rows
            assert {seed: rows[seed] for seed in (1, 2)} == each.rows
    assert run_evaluation(done.order, run_in(folder)).cells == done.cells


def test_all_sets_fly_a_seed_before_any_flies_the_next():
    plans = {name: build_sweep_plan(name) for name in ('indoors', 'ablations')}
    found = list(iterate_tasks(plans, 3))
    assert [task.job.seed for task in found] == sorted(task.job.seed for task in found)
    assert len({(task.part, task.job.index) for task in found}) == len(found)
    assert len(found) == 3 * sum(map(count_flights_per_seed, plans.values()))


def test_report_figures_and_docs_say_the_same(done):
    report = build_report(done)
    assert report.headline.endswith('the lamp is reached by BAG 100 % (share of the flights).')
    assert [tile[:3] for tile in report.tiles] == [('BAG', '100', '%')]
    pictures, ablations, *_ = report.blocks
    assert [each.name for each in (*pictures.blocks, ablations)] == [
        'indoors', 'tracks', 'ablations',
    ]  # fmt: skip
    json.dumps(report.data, allow_nan=False)
    first = report.data['sets'][sets.INDOORS][0]
    assert (first['case'], first['strategy'], first['flights']) == ('as_flown', 'bag', 2)
    assert first['reached']['value'] == 1.0
    path = f'{first["path_length"]["value"]:.1f} ({first["path_length"]["low"]:.1f}'
    tables = {each.heading: each for each in report.blocks if isinstance(each, TextTable)}
    assert tables['Near'].rows[0][4].startswith(path)


def test_failed_flights_count_in_headline_and_status(done):
    cells = dict(done.cells)
    cells[sets.INDOORS] = [replace(each, failed=1) for each in cells[sets.INDOORS]]
    report = build_report(replace(done, cells=cells), with_pictures=False)
    assert report.headline.endswith('(share of the flights). 4 of 16 flights failed.')
    assert '16 of 12 flights, 4 of which could not be simulated' in report.subject
    stopped = build_report(replace(done, stopped=True), with_pictures=False)
    assert (report.status, stopped.status) == (1, 130)


def test_the_command_takes_sets_without_repeating_the_option(done, folder, capsys, monkeypatch):
    words = ['light', 'evaluate', '--sets', 'indoors', 'ablations', '--seeds', '2']
    monkeypatch.setattr(sys, 'argv', ['lta', *words, '--out', str(folder)])
    assert app.run_command_line() == 0
    said = capsys.readouterr()
    assert 'All flights were already stored; nothing was flown.' in ' '.join(said.out.split())
    monkeypatch.setattr(sys, 'argv', ['lta', 'light', 'evaluate', '--sets', 'indoor'])
    assert app.run_command_line() == 2
    assert "Unknown set 'indoor'; known: ablations, indoors (" in capsys.readouterr().err


def test_a_set_without_strategies_is_refused(tmp_path, monkeypatch):
    path = tmp_path / 'none.yaml'
    path.write_text(yaml.safe_dump({**NEAR, 'vary': {}}))
    monkeypatch.setitem(SETS, 'none', FlightSet(str(path), 'None', 'None.'))
    with pytest.raises(BadInput, match='must list strategies'):
        build_sweep_plan('none')
