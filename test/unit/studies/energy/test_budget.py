# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The power budget against loads by hand, the paper's figures, and Bitcraze's bench."""

from contextlib import redirect_stdout
from io import StringIO
import json
import math

from lta_cli.app import run_command_line
from lta_config.constants import STANDARD_GRAVITY
from lta_model.electrical.loads import power_demand
from lta_model.vehicle import load_vehicle
from lta_studies.energy import paper
from lta_studies.energy.budget import run
from lta_studies.energy.budget.report import build_task_table
from lta_studies.energy.budget.run import explain_hover_power
from lta_studies.energy.course_flight import FlightTrack
import numpy as np
import pytest

GTMAB = load_vehicle('gtmab')
SHORT = {
    'START_TIME': 5.0, 'SETTLED_PHASE': 24.0, 'BUDGET_DEPARTURE': 30.0, 'CRUISING_TIME': 35.0,
    'FLIGHT_END': 39.0,
}  # fmt: skip


@pytest.fixture(scope='module')
def found(tmp_path_factory, plain_laws):
    """Return what the verb finds in flights that are shorter than its own."""
    folder = tmp_path_factory.mktemp('budget') / 'found'
    words = ['lta', 'energy', 'budget', '--seeds', '1', '--seconds', '40', '--workers', '1']
    words += ['--out', str(folder)]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as told:
        for name, value in SHORT.items():
            patch.setattr(run, name, value)
        patch.setattr(run, 'BUDGET_STRATEGIES', ('bag',))
        patch.setattr(run, 'is_flight_over', lambda loop: loop.world.elapsed > 8.0)
        patch.setattr('sys.argv', words)
        assert run_command_line() == 0
    numbers = json.loads((folder / 'budget.json').read_text())
    return {**numbers, 'page': (folder / 'report.html').read_text(), 'told': told.getvalue()}


def made(height, rotors):
    """Return a flight of one step a second."""
    count = len(height)
    rest = [np.zeros(count)] * 4
    return FlightTrack(
        np.arange(float(count)), np.array(height), rest[0], rest[1], np.array(rotors), *rest[2:]
    )


def test_standing_is_what_the_paper_prints():
    idle, transmitting = run.list_ground_tasks(GTMAB.loads)
    assert idle.power == paper.IDLE
    assert transmitting.power == pytest.approx(paper.TRANSMITTING)


def test_tasks_are_told_apart_by_when_they_are_flown():
    # At 5 s the rotors start; at 8 s it is within 5 cm of half a metre over the floor.
    height = [0.4] * 7 + [0.6, 0.86] + [0.9] * 91
    rotors = [0.0] * 5 + [3.0, 2.0, 1.0] + [0.5] * 52 + [0.9] * 40
    found = {
        each.name: each for each in run.average_flight_tasks(GTMAB.loads, [made(height, rotors)])
    }
    assert found['take-off'].rotors == pytest.approx(2.0)
    assert found['take-off'].seconds == 2.0
    assert found['hovering'].rotors == pytest.approx(0.5)
    assert found['flying at 0.5 m/s'].rotors == pytest.approx(0.9)
    assert found['hovering'].power == pytest.approx(0.620)


def test_means_over_seeds_come_with_how_far_one_is_off():
    flights = [made([1.0] * 100, [power] * 100) for power in (0.4, 0.5, 0.9)]
    hover = run.average_flight_tasks(GTMAB.loads, flights)[1]
    assert hover.rotors == pytest.approx(0.6)
    assert hover.off == pytest.approx(0.3)


def test_each_cause_alone_makes_the_papers_hover():
    loads, hover = GTMAB.loads, 0.7264
    found = explain_hover_power(GTMAB, hover, paper.HOVER)
    weight = 2e-3 * STANDARD_GRAVITY
    ideal = power_demand(loads, [weight / (2 * 0.961)] * 2, transmitting=True)
    assert found.least == pytest.approx(ideal, rel=1e-9)
    assert found.least == pytest.approx(0.120 + 2 * 0.027 + 23.96 * weight / 0.961, rel=1e-12)
    heavier = (found.heaviness - 2e-3) * STANDARD_GRAVITY
    assert hover + 23.96 * heavier / 0.961 == pytest.approx(paper.HOVER, rel=1e-9)
    drag = 0.092 * found.wind**2
    assert hover + 2 * 0.027 + 23.96 * drag / 0.981 == pytest.approx(paper.HOVER, rel=1e-9)
    assert 0.120 + found.factor * (hover - 0.120) == pytest.approx(paper.HOVER, rel=1e-9)


