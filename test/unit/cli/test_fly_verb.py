"""What `lta fly` prints."""

from contextlib import nullcontext
import json
import re

from lta_cli.verbs import fly as verb
from lta_cli.verbs.launch import launch
from lta_cli.verbs.simulate import simulate
from lta_config.errors import BadInput
from lta_flight.flight_run import EXIT_STATUSES, FlightRun
from lta_flight.report.results import FlightResults
from lta_sim.readings import FlightOutcome
import pytest

RESULTS = FlightResults(success=True, path_length=6.0, search_time=12.0, closest_horizontal=0.9)


@pytest.fixture
def flown(monkeypatch, tmp_path):
    """Return a function that makes the next flight end in some way."""
    monkeypatch.setattr(verb, 'write_page', lambda bag, out: RESULTS)
    monkeypatch.setattr(verb, 'open_flight', lambda bag: bag)
    monkeypatch.setattr(verb, 'describe_exceeded_region_of_bag', lambda flight: '')
    monkeypatch.setattr(verb, 'FlightView', lambda flight: flight)
    monkeypatch.setattr(verb, 'compute_results', lambda view: RESULTS)

    def ends(outcome, sentence):
        end = FlightRun(tmp_path, tmp_path / 'bag', outcome, sentence, 2.5)
        monkeypatch.setattr(verb, 'fly_once', lambda order, watcher: end)

    return ends


@pytest.mark.parametrize('page', [True, False])
def test_every_figure_is_there_and_has_its_unit(flown, capsys, page):
    flown('reached', 'reached its goal')
    verb.fly(json=True, page=page)
    found = json.loads(capsys.readouterr().out)
    units = found.pop('units')
    assert units['pace'] == '1'
    numbers = found.keys() - {'outcome', 'bag', 'page', 'success'}
    assert units.keys() == numbers
    assert (found['path_length'], units['path_length']) == (6.0, 'm')
    assert ('page' in found) is page


def test_the_terminal_says_what_the_page_says(flown, capsys):
    flown('reached', 'reached its goal at 15.0 s')
    verb.fly(page=False)
    said = capsys.readouterr().out.splitlines()
    assert said[0] == 'The drone found the lamp and reached it in 12.0 s over 6.0 m.'
    assert said[1].startswith('Bag ')


def test_a_broken_flight_without_a_recording_is_no_bad_input(flown, monkeypatch, capsys):
    def refuse(bag, out):
        raise BadInput('There is no recording.')

    flown('failed', 'did not finish, because a node of the ROS graph failed or stalled')
    monkeypatch.setattr(verb, 'write_page', refuse)
    with pytest.raises(verb.typer.Exit) as left:
        verb.fly()
    assert left.value.exit_code == 1
    assert (
        capsys.readouterr().out
        == 'The drone did not finish, because a node of the ROS graph failed or stalled.\n'
    )


@pytest.mark.parametrize(
    ('outcome', 'status'), [('reached', 0), ('failed', 1), ('timeout', 3), ('escaped', 4)]
)
def test_the_exit_status_tells_how_the_flight_ended(flown, outcome, status):
    flown(outcome, 'ended')
    with pytest.raises(verb.typer.Exit) if status else nullcontext() as left:
        verb.fly(page=False)
    assert status == (left.value.exit_code if left else 0)


@pytest.mark.parametrize('flight_verb', [verb.fly, launch, simulate])
def test_help_tells_every_exit_status(flight_verb):
    assert set(EXIT_STATUSES) == {
        *(each.name.lower() for each in FlightOutcome), 'flown', 'failed'
    }  # fmt: skip
    _, told = flight_verb.__doc__.split('Exit status ')
    # Nodes die in a graph only
    known = {*EXIT_STATUSES.values(), 2} - ({1} if flight_verb is simulate else set())
    assert known <= {int(number) for number in re.findall(r'(\d+):', told)}
