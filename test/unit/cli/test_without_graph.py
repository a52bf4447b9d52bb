# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta` does where rclpy is not installed, as in an environment that has the wheel alone."""

import subprocess
import sys

import pytest

HIDE = "import sys; sys.modules['rclpy'] = sys.modules['rcl_interfaces'] = None; "
COMMAND = f'{HIDE}from lta_cli.command import main; main()'
LOAD_ALL = f"""{HIDE}
from lta_cli.app import VERBS, VerbGroup
from lta_flight.simulate import require_messages

for item in VERBS.values():
    for verb in item.verbs.values() if isinstance(item, VerbGroup) else [item]:
        if not verb.needs_graph:
            verb.load()
require_messages()
"""


def run_python(script, *words):
    return subprocess.run(
        [sys.executable, '-P', '-c', script, *words], capture_output=True, text=True
    )


def test_all_other_verbs_and_the_recorder_load():
    done = run_python(LOAD_ALL)
    assert done.returncode == 0, done.stderr


def test_the_list_of_verbs_shows_those_that_work():
    listed = run_python(COMMAND, '--help').stdout
    verbs = {
        line.split()[1] for line in listed.splitlines() if line.startswith('│ ') and line[2] != ' '
    }
    assert {'simulate', 'discover', 'import'} <= verbs
    assert verbs.isdisjoint({'fly', 'replay', 'launch', 'call'})
    assert 'need ROS 2: get the LTA sources' in ' '.join(listed.split())


@pytest.mark.parametrize(
    'words', [['fly'], ['replay', '--help'], ['launch', 'fly'], ['call', 'x']]
)
def test_a_verb_of_the_graph_says_at_once_what_it_needs(words):
    done = run_python(COMMAND, *words)
    assert done.returncode == 2
    assert done.stderr == (
        f"'lta {words[0]}' needs ROS 2, which is not installed; get the LTA sources, "
        'run "make build" there, and use ./lta.\n'
    )


def test_a_bag_needs_the_messages_before_anything_is_compiled():
    script = COMMAND.replace('rcl_interfaces', 'builtin_interfaces')
    done = run_python(script, 'simulate')
    assert done.returncode == 2
    assert done.stdout == ''
    assert done.stderr == (
        "A bag needs the messages of ROS 2, and 'builtin_interfaces' is not installed; install "
        'ros-jazzy-common-interfaces with pip (Linux on x86-64), or simulate with --no-bag.\n'
    )
