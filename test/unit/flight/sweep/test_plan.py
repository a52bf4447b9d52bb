# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A sweep's flights: which there are, what chance gives them, and what is refused beforehand."""

import itertools
import math

from lta_config.files import find_file
from lta_config.parameter_override import parse_assignment
from lta_config.schema.sweep_file import Distribution, load_sweep, SweepFile
from lta_flight.flight_spec import build_loop, load_spec, to_set_args
from lta_flight.sweep.plan import convert_to_si, sample_parameter, SweepPlan
import numpy as np
import pytest
from scipy import stats

HEAVY = 'vehicle.trim.heaviness'
WIND = 'scenario.air.wind.1'
DRAWS = 300
PATHS = (HEAVY, *(f'{HEAVY}.{k}' for k in range(19)))  # streams that are pooled


def file(**content):
    given = {'vehicle': 'gtmab', 'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab'}
    given |= {'schema': 1, 'name': 'test', 'about': 'A test.', 'vary': {}}
    return SweepFile.model_validate(given | content)


def drawn(how, path=HEAVY, seed=1):
    spread = Distribution.model_validate(how)
    return np.array([convert_to_si(sample_parameter(spread, path, seed, k)) for k in range(DRAWS)])


def test_a_grid_is_every_value_with_every_value():
    vary = {HEAVY: ['1 g', '2 g', '3 g'], WIND: ['0 m/s', '0.1 m/s']}
    plan = SweepPlan(file(vary=vary, seeds={'first': 5, 'count': 4}))
    assert plan.count == 3 * 2 * 4
    found = []
    for index in range(plan.count):
        job = plan.build_job(index)
        values = {path: convert_to_si(value) for path, value in job.values.items()}
        found.append((round(1e3 * values[HEAVY]), values[WIND], job.seed))
    assert found == list(itertools.product((1, 2, 3), (0.0, 0.1), (5, 6, 7, 8)))
    assert plan.units == {HEAVY: 'kg', WIND: 'm/s'}


def test_a_short_sweep_flies_each_point_once():
    vary = {HEAVY: ['1 g', '2 g']}
    for content in ({'seeds': {'first': 5, 'count': 4}}, {'samples': 3, 'seeds': {'first': 5}}):
        plan = SweepPlan(file(vary=vary, **content).shorten())
        assert [plan.build_job(k).seed for k in range(plan.count)] == [5, 5]


def test_cases_are_values_that_belong_together():
    """Each case with each value; a file that a case names keeps what the sweep sets."""
    cases = {'room': {}, 'field': {'scenario': 'windy_field', 'mission.speed': 1.0}}
    limit = 'scenario.goal.time_limit'
    plan = SweepPlan(file(cases=cases, vary={HEAVY: ['1 g', '2 g']}, set={limit: '30 s'}))
    plan.check()
    assert plan.units == {'case': '', HEAVY: 'kg'}
    jobs = [plan.build_job(k) for k in range(plan.count)]
    assert [job.values['case'] for job in jobs] == ['room', 'room', 'field', 'field']
    loops = [build_loop(plan.base.with_values(job.changes), 1) for job in jobs]
    scenes = [loop.world.scenario for loop in loops]
    assert [scene.name for scene in scenes] == ['lamp_room'] * 2 + ['windy_field'] * 2
    assert [scene.goal.time_limit.si for scene in scenes] == [30.0] * 4
    assert [loop.policy.mission.speed for loop in loops] == [0.5, 0.5, 1.0, 1.0]
    grams = [1e3 * loop.world.vehicle.file.trim.heaviness.si for loop in loops]
    assert grams == pytest.approx([1.0, 2.0, 1.0, 2.0])


def test_whole_files_and_strategies_can_be_varied():
    vary = {'strategy': ['bag'], 'scenario': ['lamp_room', 'breeze'], 'vehicle': ['gtmab', 'skye']}
    plan = SweepPlan(file(vary=vary))
    assert plan.units == {'strategy': '', 'scenario': '', 'vehicle': ''}
    made = plan.base.with_values(plan.build_job(3).changes)
    assert (made.names['scenario'], made.names['vehicle']) == ('breeze', 'skye')
    assert made.names['gains'] == 'skye'  # its own, since the sweep's are another vehicle's


def test_what_a_named_file_holds_decides_the_sweep(tmp_path):
    """An edited scenario of a case makes another sweep, so that no old flight passes for a new."""
    path = tmp_path / 'own.yaml'
    text = find_file('scenario', 'lamp_room').read_text()
    found = []
    for content in (text, text, text.replace('time_limit: 60 s', 'time_limit: 61 s')):
        path.write_text(content)
        found.append(SweepPlan(file(cases={'own': {'scenario': str(path)}})).identity)
    assert found[0] == found[1] != found[2]


