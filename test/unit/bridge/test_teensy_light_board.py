# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The light board through the bridge's core: light in, the same light out in our time."""

from frame_faults import FrameFaults
from light_frames import build_frame
from lta_bridge.teensy.block_assembler import FrameParser
from lta_bridge.teensy.light_board import LightBoard
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import EmulatedBoard
import numpy as np
import pytest

LIGHT = load_topic_table().light
BOOT = 1_700_000_000_000_000_000
SECONDS = 3
SAMPLES = np.random.default_rng(1).integers(0, 4096, (10_000 * SECONDS, 8)).astype(np.uint16)


def flown(board, samples=SAMPLES, start=BOOT + 2_000_000_000, link=None):
    """Let a board send its light, ten times a second; return the bridge and its blocks."""
    link = link or LightBoard(LIGHT, 8)
    found = []
    for k in range(-5, len(samples) // 1000):  # half a second of answers comes first
        now = start + k * 100_000_000
        answer = board.answer_timesync(link.compose_due_messages(now), now + 150_000)
        found += link.receive_bytes(answer, now + 300_000)
        if k >= 0:
            status = board.encode_status() if k % 10 == 0 else b''
            light = board.encode_light(samples[1000 * k : 1000 * (k + 1)])
            found += link.receive_bytes(status + light, now + 100_000_000)
    return link, found


def test_the_light_is_that_of_the_board_sample_by_sample_in_our_time():
    board = EmulatedBoard(BOOT, drift=30e-6)
    link, found = flown(board)
    assert len(found) == 10 * SECONDS
    for k, block in enumerate(found):
        assert (block.samples == SAMPLES[1000 * k : 1000 * (k + 1)]).all()
        assert block.stamp_ns == pytest.approx(board.row_time_ns(1000 * k), abs=100_000)
    assert (link.blocks.lost, link.framing.crc_errors, link.undated, link.fault) == (0, 0, 0, '')


def test_the_drift_of_the_board_is_told():
    link, _ = flown(EmulatedBoard(BOOT, drift=60e-6), np.tile(SAMPLES, (5, 1)))
    # Its clock is too fast by 60 ppm, so our seconds are fewer.
    assert link.clock.drift == pytest.approx(-60e-6, abs=3e-6)


@pytest.mark.parametrize('fault', ['drop', 'corrupt', 'cut'])
def test_losses_are_counted_by_the_board_s_own_numbers(fault):
    board = EmulatedBoard(BOOT, transmit=FrameFaults(**{fault: 70}))
    link, found = flown(board)
    hit = board.sent // 70
    assert link.blocks.lost == 15 * hit
    assert link.framing.crc_errors == (0 if fault == 'drop' else hit)
    assert len(found) < 10 * SECONDS
    every = SAMPLES[:, 0].astype(int)
    for block in found:  # what is published has no gap
        first = np.flatnonzero(every[: len(every) - 999] == block.samples[0, 0])
        assert any((SAMPLES[at : at + 1000] == block.samples).all() for at in first)


def test_foreign_messages_are_no_loss():
    link, found = flown(EmulatedBoard(BOOT, transmit=FrameFaults(foreign=3)))
    assert link.framing.unknown > 600
    assert (link.blocks.lost, len(found)) == (0, 10 * SECONDS)


def test_a_board_that_was_reset_is_followed():
    link, _ = flown(EmulatedBoard(BOOT))
    again = EmulatedBoard(BOOT + 60_000_000_000)
    link, after = flown(again, start=BOOT + 61_000_000_000, link=link)
    assert (link.clock.restarts, link.blocks.restarts) == (1, 1)
    assert len(after) >= 10 * SECONDS - 1
    assert after[0].stamp_ns == pytest.approx(BOOT + 60_000_000_000, abs=8_000_000)


def test_light_of_a_board_that_was_just_reset_waits_for_its_new_clock():
    """It comes before the next answer: by the old clock it would be seconds old."""
    link, _ = flown(EmulatedBoard(BOOT, first=4_000_000_000))
    now = BOOT + 5_100_000_000
    again = EmulatedBoard(now - 100_000_000)
    assert list(link.receive_bytes(again.encode_light(SAMPLES[:1500]), now)) == []
    assert (link.clock.is_synchronized, link.undated, link.blocks.lost) == (False, 1, 0)
    link, after = flown(again, SAMPLES[1500:], start=now + 1_000_000_000, link=link)
    assert (link.clock.restarts, link.blocks.restarts, link.blocks.lost) == (1, 1, 0)
    assert after[0].stamp_ns == pytest.approx(again.row_time_ns(1000), abs=1_000_000)


def test_our_own_clock_set_back_by_an_hour_costs_no_more_than_a_few_blocks():
    board = EmulatedBoard(BOOT)
    link, _ = flown(board)
    hour, now = 3600 * 10**9, BOOT + 5_000_000_000
    found = []
    for k in range(20):
        answer = board.answer_timesync(link.compose_due_messages(now - hour), now + 150_000)
        found += link.receive_bytes(answer, now + 300_000 - hour)
        found += link.receive_bytes(
            board.encode_light(SAMPLES[1000 * k : 1000 * (k + 1)]), now + 10**8 - hour
        )
        now += 10**8
    assert link.clock.restarts == 1
    assert len(found) >= 15  # and the last lacks rows that fill no frame yet
    assert found[-1].stamp_ns == pytest.approx(board.row_time_ns(48_000) - hour, abs=10**6)


def test_a_datagram_that_was_overtaken_is_no_reset():
    board = EmulatedBoard(BOOT)
    link, _ = flown(board)
    frames = [board.encode_light(SAMPLES[15 * k : 15 * k + 15]) for k in range(40)]
    frames.insert(35, frames.pop(5))
    for frame in frames:
        list(link.receive_bytes(frame, BOOT + 5_100_000_000))
    assert (link.clock.restarts, link.blocks.restarts, link.blocks.lost) == (0, 0, 15)


@pytest.mark.parametrize('time_usec', [3600 * 10**6, 2**63, 2**64 - 1])
def test_a_time_that_cannot_be_is_no_block(time_usec):
    """Of another board, or a stranger: ROS has no time for some of these."""
    link, _ = flown(EmulatedBoard(BOOT))
    undated, now = link.undated, link.heard_ns
    for k in range(67):
        values = {'sequence': 10_000 * SECONDS + 15 * k, 'diodes': 8, 'rows': 15}
        frame = build_frame('LTA_LIGHT_BLOCK', k, time_usec=time_usec, **values)
        assert list(link.receive_bytes(frame, now)) == []
    assert link.undated == undated + 1


def test_without_the_board_s_time_there_is_no_block():
    board, link = EmulatedBoard(BOOT), LightBoard(LIGHT, 8)
    assert list(link.receive_bytes(board.encode_light(SAMPLES[:2010]), BOOT)) == []
    assert link.undated == 2


@pytest.mark.parametrize(
    ('board', 'diodes', 'sentence'),
    [
        (EmulatedBoard(BOOT, dialect=9), 8, 'uses version 9 of the messages'),
        (EmulatedBoard(BOOT, sample_rate=8e3), 8, 'samples at 8000 Hz, but topics.yaml says 1'),
        (EmulatedBoard(BOOT), 16, 'has 8 photodiodes, but the vehicle file has 16'),
        (EmulatedBoard(BOOT, bits=16), 8, 'has 16 bits, but the vehicle file says 12'),
        (EmulatedBoard(BOOT, vehicle=0xABC), 8, 'other diodes (00000abc) than the vehicle file'),
    ],
)
def test_what_cannot_be_used_is_one_sentence_and_no_block(board, diodes, sentence):
    link, found = flown(board, link=LightBoard(LIGHT, diodes, bits=12, vehicle=0x123))
    assert found == []
    assert sentence in link.fault
    assert link.fault.endswith('.')


def test_only_answers_to_our_own_questions_are_believed():
    board, link = EmulatedBoard(BOOT), LightBoard(LIGHT, 8)
    link.clock.add_exchange = None  # nothing may get there
    late = board.answer_timesync(link.compose_due_messages(BOOT), BOOT)
    assert list(link.receive_bytes(late, BOOT + 2_000_000_000)) == []
    stranger = LightBoard(LIGHT, 8).compose_due_messages(BOOT + 77)
    assert list(link.receive_bytes(board.answer_timesync(stranger, BOOT), BOOT + 100)) == []


def test_a_board_that_asks_gets_our_time():
    link = LightBoard(LIGHT, 8)
    link.compose_due_messages(BOOT)
    assert (
        list(link.receive_bytes(LightBoard(LIGHT, 8).compose_due_messages(123_456), BOOT + 1_000))
        == []
    )
    told = [
        (one.tc1, one.ts1)
        for one in FrameParser().parse_frames(link.compose_due_messages(BOOT + 2_000))
        if one.get_type() == 'TIMESYNC'
    ]
    assert told == [(BOOT + 1_000, 123_456)]


def test_a_board_has_sampled_nothing_before_it_booted():
    board = EmulatedBoard(BOOT)
    assert board.encode_light(SAMPLES[:1000], BOOT - 50_000_000) == b''
    assert board.encode_peaks(SAMPLES[:1000], 150.0, BOOT - 1) == b''
    link, (block, *_) = flown(board)
    assert (block.samples == SAMPLES[:1000]).all()
    assert (link.blocks.lost, link.blocks.old) == (0, 0)
