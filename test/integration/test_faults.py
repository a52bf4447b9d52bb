# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What breaks in a flight is named, and leaves a bag that opens and no process."""

import json
import os
from pathlib import Path
import signal
import subprocess
import time

from lta_bag.reader import read_bag
from lta_config.topics import load_topic_table, robot_topic
from lta_graph.health import find_stalling_roles
import pytest

BUFFERED = 1.0  # s of flight that a dead recorder may lose
SETTLED = 2.5  # s of flight after which DDS has found everyone
TABLE = load_topic_table()


def last_line(flight):
    """Return what was said last: on a slow machine it has said before that it waits."""
    return ''.join(flight.text.splitlines()[-1:])


@pytest.mark.parametrize(
    'name',
    # For the recorder nobody waits, and its bag is torn
    ['estimator', pytest.param('recorder', marks=pytest.mark.long)],
)
def test_a_node_that_hangs_and_then_dies_is_named_twice(lta, flying, hear, tmp_path, name):
    out = tmp_path / 'out'
    flight = lta.start('fly', '--no-page', '--time', 'realtime', '--out', out)
    flying(SETTLED)
    pid = flight.node(name)

    os.kill(pid, signal.SIGSTOP)
    if name != 'recorder':  # for whom nobody waits
        hear(lambda facts: find_stalling_roles(facts.values()) == [name])
    flight.said(f'No messages arrive from {name}.')

    os.kill(pid, signal.SIGKILL)
    flight.said(f'{name} was killed by SIGKILL.')
    assert flight.end() == 1
    assert 'Traceback' not in flight.text
    assert read_bag(out / 'bag').is_complete == (name != 'recorder')


SECOND = 1_000_000_000


@pytest.mark.long
def test_what_is_a_second_old_survives_the_recorder(lta, call, flying, tmp_path, diagnostics):
    """The bag reaches to the flight time that the simulator told a wall second before."""
    out = tmp_path / 'out'
    flight = lta.start('fly', '--no-page', '--time', 'realtime', '--out', out)
    flying(2.5)
    pid = flight.node('recorder')
    flown = float(diagnostics.facts['simulator: flight'].values['time_s'])
    os.kill(pid, signal.SIGKILL)
    assert flight.end() == 1

    bag = read_bag(out / 'bag')
    old = TABLE.start_ns + int((flown - BUFFERED) * 1e9)
    for name, topic in TABLE.topics.items():
        if topic.source == 'every node' or not topic.period_ns:
            continue
        full = robot_topic('lta1', name)
        times = sorted(when for _, when, _ in bag.iterate_messages([full]))
        # In real time DDS may take a moment to bring a node and the recorder together.
        assert times[0] <= TABLE.start_ns + topic.latency_ns + SECOND, name
        # What never reached the recorder is not its loss; what it had written last is.
        assert times[-1] > old - topic.period_ns, name
    status, shown = call('bag', 'info', out / 'bag')
    assert status == 0
    facts = json.loads(call('bag', 'info', '--json', out / 'bag')[1].out)
    assert not facts['complete']
    assert facts['losses']
    assert all(loss in ' '.join(shown.out.split()) for loss in facts['losses'])


@pytest.fixture
def small_disk(tmp_path: Path):
    """Mount a disk of a few megabytes, where we may."""
    folder = tmp_path / 'disk'
    folder.mkdir()
    command = ['mount', '-t', 'tmpfs', '-o', 'size=4300k', 'tmpfs', folder]
    if subprocess.run(command, capture_output=True).returncode:
        pytest.skip('mounting a small disk needs root')
    yield folder
    subprocess.run(['umount', folder], check=True)


@pytest.mark.long
def test_a_full_disk_ends_the_flight_with_a_sentence_and_a_bag_that_opens(lta, small_disk):
    result = lta.run('fly', '--no-page', '--out', small_disk / 'out')
    assert result.returncode == 2
    (sentence,) = [line for line in result.stderr.splitlines() if line]
    assert 'the disk is nearly full' in sentence
    assert 'free disk space' in sentence
    bag = read_bag(small_disk / 'out' / 'bag')
    assert bag.is_complete
    assert bag.topics['/lta1/imu'].count > 10


@pytest.mark.parametrize(
    'seconds',
    [0.0, 0.1, 1.0, 3.0],
)
def test_ctrl_c_at_any_moment_leaves_no_process_and_no_torn_bag(lta, tmp_path, seconds):
    out = tmp_path / 'out'
    flight = lta.start('fly', '--no-page', '--out', out)
    if seconds:
        flight.holds_interrupts()
        time.sleep(seconds)  # the moments themselves are the test
    flight.interrupt()
    # Before the script has begun, the shell itself dies of the signal, which shells call 130.
    assert flight.end() in ((130,) if seconds else (130, -signal.SIGINT))
    assert (
        last_line(flight) in ('Stopped.', '') if not seconds else last_line(flight) == 'Stopped.'
    )
    assert lta.left() == []
    if (out / 'bag' / 'metadata.yaml').exists():
        assert read_bag(out / 'bag').is_complete


@pytest.mark.long
def test_a_node_that_never_comes_back_is_given_up_and_leaves(lta, flying, tmp_path):
    flight = lta.start('fly', '--no-page', '--out', tmp_path / 'out')
    flying(1.0)
    os.kill(flight.node('estimator'), signal.SIGSTOP)
    assert flight.end() == 1
    assert 'The ROS graph made no progress for 10 s and is stopped.' in flight.text
    assert lta.left() == []


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