def test_an_effect_that_no_file_names_can_be_varied():
    leak = 'vehicle.effects.helium_leak.rate'
    plan = SweepPlan(file(vary={leak: ['0 N/s', '1e-4 N/s']}))
    plan.check()
    assert plan.units == {leak: 'N/s'}
    worlds = [build_loop(plan.base.with_values(plan.build_job(k).values), 1).world for k in (0, 1)]
    rates = [world.vehicle.collect_effects()['helium_leak']['rate'] for world in worlds]
    assert rates == [0.0, 1e-4]


def test_every_point_of_a_grid_has_the_same_draws_and_seeds():
    how = {'uniform': {'low': '-0.1 m/s', 'high': '0.1 m/s'}}
    plan = SweepPlan(file(vary={HEAVY: ['1 g', '2 g'], WIND: how}, samples=3))
    assert plan.count == 6
    first, second = ([plan.build_job(3 * point + k) for k in range(3)] for point in (0, 1))
    assert [job.seed for job in first] == [job.seed for job in second] == [1, 2, 3]
    winds = [[job.values[WIND] for job in jobs] for jobs in (first, second)]
    assert winds[0] == winds[1]
    assert len({str(wind) for wind in winds[0]}) == 3


@pytest.mark.parametrize(
    ('how', 'theory'),
    [
        ({'normal': {'mean': '2 g', 'deviation': '0.5 g'}}, stats.norm(2e-3, 0.5e-3)),
        ({'uniform': {'low': '1 g', 'high': '3 g'}}, stats.uniform(1e-3, 2e-3)),
        ({'loguniform': {'low': '1 g', 'high': '0.1 kg'}}, stats.loguniform(1e-3, 0.1)),
        (
            {'normal': {'mean': '2 g', 'deviation': '1 g', 'low': '1 g', 'high': '2.5 g'}},
            stats.truncnorm(-1.0, 0.5, 2e-3, 1e-3),
        ),
    ],
    ids=['normal', 'uniform', 'loguniform', 'bounded'],
)
def test_draws_have_the_distribution_that_was_asked_for(how, theory):
    """
    Kolmogorov and Smirnov over the first draws of twenty streams.

    Not over one: the first 2000 of this very parameter's are a run of chance (p = 4e-5, its next
    20 000 have p = 0.66), and of 300 other streams as many lie below 1 and 5 % as should.
    """
    values = np.concatenate([drawn(how, path) for path in PATHS])
    assert stats.kstest(values, theory.cdf).pvalue > 0.01
    error = theory.std() / math.sqrt(len(values))
    assert values.mean() == pytest.approx(theory.mean(), abs=3.0 * error)
    deviation = math.sqrt((theory.stats('k') + 2.0) / (4.0 * len(values))) * theory.std()
    assert values.std() == pytest.approx(theory.std(), abs=3.0 * deviation)


def test_a_choice_takes_each_alike():
    how = {'choice': ['1 g', '2 g', '4 g', '8 g']}
    values = np.concatenate([drawn(how, path) for path in PATHS])
    _, counts = np.unique(values, return_counts=True)
    assert stats.chisquare(counts).pvalue > 0.01
    assert len(counts) == 4


def test_streams_are_of_their_own():
    """One more parameter or sample leaves the others' draws as they were."""
    how = {'uniform': {'low': '1 g', 'high': '3 g'}}
    one, other, again = drawn(how), drawn(how, 'scenario.lamp'), drawn(how)
    np.testing.assert_array_equal(one, again)
    assert abs(np.corrcoef(one, other)[0, 1]) < 3.0 / math.sqrt(DRAWS)
    assert not np.array_equal(one, drawn(how, seed=2))


def test_gains_have_the_units_that_they_are_declared_with():
    vary = {'gains.heading_kp': [0.5, 0.6], 'mission.altitude': [0.5, 0.6], 'gains.climb.kp': [1]}
    assert SweepPlan(file(vary=vary)).units == {
        'gains.heading_kp': '1/s',
        'mission.altitude': 'm',
        'gains.climb.kp': '',
    }


def test_the_shipped_sweeps_can_be_flown():
    for name in ('heaviness', 'monte_carlo'):
        SweepPlan(load_sweep(name)).check()


def test_another_design_is_another_sweep():
    plans = [SweepPlan(file(vary={HEAVY: [text]})) for text in ('1 g', '1 g', '2 g')]
    assert plans[0].identity == plans[1].identity != plans[2].identity


def test_a_flight_is_told_so_that_it_is_flown_again_to_the_last_bit():
    made_of = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    how = Distribution.model_validate({'uniform': {'low': '1 g', 'high': '3 g'}})
    values = {HEAVY: sample_parameter(how, HEAVY, 1, 0), 'gains.heading_kp': 0.1 + 0.2}
    values['scenario.air.wind'] = {'value': [0.1, 0.0, -1e-5], 'unit': 'm/s'}
    again = dict(map(parse_assignment, to_set_args(values)))
    one, two = (build_loop(made_of.with_values(each), 1) for each in (values, again))
    assert one.policy.gains == two.policy.gains
    assert one.world.scenario == two.world.scenario
    assert one.world.vehicle.file.trim == two.world.vehicle.file.trim
