# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Frames out of torn, false, foreign and malformed bytes."""

from collections import Counter

from frame_faults import FrameFaults
from hypothesis import given, settings
from hypothesis import strategies as st
from light_frames import build_frame, frame_bytes, sign_frame
from lta_bridge.teensy.block_assembler import FrameParser
from lta_emulation.teensy.emulated_board import EmulatedBoard
import numpy as np
import pytest

FRAMES = 120
LIGHT = np.random.default_rng(1).integers(0, 4096, (15 * FRAMES, 8)).astype(np.uint16)
FOREIGN = frame_bytes(12345, b'\1\2\3\4', 7)  # a message that is not in the dialect


def read(data, framing=None):
    """Return the numbers of the rows that begin each frame of light."""
    framing = framing or FrameParser()
    return [message.sequence for message in framing.parse_frames(data)], framing


@settings(max_examples=40)
@given(st.lists(st.integers(1, 700), max_size=200))
def test_any_cut_of_the_stream_gives_the_same(sizes):
    data = EmulatedBoard(0).encode_light(LIGHT)
    framing, found = FrameParser(), []
    for size in [*sizes, len(data)]:
        found += read(data[:size], framing)[0]
        data = data[size:]
    assert found == list(range(0, 15 * FRAMES, 15))
    assert (framing.frames, framing.crc_errors, framing.stray) == (FRAMES, 0, 0)


@pytest.mark.parametrize('fault', ['corrupt', 'cut', 'drop'])
def test_a_fault_costs_the_frame_that_it_hits_and_no_other(fault):
    data = EmulatedBoard(0, transmit=FrameFaults(**{fault: 10})).encode_light(LIGHT)
    found, framing = read(data + FOREIGN)
    # The last frame that is cut short may be a whole one yet: it waits.
    assert found == [15 * k for k in range(FRAMES) if (k + 1) % 10]
    if fault == 'corrupt':
        assert framing.crc_errors == FRAMES // 10


def test_noise_between_frames_is_stepped_over():
    chance = np.random.default_rng(2)
    data = EmulatedBoard(0).encode_light(LIGHT)
    size = len(data) // FRAMES
    frames = [data[k * size : (k + 1) * size] for k in range(FRAMES)]
    found, framing = read(b''.join(chance.bytes(37) + frame for frame in frames) + b'\0' * 300)
    assert found == list(range(0, 15 * FRAMES, 15))
    assert framing.frames == FRAMES


@pytest.mark.parametrize('kind', ['random', 'markers', 'heads', 'frames with a bit wrong'])
def test_a_million_malformed_bytes_are_each_looked_at_once(kind, monkeypatch):
    chance = np.random.default_rng(3)
    million = 1_000_000
    frame = EmulatedBoard(0).encode_light(LIGHT[:15])
    data = {
        'random': chance.bytes(million),
        'markers': b'\xfd' * million,
        # Heads of the longest frame of ours, one inside the other: each must be checked.
        'heads': (b'\xfd\xff\0\0\0\1\1' + frame[7:10]) * (million // 10),
        'frames with a bit wrong': (frame[:40] + b'\xaa' + frame[41:]) * (million // len(frame)),
    }[kind]
    framing, looked = FrameParser(), Counter()
    look = FrameParser._find_frame_end

    def looking(held, at):
        looked['at'] += 1
        return look(held, at)

    monkeypatch.setattr(FrameParser, '_find_frame_end', looking)
    pieces = range(0, len(data), 4096)
    for at in pieces:
        assert list(framing.parse_frames(data[at : at + 4096])) == []
    # No byte is taken for a frame's beginning twice, but for one that waits for its end.
    assert looked['at'] <= len(data) + len(pieces)
    assert read(frame * 3, framing)[0]  # and it goes on


def test_a_stream_of_all_kinds_byte_by_byte():
    """Own, signed and foreign frames and noise are each recognised at the earliest byte."""
    ours = build_frame('HEARTBEAT', 1, 1, 191, custom_mode=77)
    strangers = FOREIGN + ours + sign_frame(FOREIGN, 0)
    stream = b'ab' + ours + sign_frame(ours, 50) + strangers + ours + b'c'
    framing = FrameParser()
    found = [one for byte in stream for one in framing.parse_frames(bytes([byte]))]
    assert [one.custom_mode for one in found] == [77] * 4
    assert [(one.get_srcSystem(), one.get_srcComponent()) for one in found] == [(1, 191)] * 4
    assert (framing.frames, framing.crc_errors, framing.unknown) == (4, 0, 2)
    assert framing.stray == 3


def test_a_head_with_a_flag_that_nobody_knows_begins_no_frame():
    frame = bytearray(build_frame('HEARTBEAT', 0, 1, 1, custom_mode=1))
    for flags in (2, 3, 0x80):
        frame[2] = flags
        framing = FrameParser()
        assert list(framing.parse_frames(bytes(frame[:9]))) == []
        assert framing.stray == 0  # the number of the message is not whole yet
        assert list(framing.parse_frames(bytes(frame[9:10]))) == []
        assert framing.stray == 10


def test_a_foreign_message_counts_where_a_frame_of_either_kind_follows_at_once():
    foreign = frame_bytes(7, b'\3', 0)
    for behind, unknown in ((b'\xfd', 1), (b'\xfe', 1), (b'\xfc', 0)):
        framing = FrameParser()
        assert list(framing.parse_frames(foreign)) == []
        assert (framing.unknown, framing.stray) == (0, 0)
        assert list(framing.parse_frames(behind)) == []
        assert framing.unknown == unknown
