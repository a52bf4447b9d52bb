# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""An event without a thread."""

import pytest


class EventAfter:
    """An event that is set after some number of waits and records their time-outs."""

    def __init__(self, waits):
        self.left, self.waited = waits, []

    def is_set(self):
        return self.left == 0

    def wait(self, seconds):
        self.left -= 1
        self.waited.append(seconds)


@pytest.fixture
def event_after():
    """Return a function that makes an event which is set after some number of waits."""
    return EventAfter
