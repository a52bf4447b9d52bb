# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A device clock from arrival times alone: the line below the fastest messages."""

from lta_bridge.one_way_clock import OneWayClock
import pytest


def heard(clock, *pairs):
    """Feed pairs of device time and arrival time; return the last stamp [ns]."""
    return [clock.stamp_arrival(device, arrival) for device, arrival in pairs][-1]


def test_a_drift_is_told_after_five_seconds_and_is_that_of_a_crystal():
    """A drift of 100 ppm is accepted; one of 1000 ppm is beyond any crystal."""
    for ppm, drift in ((100, 100e-6), (-100, -100e-6), (1000, 200e-6), (-1000, -200e-6)):
        clock, drifts = OneWayClock(), []
        for k in range(6):
            clock.stamp_arrival(k * 10**9, k * (10**9 - 1000 * ppm))
            drifts.append(clock.drift)
        assert drifts[:4] == [0.0] * 4
        assert drifts[4:] == pytest.approx([drift] * 2, rel=1e-6)
        # The line goes on with its slope; a steeper one passes under the lowest of all messages.
        ahead = min(-1000 * ppm * k - round(1e9 * drift * (15 - k)) for k in (0, 5))
        assert clock.to_graph_time(15 * 10**9) - 15 * 10**9 == pytest.approx(ahead, abs=10)


def test_the_fastest_of_the_last_sixty_seconds_counts():
    """The line passes below a message that is 50 ms faster than all others, for 60 s."""
    clock = OneWayClock()
    heard(clock, (0, 0), *((k * 10**9, k * 10**9 + 50_000_000) for k in range(1, 60)))
    assert clock.to_graph_time(59 * 10**9) < 59 * 10**9 + 49_000_000
    heard(clock, (60 * 10**9, 60 * 10**9 + 50_000_000))
    assert clock.to_graph_time(60 * 10**9) == 60 * 10**9 + 50_000_000
    assert clock.drift == pytest.approx(0.0, abs=1e-12)


def test_within_a_second_a_faster_message_moves_the_line_and_a_slower_one_does_not():
    clock = OneWayClock()
    assert heard(clock, (0, 7_000), (500, 6_500)) == 6_500  # the 6 us of transport delay
    assert heard(clock, (1000, 9_000)) == 7_000
    clock.one_way_ns = 250
    assert heard(clock, (2000, 9_000)) == 7_750
    assert clock.drift == 0.0


@pytest.mark.parametrize(
    ('late_ns', 'restarts'),
    [(-500_000_000, 0), (-500_000_001, 1), (10_000_000_000, 0), (10_000_000_001, 1)],
)
def test_half_a_second_early_or_ten_late_are_of_another_clock(late_ns, restarts):
    clock = OneWayClock()
    assert (clock.drift, clock.restarts) == (0.0, 0)
    heard(clock, (0, 10**10), (1000, 10**10 + 1000 + late_ns))
    assert clock.restarts == restarts
    if restarts:
        assert clock.to_graph_time(2000) == 10**10 + 2000 + late_ns
