# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta launch` prints of the lines of its nodes, and its exit status."""

from pathlib import Path
import sys

from lta_cli.verbs import launch as verb
from lta_cli.verbs.launch import print_node_line
from lta_flight.graph import list_bags
from lta_graph.child_process import ProcessExit
import pytest

LINE = '{"outcome": "reached", "sentence": "reached its goal", "time_s": "1", "distance_m": "2"}'


@pytest.mark.parametrize(
    ('terminal', 'text'), [(True, 'reached its goal after 1 s, 2 m from the lamp'), (False, LINE)]
)
def test_a_person_gets_words_and_a_program_the_line(monkeypatch, capsys, terminal, text):
    monkeypatch.setattr(sys.stdout, 'isatty', lambda: terminal)
    print_node_line('lta1/simulator', LINE)
    assert capsys.readouterr().out == f'[lta1/simulator] {text}\n'


def test_of_several_drones_a_person_is_told_whose_flight_it_was(monkeypatch, capsys):
    monkeypatch.setattr(sys.stdout, 'isatty', lambda: True)
    print_node_line('simulator', LINE.replace('{', '{"robot": "lta2", '))
    text = 'lta2 reached its goal after 1 s, 2 m from the lamp'
    assert capsys.readouterr().out == f'[simulator] {text}\n'


@pytest.mark.parametrize(
    ('outcomes', 'status'),
    [
        ((), 0),
        (('reached', 'reached'), 0),
        (('reached', 'timeout'), 3),
        (('escaped', 'timeout'), 4),
        (('flying',), 0),
        (('played',), 0),  # of a recording
    ],
)
def test_the_exit_status_is_that_of_the_worst_flight(call, monkeypatch, outcomes, status):
    def run_graph(_plan, on_line, _say):
        for k, outcome in enumerate(outcomes):
            on_line(f'lta{k}/simulator', f'{{"outcome": "{outcome}"}}')
        return ProcessExit('simulator', 0, (), (), ends_run=True, success=True, stopped=False)

    monkeypatch.setattr(verb, 'run_graph', run_graph)
    assert call('launch', 'fly', 'record:=false')[0] == status


@pytest.mark.parametrize(
    ('words', 'bags'),
    [
        ((), ['runs/bag-2']),
        (('bag:=runs/bag',), ['runs/bag']),  # which the recorder refuses, as it was asked for
        (('record:=false',), []),
    ],
)
def test_a_bag_without_a_name_is_a_new_folder(call, monkeypatch, tmp_path, words, bags):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'runs/bag').mkdir(parents=True)
    plans = []

    def run_graph(plan, _on_line, _say):
        plans.append(plan)
        return ProcessExit('simulator', 0, (), (), ends_run=True, success=True, stopped=False)

    monkeypatch.setattr(verb, 'run_graph', run_graph)
    assert call('launch', 'fly', *words)[0] == 0
    assert list_bags(plans[0]) == list(map(Path, bags))
    assert not (tmp_path / 'runs/bag-2').exists()  # nothing was recorded
