# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The command as a process, and the doctor that proves DDS with two of them."""

import json
import os
from pathlib import Path
import subprocess
import sys
import time

from lta_cli.doctor import dds, MACHINE_CHECKS
from lta_config.compilation.kernel_cache import cache_root
import pytest
from signals import heed_signals
from waiting import PATIENCE

ROOT = Path(__file__).resolve().parents[2]


def test_a_domain_that_cannot_be_is_one_sentence(call, tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', 'home')
    status, said = call('fly', '--out', tmp_path / 'out')
    assert (status, said.out, said.err.count('\n')) == (2, '', 1)
    assert "ROS_DOMAIN_ID is 'home'" in said.err
    assert not (tmp_path / 'out').exists()


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
        [sys.executable, '-c', code],
        capture_output=True, text=True, timeout=PATIENCE, check=False, preexec_fn=heed_signals,
    )  # fmt: skip
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
    result = lta.run('doctor')
    assert (result.returncode, result.stdout, result.stderr.count('\n')) == (2, '', 1)
    assert "RMW_IMPLEMENTATION is 'rmw_none', which is not" in result.stderr


def test_the_doctor_ends_well_or_says_what_to_do(lta):
    result = lta.run('doctor', '--json')
    checks = json.loads(result.stdout)
    assert [check['name'] for check in checks] == list(MACHINE_CHECKS)
    failed = [check for check in checks if check['state'] == 'fail']
    assert result.returncode == (1 if failed else 0)
    assert all(check['remedy'] for check in failed)


@pytest.fixture(autouse=True)
def _source_path(monkeypatch):
    monkeypatch.setenv('PYTHONPATH', os.pathsep.join(path for path in sys.path if path))


def test_two_processes_talk(monkeypatch):
    for limit in ('DEADLINE', 'SLOW_EXCHANGE'):  # how fast it is, is the machine's
        monkeypatch.setattr(dds, limit, PATIENCE)
    check = dds.check_message_exchange()
    assert check.state == 'ok', check.found
    assert check.found.startswith('two processes discovered each other in ')


def test_nobody_answers():
    command = [sys.executable, '-m', 'lta_graph.ros.echo', 'ask', '--seconds', '0.5']
    result = subprocess.run(command, capture_output=True, timeout=PATIENCE)
    assert (result.returncode, result.stdout) == (1, b'')


def test_a_process_that_cannot_start_says_why(monkeypatch):
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_of_another_world')
    check = dds.check_message_exchange()
    assert check.state == 'fail'
    assert check.found
    assert check.remedy
