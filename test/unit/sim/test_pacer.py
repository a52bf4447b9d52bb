# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulated time keeps to the wall clock: short delays are caught up, long ones are lost."""

from lta_sim import drone
import pytest


@pytest.fixture
def wall(monkeypatch):
    """Return the wall time, which a test sets [s]."""
    now = [100.0]
    monkeypatch.setattr(drone.time, 'monotonic', lambda: now[0])
    return now


def test_delays_by_hand(wall):
    pace = drone.Pacer(0.01)
    assert pace.began == 0.0
    pace.begin()
    assert pace.began == 100.0
    assert pace.count_due(0) == 0
    wall[0] = 100.03
    assert pace.count_due(0) == 3
    assert pace.count_due(2) == 1
    wall[0] = 100.2
    assert pace.count_due(0) == drone.BURST_STEPS
    assert not pace.is_slow
    wall[0] = 101.0  # 100 steps are due, more than are caught up
    assert pace.count_due(0) == 1
    assert pace.lost == pytest.approx(0.99)
    assert pace.is_slow
    assert pace.count_due(1) == 0
    wall[0] = 101.02
    assert pace.count_due(1) == 2
    assert pace.lost == pytest.approx(0.99)
