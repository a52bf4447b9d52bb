# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The sandbox in which the tests of a file run commands, one for each file."""

import pytest

from .sandbox import Sandbox


@pytest.fixture(scope='module')
def sandbox():
    with Sandbox() as found:
        yield found
