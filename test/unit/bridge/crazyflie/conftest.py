# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Links that are up."""

import time

from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
import pytest
from waiting import PATIENCE


@pytest.fixture
def linked():
    """Return a function that connects to a server."""

    def connected(server):
        link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
        link.open(PATIENCE)
        return link

    return connected
