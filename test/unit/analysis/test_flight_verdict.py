"""How a flight went is the simulator's own last word, whatever /diagnostics carried."""

from lta_analysis.flight import verdict
from lta_graph.child import Ended


def ended(name, *stdout):
    return Ended(name, 0, stdout, (), True, False)


def test_the_last_line_of_the_simulator_counts():
    said = ended('simulator', 'something else', '{"outcome": "reached", "pace": "9.1"}')
    assert verdict([ended('recorder', '{}'), said]) == {'outcome': 'reached', 'pace': '9.1'}


def test_a_simulator_that_died_has_said_nothing():
    assert verdict([ended('simulator'), ended('estimator', '{"outcome": "reached"}')]) is None
    assert verdict([ended('simulator', 'Traceback (most recent call last):')]) is None
    assert verdict([ended('simulator', '[1, 2]')]) is None
