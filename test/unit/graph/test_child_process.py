# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a process inherits from the launcher."""

import os
import signal

from lta_graph.child_process import spawn_process
from lta_graph.launch_plan import LaunchProcess
import pytest


@pytest.mark.parametrize(('package', 'blocked'), [('lta_control', True), ('their_nodes', False)])
def test_only_our_nodes_start_with_sigint_blocked(package, blocked):
    """Others never unblock it, and would have to be killed."""
    process = LaunchProcess(package, 'node', 'node')
    child = spawn_process(process, 'node', ['grep', 'SigBlk', '/proc/self/status'], os.environ)
    out, _ = child.popen.communicate()
    mask = int(out.split()[1], 16)
    assert bool(mask & 1 << (signal.SIGINT - 1)) == blocked
