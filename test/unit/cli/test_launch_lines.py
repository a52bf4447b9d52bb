"""What `lta launch` prints of the lines of its nodes."""

import sys

from lta_cli.verbs.launch import print_node_line
import pytest

LINE = '{"outcome": "reached", "sentence": "reached its goal", "time_s": "1", "distance_m": "2"}'


@pytest.mark.parametrize(
    ('terminal', 'text'), [(True, 'reached its goal after 1 s, 2 m from the lamp'), (False, LINE)]
)
def test_a_person_gets_words_and_a_program_the_line(monkeypatch, capsys, terminal, text):
    monkeypatch.setattr(sys.stdout, 'isatty', lambda: terminal)
    print_node_line('lta1/simulator', LINE)
    assert capsys.readouterr().out == f'[lta1/simulator] {text}\n'
