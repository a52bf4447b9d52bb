# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta fly` prints."""

import json
import re

from lta_analysis.flights import FlyRequest, SimulateRequest
from lta_cli.verbs.launch import launch
from lta_config.errors import BadInput
from lta_flight.flight_run import EXIT_STATUSES, FlightRun
from lta_flight.report.results import FlightResults
from lta_sim.readings import FlightOutcome
import pytest

RESULTS = FlightResults(success=True, path_length=6.0, search_time=12.0, closest_horizontal=0.9)


@pytest.fixture
def flown(monkeypatch, tmp_path):
    """Return a function that makes the next flight end in some way."""
    for name, result in (
        ('lta_flight.report.page.write_page', RESULTS),
        ('lta_flight.report.results.compute_results', RESULTS),
        ('lta_flight.report.view.FlightView', None),
        ('lta_analysis.flights.open_flight', None),
        ('lta_data.scene.describe_exceeded_region_of_bag', ''),
    ):
        monkeypatch.setattr(name, lambda *_, result=result: result)

    def ends(outcome, sentence):
        end = FlightRun(tmp_path, tmp_path / 'bag', outcome, sentence, 2.5)
        monkeypatch.setattr('lta_flight.flight.fly_once', lambda *_, **__: end)

    return ends


@pytest.mark.parametrize('page', [True, False])
def test_every_figure_is_there_and_has_its_unit(flown, call, page):
    flown('reached', 'reached its goal')
    _, said = call('fly', '--json', *([] if page else ['--no-page']))
    found = json.loads(said.out)
    units = found.pop('units')
    assert units['pace'] == '1'
    numbers = found.keys() - {'outcome', 'bag', 'page', 'success'}
    assert units.keys() == numbers
    assert (found['path_length'], units['path_length']) == (6.0, 'm')
    assert ('page' in found) is page


def test_the_terminal_says_what_the_page_says(flown, call):
    flown('reached', 'reached its goal at 15.0 s')
    said = call('fly', '--no-page')[1].out.splitlines()
    assert said[0] == 'The drone found the lamp and reached it in 12.0 s over 6.0 m.'
    assert said[1].startswith('Bag ')


def test_a_broken_flight_without_a_recording_is_no_bad_input(flown, monkeypatch, call):
    def refuse(bag, out):
        raise BadInput('There is no recording.')

    flown('failed', 'did not finish, because a node of the ROS graph failed or stalled')
    monkeypatch.setattr('lta_flight.report.page.write_page', refuse)
    status, said = call('fly')
    assert status == 1
    assert said.out == (
        'The drone did not finish, because a node of the ROS graph failed or stalled.\n'
    )


@pytest.mark.parametrize(
    ('outcome', 'status'), [('reached', 0), ('failed', 1), ('timeout', 3), ('escaped', 4)]
)
def test_the_exit_status_tells_how_the_flight_ended(flown, call, outcome, status):
    flown(outcome, 'ended')
    assert call('fly', '--no-page')[0] == status


@pytest.mark.parametrize('flight_verb', [FlyRequest, launch, SimulateRequest])
def test_help_tells_every_exit_status(flight_verb):
    assert set(EXIT_STATUSES) == {
        *(each.name.lower() for each in FlightOutcome), 'flown', 'landed', 'failed'
    }  # fmt: skip
    _, told = flight_verb.__doc__.split('Exit status ')
    # Nodes die in a graph only
    known = {*EXIT_STATUSES.values(), 2} - ({1} if flight_verb is SimulateRequest else set())
    assert known <= {int(number) for number in re.findall(r'(\d+):', told)}
