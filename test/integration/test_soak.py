# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A minute of `make campaign soak`: the graph flies from lantern to lantern and loses nothing."""

from campaigns.soak import NODES, soaked
import pytest

pytestmark = pytest.mark.long

SECONDS = 60.0  # of wall time


def test_a_short_soak_is_as_it_should_be(lta, tmp_path):
    seen = soaked(lta, tmp_path, SECONDS)
    assert seen.wrong == []
    assert set(seen.memory) == set(NODES)
    assert seen.legs > 0
    assert seen.flown > SECONDS  # lockstep is faster than real time
    assert min(seen.paces) > 0.0
