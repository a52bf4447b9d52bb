"""The table over many seeds: what a broken flight does to it."""

from pathlib import Path
import sys

from lta_flight.report.results import FlightResults
import pytest

FOLDER = Path(__file__).resolve().parents[2] / 'benchmark'


@pytest.fixture
def flights(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.delitem(sys.modules, 'graph', raising=False)
    import flights

    yield flights
    sys.modules.pop('flights')
    sys.modules.pop('graph')


def test_a_broken_flight_is_a_row_without_figures(flights, monkeypatch, capsys):
    def fly(order, watcher):
        raise flights.BadInput('The graph broke.')

    monkeypatch.setattr(flights, 'fly_once', fly)
    flights.main(1)
    said = capsys.readouterr()
    assert said.err == 'seed 1: The graph broke.\n'
    lines = said.out.splitlines()
    assert ' '.join(lines[0].split()) == ('seed 1 failed path_length - search_time - airspeed -')
    assert lines[1] == 'reached 0 of 1'
    assert lines[2].split() == ['path_length', 'mean', '-', '+-', '-,', 'paper', '7.3']


def test_only_what_is_known_counts(flights):
    told = [
        ('reached', FlightResults(path_length=7.0, airspeed=0.4)),
        ('reached', FlightResults(path_length=8.0)),
        ('timeout', FlightResults(path_length=90.0)),
    ]
    lines = flights.summary(told)
    assert lines[0] == 'reached 2 of 3'
    assert lines[1].split() == ['path_length', 'mean', '7.50', '+-', '0.71,', 'paper', '7.3']
    assert lines[2].split() == ['search_time', 'mean', '-', '+-', '-,', 'paper', '8.4']
    assert lines[3].split() == ['airspeed', 'mean', '0.40', '+-', '-,', 'paper', '0.5']
