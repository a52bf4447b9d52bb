"""A start that fails or is interrupted: a few lines, no traceback, nothing left behind."""

import os
import signal
import socket
import time

import pytest

LINES = 3  # at most
LAUNCH_FLY = ('launch', 'fly', 'time:=realtime')
LAUNCH_FLEET = ('launch', 'fleet')
MOMENTS = [0.2, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0]  # s after the start


@pytest.fixture
def busy_port():
    with socket.socket() as held:
        held.bind(('127.0.0.1', 0))
        held.listen()
        yield held.getsockname()[1]


@pytest.mark.parametrize(
    'words',
    [
        (*LAUNCH_FLY, 'bag:=full'),
        pytest.param((*LAUNCH_FLY, 'source:=replay', 'replay:=/nowhere'), marks=pytest.mark.long),
        pytest.param((*LAUNCH_FLY, 'live:=true', 'live_port:=BUSY'), marks=pytest.mark.long),
        pytest.param((*LAUNCH_FLEET, 'bag:=full'), marks=pytest.mark.long),
        pytest.param(('fly', '--out', 'full'), marks=pytest.mark.long),
        pytest.param(('fly', '--live', '--live-port', 'BUSY'), marks=pytest.mark.long),
    ],
)
def test_bad_arguments_start_nothing(lta, busy_port, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    full = tmp_path / 'full'
    full.mkdir()
    (full / 'kept').touch()
    done = lta.run(*(word.replace('BUSY', str(busy_port)) for word in words))
    assert (done.returncode, done.stdout) == (2, '')
    assert done.stderr.count('\n') == 1
    assert [path.name for path in tmp_path.rglob('*')] == ['full', 'kept']


@pytest.mark.parametrize(
    'moment', [4.0, *(pytest.param(m, marks=pytest.mark.long) for m in MOMENTS)]
)
@pytest.mark.parametrize(
    'words',
    [
        LAUNCH_FLY,
        pytest.param(LAUNCH_FLEET, marks=pytest.mark.long),
        pytest.param(('fly',), marks=pytest.mark.long),
    ],
)
def test_an_early_ctrl_c_is_answered_in_a_few_lines(lta, tmp_path, monkeypatch, words, moment):
    monkeypatch.chdir(tmp_path)
    command = lta.start(*words)
    command.holds_interrupts()
    time.sleep(moment)
    command.interrupt()
    assert command.end() == 130
    assert 'Traceback' not in command.text
    assert len(command.text.splitlines()) <= LINES, command.text
    for bag in tmp_path.rglob('bag'):
        assert {path.name for path in bag.iterdir()} == {'bag_0.mcap', 'metadata.yaml'}


@pytest.mark.long
def test_fly_names_the_bag_of_an_interrupted_flight(lta, flying, scenario, tmp_path):
    room = scenario(radius='0.01 m', time_limit='600 s')
    command = lta.start('fly', '--time', 'realtime', '--scenario', room, '--out', tmp_path / 'run')
    flying(0.5)
    os.kill(command.popen.pid, signal.SIGINT)
    assert command.end() == 130
    bag = tmp_path / 'run' / 'bag'
    assert f'Bag  {bag}  (its page: ' in command.text
    assert lta.run('report', bag).returncode == 0
