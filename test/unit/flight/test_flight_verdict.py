"""How a flight went is the simulator's own last word, whatever /diagnostics carried."""

from lta_flight.blame import flying, GOING
from lta_flight.flight import FLIGHT, show, verdict
from lta_graph.child import Ended
from lta_graph.health import Fact, Level
import pytest


def ended(name, *stdout):
    return Ended(name, 0, stdout, (), True, False)


def test_the_last_line_of_the_simulator_counts():
    said = ended('simulator', 'something else', '{"outcome": "reached", "pace": "9.1"}')
    assert verdict([ended('recorder', '{}'), said]) == {'outcome': 'reached', 'pace': '9.1'}


def test_a_simulator_that_died_has_said_nothing():
    assert verdict([ended('simulator'), ended('estimator', '{"outcome": "reached"}')]) is None
    assert verdict([ended('simulator', 'Traceback (most recent call last):')]) is None
    assert verdict([ended('simulator', '[1, 2]')]) is None


@pytest.mark.parametrize(
    'values',
    [
        {},
        {'time_s': '1', 'distance_m': '2'},
        {'time_s': 'soon', 'distance_m': '2', 'pace': '3'},
        {'time_s': 'nan', 'distance_m': '2', 'pace': '3'},
    ],
)
def test_whatever_somebody_says_in_its_name_ends_nothing(values):
    shown = []

    class Eyes:
        def at(self, *told):
            shown.append(told)

    show({FLIGHT: Fact(FLIGHT, Level.OK, '', values)}, Eyes())
    assert shown == []
    whole = {'time_s': '1', 'distance_m': '2', 'pace': '3'}
    show({FLIGHT: Fact(FLIGHT, Level.OK, '', whole)}, Eyes())
    assert shown == [(1.0, 2.0, 3.0)]
    for task in GOING:
        assert flying({task: Fact(task, Level.OK, '', values)}, 'recorder')