def test_what_has_no_rotor_ahead_cannot_be_explained_by_a_draught():
    assert math.isnan(explain_hover_power(load_vehicle('multirotor'), 7.4, 8.0).wind)


def test_flown_tasks_are_those_of_the_forces_that_they_take(found):
    power = {name: task['power'] for name, task in found['tasks'].items()}
    least = 0.120 + 2 * 0.027 + 23.96 * 2e-3 * STANDARD_GRAVITY / 0.961
    assert least < power['hovering'] < 1.25 * least
    assert power['take-off'] > 1.5 * power['hovering']
    drag = 2 * 0.027 + 23.96 * 0.092 * 0.5**2 / 0.981
    assert power['flying at 0.5 m/s'] - power['hovering'] > 0.8 * drag


def test_the_multirotor_hovers_on_what_bitcrazes_bench_makes_of_27_grams(found):
    # Between the rows of 24.4 g (1.83 A, 3.71 V) and 28.6 g (2.11 A, 3.67 V), and the radio.
    between = np.interp(27.0, [24.4, 28.6], [1.83 * 3.71, 2.11 * 3.67]) + 0.023
    hover = found['standard_hover']['power']
    assert hover == pytest.approx(between, rel=0.02)
    assert paper.HOVER / hover < 0.19  # and not "almost one third"


def test_the_verb_tells_what_it_found(found):
    task = found['tasks']['navigating, BAG']
    assert task['electronics'] == pytest.approx(0.310)
    assert task['power'] == pytest.approx(task['electronics'] + task['rotors'])
    hover = found['tasks']['hovering']['power']
    assert found['share_of_standard'] == pytest.approx(hover / found['standard_hover']['power'])
    assert 'of a multirotor' in found['told']
    assert 'Possible causes of 1333 mW' in found['page']
    assert str(round(1e3 * hover)) in found['page']


def test_both_hover_on_the_same_cell_and_one_takes_a_tenth(found):
    cell = found['on_one_cell']
    drone, other = cell['flown']['gtmab'], cell['flown']['multirotor']
    assert other['power'] == pytest.approx(7.44, abs=0.05)
    assert cell['share'] == pytest.approx(drone['power'] / other['power'])
    assert 0.08 < cell['share'] < 0.11
    assert other['drop'] > 5.0 * drone['drop']
    # 5 s of electronics, then 35 s of hovering, a little more while it rises.
    assert other['energy'] == pytest.approx(5.0 * 0.983 + 35.0 * other['power'], rel=0.02)


def test_the_table_stands_beside_the_paper():
    named = {
        each.name: each
        for each in (
            *run.list_ground_tasks(GTMAB.loads),
            run.TaskPower('hovering', 0.120, 0.6, paper=(paper.HOVER,)),
            run.TaskPower('flying at 0.5 m/s', 0.120, 1.2),
            run.TaskPower('navigating, DGA', 0.331, 1.2, paper=paper.NAVIGATION),
        )
    }  # fmt: skip
    made_up = run.PowerBudget(
        'gtmab', 'multirotor', named,
        run.TaskPower('multirotor, hovering', 0.983, 6.4, paper=(paper.STANDARD,)),
        explain_hover_power(GTMAB, 0.72, paper.HOVER), GTMAB.loads,
    )  # fmt: skip
    rows = {row[0]: row[1:] for row in build_task_table(made_up).rows}
    assert rows['idle'][-2:] == ['97', '1.00']
    assert rows['hovering'][-2:] == ['1333', '0.54']
    assert rows['navigating, DGA'][-2:] == ['1523\N{EN DASH}1544', '1.00']
    assert rows['multirotor, hovering'][-2] == '3999'
    assert made_up.hover_power_ratio == pytest.approx(0.72 / 7.383)
