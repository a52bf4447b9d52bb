# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The launch files under ROS 2's own `launch`, which the wheels do not have.

Without a folder of checkouts (ros_checkouts.py) nothing is run.
"""

import os
import signal
import sys
import time

import pytest

from .command import ROOT
from .ros_checkouts import CHECKOUTS, WITHOUT

LAUNCHES = ROOT / 'src/lta_bringup/launch'
FLY = LAUNCHES / 'fly.launch.py'
# What `ros2 launch FILE NAME:=VALUE ...` does once it has parsed its command line
LAUNCH = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
path, *words = sys.argv[1:]
service = LaunchService(argv=words)
source = AnyLaunchDescriptionSource(path)
pairs = [tuple(word.split(':=', 1)) for word in words]
service.include_launch_description(
    LaunchDescription([IncludeLaunchDescription(source, launch_arguments=pairs)])
)
sys.exit(service.run())
"""
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not CHECKOUTS, reason=WITHOUT),
]


@pytest.fixture
def ros2_launch(lta, genuine_ros):
    """Return a function that starts a launch file."""

    def start(*words):
        return lta.start(*words, program=(sys.executable, '-c', LAUNCH), **genuine_ros)

    return start


@pytest.mark.parametrize(('mode', 'name'), [('lockstep', 'estimator'), ('realtime', 'recorder')])
def test_a_killed_node_is_named_and_ends_the_run(
    ros2_launch, flying, scenario, tmp_path, mode, name
):
    room = scenario(radius='0.01 m', time_limit='600 s')
    run = ros2_launch(FLY, f'time:={mode}', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    flying(0.5)
    os.kill(run.node(name), signal.SIGKILL)
    killed = time.monotonic()
    named = run.said(f'{name} was killed by SIGKILL, which ends the run.')
    assert run.end() == 1
    assert named - killed < 1.0
    assert time.monotonic() - killed < 10.0
    assert 'Traceback' not in run.text


def test_a_node_that_hangs_is_named_on_the_console_and_its_return_too(
    ros2_launch, flying, scenario, tmp_path
):
    room = scenario(radius='0.01 m', time_limit='600 s')
    run = ros2_launch(FLY, f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    flying(0.5)
    os.kill(run.node('estimator'), signal.SIGSTOP)
    run.said('[lta1.controller]: inputs: waiting for messages on airspeed, odom from estimator')
    os.kill(run.node('estimator'), signal.SIGCONT)
    run.said('[lta1.controller]: inputs: OK again, all inputs arrive')
    run.interrupt()
    assert run.end() == 0


@pytest.mark.parametrize(('name', 'last'), [('fly', 'description'), ('fleet', 'recorder')])
@pytest.mark.parametrize(('number', 'status'), [(signal.SIGINT, 0), (signal.SIGTERM, 1)])
def test_an_early_stop_leaves_no_traceback_no_node_and_no_file(
    ros2_launch, lta, tmp_path, monkeypatch, name, last, number, status
):
    """As long as launch starts processes, it waits without end for one that is killed."""
    monkeypatch.setenv('TMPDIR', str(tmp_path))
    run = ros2_launch(LAUNCHES / f'{name}.launch.py', f'bag:={tmp_path / "bag"}')
    run.said(f'[{last}-')
    if number == signal.SIGINT:
        run.interrupt()
    else:  # the nodes do not get it
        os.kill(run.popen.pid, number)
    assert run.end() == status
    assert 'Traceback' not in run.text
    assert lta.left() == []
    assert list(tmp_path.rglob('*launch_*')) == []


@pytest.mark.parametrize('name', ['fly', 'fleet'])
def test_a_flight_to_its_end_is_status_0(ros2_launch, scenario, tmp_path, monkeypatch, name):
    monkeypatch.setenv('TMPDIR', str(tmp_path))
    room = scenario(time_limit='2 s')
    words = ('time:=lockstep', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    run = ros2_launch(LAUNCHES / f'{name}.launch.py', *words)
    assert run.end() == 0, run.text
    assert (tmp_path / 'bag/metadata.yaml').exists()
    assert list(tmp_path.rglob('*launch_*')) == []


@pytest.mark.parametrize(
    ('word', 'sentence'),
    [
        ('vehicle:=nope', "Unknown vehicle 'nope'; known: beavis"),
        ('seed:=x', "The launch argument seed is 'x', but must be a whole number."),
        ('seed:=-1', 'The seed is -1, but must be a whole number'),
        ('strateg:=bag', "Unknown launch argument 'strateg'"),
        ('strategy:=up', "Unknown strategy 'up'; known: bag, des, dga, homing."),
    ],
)
def test_a_wrong_argument_is_one_sentence_and_starts_nothing(ros2_launch, word, sentence):
    run = ros2_launch(FLY, word)
    assert run.end() == 1
    (line,) = [line for line in run.text.splitlines() if 'Caught exception' in line]
    assert sentence in line
    assert 'process started' not in run.text


def test_a_program_of_an_including_file_may_end(ros2_launch, scenario, tmp_path):
    room = scenario(time_limit='2 s')
    path = tmp_path / 'lab.launch.yaml'
    path.write_text(
        f'launch:\n  - include: {{file: {FLY}}}\n  - executable: {{cmd: "true"}}\n', 'utf-8'
    )
    run = ros2_launch(path, 'time:=lockstep', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    assert run.end() == 0, run.text
    assert (tmp_path / 'bag/metadata.yaml').exists()
