"""Waiting for what comes over a link, and links that are up."""

import time

from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.log_table import BLOCKS
import pytest

PATIENCE = 10.0  # s; what comes normally comes within milliseconds


@pytest.fixture
def until():
    """Return a function that waits for a condition, and returns what it found."""

    def wait(condition):
        deadline = time.monotonic() + PATIENCE
        while not (found := condition()):
            assert time.monotonic() < deadline
            time.sleep(0.005)
        return found

    return wait


@pytest.fixture
def linked():
    """Return a function that connects to a server."""

    def connected(server):
        link = CflibLink(server.uri, BLOCKS, time.time_ns)
        link.open(PATIENCE)
        return link

    return connected
