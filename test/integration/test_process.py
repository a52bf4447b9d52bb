# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""How a node leaves: by its status and its words."""

import signal
import subprocess
import sys

import pytest
from signals import heed_signals
from waiting import PATIENCE

CODE = """
from lta_config.errors import BadInput
from lta_graph.ros.node import GraphNode
from lta_graph.ros.process import run_node

class Node(GraphNode):
    def __init__(self):
        super().__init__('energy_monitor')
        {made}

    def run(self):
        print('worked', end='')
        {act}
        yield from ()

run_node(Node, ['node'])
"""


@pytest.mark.parametrize(
    ('act', 'status', 'said'),
    [
        ('pass', 0, ''),
        ("raise BadInput('No air here.')", 2, 'No air here.\n'),
        ("raise OSError('torn')", 1, 'OSError: torn\n'),
        ('import os; os.kill(os.getpid(), 1); assert not self.running', 0, ''),  # hung up
    ],
)
def test_it_says_all_and_leaves_by_its_status(domain_id, act, status, said):
    left = subprocess.run(
        [sys.executable, '-c', CODE.format(made='pass', act=act)],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
        preexec_fn=heed_signals,
    )  # fmt: skip
    assert (left.returncode, left.stdout) == (status, 'worked')
    assert left.stderr.endswith(said)
    assert bool(said) == bool(left.stderr)


TORN = """from lta_graph.ros import process

        def fail(*_):
            raise OSError('torn')

        process.spin_for = fail
        self.publish_health = lambda: print([fact.message for fact in self.health.facts])
        yield"""


def test_what_the_executor_raises_outside_of_callbacks_is_reported(domain_id):
    left = subprocess.run(
        [sys.executable, '-c', CODE.format(made='pass', act=TORN)],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert left.returncode == 1
    assert "'broke: OSError: torn'" in left.stdout
    assert left.stderr.endswith('OSError: torn\n')


def test_under_nohup_it_goes_on_when_the_terminal_is_shut(domain_id):
    act = 'import os; os.kill(os.getpid(), 1); assert self.running'
    left = subprocess.run(
        ['nohup', sys.executable, '-c', CODE.format(made='pass', act=act)],
        capture_output=True, text=True, timeout=PATIENCE, check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert (left.returncode, left.stdout) == (0, 'worked'), left.stderr


LOST = """import os
        try:
            os.kill(os.getpid(), 2)
        except KeyboardInterrupt:
            pass
"""


def test_ctrl_c_while_a_node_is_made_is_not_lost(domain_id):
    """A C extension may drop the exception that a signal raises within it, as `LOST` does."""
    left = subprocess.run(
        [sys.executable, '-c', CODE.format(made=LOST, act='pass')],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
        preexec_fn=heed_signals,
    )  # fmt: skip
    assert (left.returncode, left.stdout, left.stderr) == (130, '', '')


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_a_node_is_made_is_answered_once_it_can_close(domain_id, number):
    made = f'import os; os.kill(os.getpid(), {number})'
    left = subprocess.run(
        [sys.executable, '-c', CODE.format(made=made, act='pass')],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
        preexec_fn=heed_signals,
    )  # fmt: skip
    assert (left.returncode, left.stdout, left.stderr) == (128 + number, '', '')


HANGING = """
        import threading
        self.destroy_node = lambda: threading.Event().wait()
"""


@pytest.mark.parametrize(
    ('act', 'status', 'words'), [('pass', 0, ''), ("raise BadInput('No air.')", 2, 'No air.\n')]
)
def test_a_node_exits_with_its_status_where_dds_does_not_shut_down(domain_id, act, status, words):
    left = subprocess.run(
        [sys.executable, '-c', CODE.format(made=HANGING, act=act)],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert (left.returncode, left.stdout) == (status, 'worked')
    assert left.stderr.startswith(f'{words}DDS did not shut down within 5 s;')
    assert 'in run' in left.stderr  # the stack that hangs
