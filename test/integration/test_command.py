"""
What people type wrong gets one sentence and exit status 2 before anything starts.

Each is called in this process; what a process of its own may change is tried with a few.
"""

import json
from pathlib import Path
import subprocess
import sys
import time

from lta_cli.doctor import CHECKS
from lta_config.compilation.kernel_cache import cache_root
from lta_graph.launches import FLY
import pytest
from waiting import PATIENCE

ROOT = Path(__file__).resolve().parents[2]

# Said by a process of its own, three by the node that `run` becomes; the others are in test/golden
COMMANDS = {
    'vehicle': (['fly', '--vehicle', 'zeppelin'], "Unknown vehicle 'zeppelin'; known: "),
    'node word': (
        ['run', 'lta_vlc', 'demodulator', '--loud'],
        "does not know the argument '--loud'",
    ),
    'node parameter': (
        ['run', 'lta_vlc', 'demodulator', '--ros-args', '-p', 'freq:=175.0'],
        "demodulator has no parameter 'freq'; known: frequency, ",
    ),
    'parameter file': (
        ['run', 'lta_vlc', 'demodulator', '--ros-args', '--params-file', '/no/such'],
        "ROS cannot start: Failed to parse ROS arguments: Couldn't parse params file",
    ),
}


def sentence_of(status, out, errors):
    """Return the one sentence of a command that must have been refused."""
    assert status == 2, errors
    assert out.strip() == ''
    (sentence,) = [line for line in errors.splitlines() if line.strip()]
    assert sentence.endswith('.')
    return sentence


@pytest.fixture
def refused(call):
    """Return a function that calls what must be refused, and returns its one sentence."""

    def refused(*arguments):
        status, said = call(*arguments)
        return sentence_of(status, said.out, said.err)

    return refused


def rejected(lta, *arguments):
    """Run a process that must be refused, and return its one sentence."""
    result = lta.run(*arguments)
    return sentence_of(result.returncode, result.stdout, result.stderr)


def rows(table, names, short=()):
    """Return some rows of a table as parameters; all but `short` are long, if any are short."""
    marks = {name: pytest.mark.long if short and name not in short else () for name in names}
    return [pytest.param(*table[name], id=name, marks=marks[name]) for name in names]


@pytest.mark.parametrize(('arguments', 'words'), rows(COMMANDS, COMMANDS))
@pytest.mark.long
def test_a_mistyped_process_is_one_sentence(lta, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert words in rejected(lta, *arguments)
    assert list(tmp_path.iterdir()) == [], 'nothing may be made or started'


def test_a_domain_that_cannot_be_is_one_sentence(refused, tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', 'home')
    assert "ROS_DOMAIN_ID is 'home'" in refused('fly', '--out', tmp_path / 'out')
    assert not (tmp_path / 'out').exists()


@pytest.mark.long
def test_two_flights_on_one_domain_are_refused_and_the_first_flies_on(lta, flying, tmp_path):
    first = lta.start('fly', '--no-page', '--out', tmp_path / 'first')
    flying(0.1)
    sentence = rejected(lta, 'fly', '--out', tmp_path / 'second')
    assert 'lta1 is flying on ROS domain' in sentence
    assert not (tmp_path / 'second').exists()
    assert first.popen.poll() is None
    first.interrupt()
    assert first.end() == 130


@pytest.mark.parametrize('seconds', [pytest.param(0.5, marks=pytest.mark.long), 0.8, 1.1])
def test_ctrl_c_while_a_node_loads_is_no_traceback(lta, seconds):
    command = lta.start('run', 'lta_vlc', 'demodulator')
    command.holds_interrupts()
    time.sleep(seconds)  # the moments themselves are the test
    command.interrupt()
    assert command.end() in (0, 130)
    assert command.text in ('', 'Stopped.')


SPOILS = """
import os, signal, sys
from lta_cli import app, command

def load(words):
    {loading}
    return lambda *_, **__: {running}

def spoil():
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        raise ImportError('initialization failed') from None

app.build_app = load
command.main()
"""


@pytest.mark.parametrize('when', ['loading', 'running'])
def test_ctrl_c_that_an_extension_turns_into_another_error_still_stops(when):
    """Importing some compiled modules of SciPy turns a KeyboardInterrupt into an ImportError."""
    code = SPOILS.format(**{'loading': 'pass', 'running': '0'} | {when: 'spoil()'})
    left = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert (left.returncode, left.stderr) == (130, 'Stopped.\n')


@pytest.mark.long
def test_a_lonely_node_says_what_it_waits_for_and_writes_no_log_file(lta, tmp_path, monkeypatch):
    # Compiled code goes where it always does.
    monkeypatch.setenv('XDG_CACHE_HOME', str(cache_root().parents[1]))
    monkeypatch.setenv('HOME', str(tmp_path))
    command = lta.start('run', 'lta_vlc', 'demodulator')
    command.said('waiting for messages on light/beacon, photodiodes from navigator, vehicle')
    command.interrupt()
    assert command.end() == 0
    assert list(tmp_path.iterdir()) == []


def test_another_middleware_is_refused_before_it_ends_the_process(lta, monkeypatch):
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_none')
    assert "RMW_IMPLEMENTATION is 'rmw_none', which is not" in rejected(lta, 'doctor')


VERBS = {
    ' '.join(words): (words,)
    for words in ([], ['fly'], ['launch'], ['run'], ['bag'], ['bag', 'info'], ['doctor'])
}


@pytest.mark.parametrize('verb', rows(VERBS, VERBS))
def test_every_verb_explains_itself(call, verb):
    status, said = call(*verb, '--help')
    assert (status, said.err) == (0, '')
    assert 'Usage:' in said.out
    assert len(said.out.splitlines()) > 8


def test_launch_shows_the_arguments_of_a_file(call):
    status, said = call('launch', 'fly', '--show-args')
    assert (status, said.err) == (0, '')
    for argument in FLY.list_arguments():
        assert argument.name in said.out


def test_the_doctor_ends_well_or_says_what_to_do(lta):
    result = lta.run('doctor', '--json')
    checks = json.loads(result.stdout)
    assert [check['name'] for check in checks] == list(CHECKS)
    failed = [check for check in checks if check['state'] == 'fail']
    assert result.returncode == (1 if failed else 0)
    assert all(check['remedy'] for check in failed)
