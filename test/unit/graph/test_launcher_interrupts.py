# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C while the launcher looks for ends: it waits its turn, and is never lost."""

import os
from queue import Empty
import signal
from types import SimpleNamespace

from lta_graph.launch_plan import LaunchPlan
from lta_graph.launcher import Launcher
import pytest


def test_ctrl_c_tears_no_queue_apart():
    """Raised inside `Queue.get`, an exception could leave its lock taken: then nothing ends."""
    whole = []

    def get(timeout):
        os.kill(os.getpid(), signal.SIGINT)
        whole.append(timeout)  # Python acts on a signal before the next statement
        raise Empty

    launcher = Launcher(LaunchPlan(()), lambda name, line: None)
    launcher._watch = SimpleNamespace(events=SimpleNamespace(get=get), fault=None)
    # A shell that put the tests into the background has Ctrl-C ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            launcher.wait(0.25)
    finally:
        signal.signal(signal.SIGINT, before)
    assert whole == [0.25]
