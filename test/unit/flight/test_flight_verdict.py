# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""How a flight went is the simulator's own last word, whatever /diagnostics carried."""

from lta_flight.flight import describe_line, FLIGHT, parse_final_status, show_status
from lta_flight.stall_watchdog import GOING, is_flying
from lta_graph.child_process import ProcessExit
from lta_graph.health import HealthFact, HealthLevel
import pytest


def ended(name, *stdout):
    return ProcessExit(name, 0, stdout, (), ends_run=True, success=True, stopped=False)


def test_the_last_line_of_the_simulator_counts():
    said = ended('simulator', 'something else', '{"outcome": "reached", "pace": "9.1"}')
    assert parse_final_status([ended('recorder', '{}'), said]) == {
        'outcome': 'reached',
        'pace': '9.1',
    }


def test_a_simulator_that_died_has_said_nothing():
    assert (
        parse_final_status([ended('simulator'), ended('estimator', '{"outcome": "reached"}')])
        is None
    )
    assert parse_final_status([ended('simulator', 'Traceback (most recent call last):')]) is None
    assert parse_final_status([ended('simulator', '[1, 2]')]) is None


def test_a_person_reads_the_last_line_in_words():
    status = '{"outcome": "timeout", "sentence": "ran out of time", "time_s": "5.00"'
    line = f'{status}, "distance_m": "6.1"}}'
    assert describe_line(line) == 'ran out of time after 5.00 s, 6.1 m from the lamp'


@pytest.mark.parametrize(
    'line', ['', 'something else', '[1, 2]', '{"outcome": "played", "unanswered": "0"}']
)
def test_any_other_line_is_printed_as_it_is(line):
    assert describe_line(line) == line


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
        def show_position(self, *told):
            shown.append(told)

    show_status({FLIGHT: HealthFact(FLIGHT, HealthLevel.OK, '', values)}, Eyes())
    assert shown == []
    whole = {'time_s': '1', 'distance_m': '2', 'pace': '3'}
    show_status({FLIGHT: HealthFact(FLIGHT, HealthLevel.OK, '', whole)}, Eyes())
    assert shown == [(1.0, 2.0, 3.0)]
    for task in GOING:
        assert is_flying({task: HealthFact(task, HealthLevel.OK, '', values)}, 'recorder')
