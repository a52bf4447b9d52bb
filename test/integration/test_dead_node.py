"""A node that is killed ends `lta launch`: named within a second, with status 1, and at once."""

import os
import signal
import time

import pytest

from .command import NODES

FAST = {('lockstep', 'controller'), ('realtime', 'estimator')}
NAMED = 1.0  # s
ENDED = 10.0  # s


@pytest.mark.parametrize(
    ('mode', 'name'),
    [
        pytest.param(mode, name, marks=() if (mode, name) in FAST else pytest.mark.long)
        for mode in ('lockstep', 'realtime')
        for name in NODES
    ],
)
def test_a_killed_node_is_named_and_ends_the_run(lta, flying, scenario, tmp_path, mode, name):
    # A goal that is not reached, so that the flight lasts
    room = scenario(radius='0.01 m', time_limit='600 s')
    words = (f'time:={mode}', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    launch = lta.start('launch', 'fly', *words)
    flying(0.5)
    os.kill(launch.node(name), signal.SIGKILL)
    killed = time.monotonic()
    named = launch.said(f'{name} was killed by SIGKILL.')
    assert launch.end() == 1
    assert named - killed < NAMED
    assert time.monotonic() - killed < ENDED
    assert 'Traceback' not in launch.text
