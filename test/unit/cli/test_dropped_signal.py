# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A signal that a library written in C drops is sent again."""

import signal
import subprocess
import sys

from waiting import PATIENCE

# A compiler calls back into Python, and the signal arrives there: ctypes prints and forgets it
PROGRAM = """
import ctypes, os, signal, time
from lta_cli import app, command

def work(heed):
    heed()

    @ctypes.CFUNCTYPE(None)
    def call_back():
        os.kill(os.getpid(), signal.SIGTERM)
        for _ in range(1000):
            pass

    try:
        call_back()
        while True:
            time.sleep(0.01)
    except KeyboardInterrupt:
        return app.STOPPED

app.run_command_line = work
command.main()
"""


def test_a_signal_in_a_callback_from_c_stops_the_command() -> None:
    done = subprocess.run(
        [sys.executable, '-c', PROGRAM],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 128 + signal.SIGTERM
    assert done.stderr == 'Stopped.\n'
