# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Clocks of others: the line through one-way stamps and through a board's answers."""

from copy import deepcopy

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.one_way_clock import OneWayClock
from lta_bridge.teensy.board_clock import BoardClock, ClockExchange
import numpy as np
import pytest

BOOT = 1_700_000_000_123_456_789  # ns of our time


def board_of(ours, drift):
    """Return the time of a board whose seconds are longer than ours by a part."""
    return round((ours - BOOT) / (1.0 + drift))


def synchronised(drift, seconds=30, mean=2e-4, seed=1, boot=BOOT):
    """Return a clock after questions at 4 Hz; delays are 0.1 ms and an exponential each way."""
    chance = np.random.default_rng(seed)
    clock = BoardClock()
    for k in range(4 * seconds):
        asked = boot + 5_000_000_000 + k * 250_000_000
        there, back = (1e9 * (1e-4 + chance.exponential(mean, 2))).astype(int)
        clock.add_exchange(
            ClockExchange(asked, board_of(asked + int(there), drift), asked + int(there + back))
        )
    return clock


DRIFT = 40e-6
SETTLED = synchronised(DRIFT)


@pytest.mark.parametrize('drift', [0.0, 40e-6, -75e-6])
@pytest.mark.parametrize('seed', [1, 2, 3])
def test_offset_and_drift_are_found_through_jitter(drift, seed):
    clock = synchronised(drift, seed=seed)
    assert clock.drift == pytest.approx(drift, abs=2e-6)
    now = BOOT + 35_000_000_000
    assert clock.to_host_time(board_of(now, drift)) == pytest.approx(now, abs=40_000)
    assert 5e-6 < clock.uncertainty < 60e-6
    assert clock.restarts == 0


def test_one_way_delay_shifts_by_half_of_it():
    """What no exchange of messages can see: the promise of the docstring, held to its figure."""
    clock = BoardClock()
    for k in range(100):
        asked = BOOT + k * 250_000_000
        clock.add_exchange(ClockExchange(asked, board_of(asked + 100_000, 0.0), asked + 1_100_000))
    assert clock.to_host_time(0) - BOOT == pytest.approx(450_000, abs=10)


def test_a_reset_board_begins_anew():
    clock = synchronised(40e-6)
    later = BOOT + 40_000_000_000
    clock.add_exchange(ClockExchange(later, 1_000_000, later + 400_000))
    assert clock.restarts == 1
    assert clock.to_host_time(1_000_000) == later + 200_000


@given(st.integers(0, 50_000_000))
def test_a_slow_answer_neither_restarts_nor_moves_the_clock(delay):
    clock = deepcopy(SETTLED)
    now = BOOT + 36_000_000_000
    before = clock.to_host_time(board_of(now, DRIFT))
    there = now + 100_000 + delay
    clock.add_exchange(ClockExchange(now, board_of(there, DRIFT), there + 100_000))
    assert clock.restarts == 0
    assert clock.to_host_time(board_of(now, DRIFT)) == pytest.approx(before, abs=40_000)


def fitted(exchanges):
    """
    Fit offset at the newest answer [s], drift and uncertainty [s] with numpy's least squares.
    """
    newest = exchanges[-1]
    last = newest.host_midpoint
    middles = np.array([(e.request_ns + e.reply_ns) // 2 - last for e in exchanges]) * 1e-9
    board = np.array([e.board - newest.board for e in exchanges]) * 1e-9
    trips = np.array([e.reply_ns - e.request_ns for e in exchanges]) * 1e-9
    # A quarter of the quickest and 20 us at best; beyond the quickest as much worse.
    deviation = 0.25 * trips.min() + 20e-6 + trips - trips.min()
    rows = np.stack([np.ones(len(board)), board], axis=1) / deviation[:, None]
    # The drift of a crystal is 0 +- 100 ppm: a row of its own.
    rows = np.concatenate([rows, [[0.0, 1.0 / 100e-6]]])
    right = np.append((middles - board) / deviation, 0.0)
    precision = rows.T @ rows
    offset, drift = np.linalg.solve(precision, rows.T @ right)
    return offset, drift, np.sqrt(np.linalg.inv(precision)[0, 0])


def delayed(count, drift=30e-6, seed=4):
    """Return exchanges at 4 Hz with random delays of some 0.1 ms."""
    chance = np.random.default_rng(seed)
    for k in range(count):
        asked = BOOT + 250_000_000 * k
        there, back = (1e9 * (1e-4 + chance.exponential(3e-4, 2))).astype(int).tolist()
        yield ClockExchange(asked, board_of(asked + there, drift), asked + there + back)


@pytest.mark.parametrize('count', [4, 20, 128, 129, 140])
def test_the_line_is_that_of_weighted_least_squares_over_the_newest_128(count):
    clock, every = BoardClock(), list(delayed(count))
    for exchange in every:
        clock.add_exchange(exchange)
    offset, drift, uncertainty = fitted(every[-128:])
    assert clock.restarts == 0
    assert clock.drift == pytest.approx(drift, rel=1e-6)
    assert clock.uncertainty == pytest.approx(uncertainty, rel=1e-6)
    newest = every[-1]
    for later in (0, 5_000_000_000):
        expected = later + 1e9 * offset + drift * later  # integers first, for precision
        assert clock.to_host_time(newest.board + later) - newest.host_midpoint == pytest.approx(
            expected, abs=1
        )


@pytest.mark.parametrize('late', [False, True])
def test_an_answer_may_contradict_by_two_milliseconds_and_three_deviations(late):
    """Round trips of 1 ms have a deviation of 270 us each, so four of them have 135 us."""
    for beyond, restarts in ((-2_000, 0), (2_000, 1)):
        clock = BoardClock()
        for k in range(4):
            clock.add_exchange(ClockExchange(k, k + 500_000, k + 1_000_000))
        assert clock.uncertainty == pytest.approx(135e-6, rel=1e-3)
        slack = 2_000_000 + 3 * 135_000 + beyond
        asked = 1_000_000 + slack if late else -1_000_000 - slack
        heard = asked if late else -1_000_000 - slack
        # By the line the board's 1.5 ms are our 1.5 ms, and its -0.5 ms our -0.5 ms.
        board = 1_000_000 if late else -1_000_000
        clock.add_exchange(ClockExchange(asked, board, heard))
        assert clock.restarts == restarts


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
