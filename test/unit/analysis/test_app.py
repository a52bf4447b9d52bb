"""The command line around the verbs."""

import sys

import pytest

app_module = pytest.importorskip('lta_analysis.app', exc_type=ImportError)


@pytest.fixture
def call(monkeypatch, capsys):
    def call(*words):
        monkeypatch.setattr(sys, 'argv', ['lta', *words])
        monkeypatch.setenv('COLUMNS', '80')
        return app_module.status(), capsys.readouterr()

    return call


@pytest.mark.parametrize('words', [(), ('bag',)])
def test_without_a_verb_it_helps(call, words):
    status, said = call(*words)
    assert (status, said.err) == (0, '')
    assert 'COMMAND [ARGS]...' in said.out


def test_it_tells_its_version(call, monkeypatch):
    monkeypatch.setattr(app_module, 'version', {'lta-analysis': '1.2.3'}.get)
    status, said = call('--version')
    assert (status, said.out) == (0, 'lta 1.2.3\n')


def test_help_flows_at_any_width(call):
    _, said = call('fly', '--help')
    text = said.out.partition('In lockstep')[0].splitlines()
    whole = [line.strip() for line in text if line.strip().startswith('Fly:')]
    assert whole == [
        'Fly: the whole graph, one process a node, recorded to MCAP and reported as a'
    ]


def test_an_empty_folder_is_refused(call):
    status, said = call('fly', '--out', '')
    assert status == 2
    assert said.err == "Invalid value for '--out': it is empty; give a folder; see --help.\n"
