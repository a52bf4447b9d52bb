# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Signals as a child has them that a person starts in a terminal."""

import signal


def heed_signals() -> None:
    """Heed Ctrl-C and a shut terminal in a child, even where the tests run under nohup."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
