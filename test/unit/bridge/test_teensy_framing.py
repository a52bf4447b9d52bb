"""Frames out of torn, false, foreign and malformed bytes."""

from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.teensy.emulator import EmulatedBoard, Faults, FOREIGN
from lta_bridge.teensy.framing import Framing
import numpy as np
import pytest

FRAMES = 120
LIGHT = np.random.default_rng(1).integers(0, 4096, (15 * FRAMES, 8)).astype(np.uint16)


def read(data, framing=None):
    """Return the numbers of the rows that begin each frame of light."""
    framing = framing or Framing()
    return [int(frame.record['sequence']) for frame in framing.take(data)], framing


@settings(max_examples=40)
@given(st.lists(st.integers(1, 700), max_size=200))
def test_any_cut_of_the_stream_gives_the_same(sizes):
    data = EmulatedBoard(0).light(LIGHT)
    framing, found = Framing(), []
    for size in [*sizes, len(data)]:
        found += read(data[:size], framing)[0]
        data = data[size:]
    assert found == list(range(0, 15 * FRAMES, 15))
    assert (framing.frames, framing.crc_errors, framing.stray) == (FRAMES, 0, 0)


@pytest.mark.parametrize('fault', ['corrupt', 'cut', 'drop'])
def test_a_fault_costs_the_frame_that_it_hits_and_no_other(fault):
    data = EmulatedBoard(0, faults=Faults(**{fault: 10})).light(LIGHT)
    found, framing = read(data + FOREIGN.frame(0, 1, 1))
    # The last frame that is cut short may be a whole one yet: it waits.
    assert found == [15 * k for k in range(FRAMES) if (k + 1) % 10]
    if fault == 'corrupt':
        assert framing.crc_errors == FRAMES // 10


def test_foreign_messages_are_counted_and_are_no_loss():
    found, framing = read(EmulatedBoard(0, faults=Faults(foreign=10)).light(LIGHT) + b'\xfd')
    assert len(found) == FRAMES
    assert (framing.unknown, framing.crc_errors, framing.stray) == (FRAMES // 10, 0, 0)


def test_noise_between_frames_is_stepped_over():
    chance = np.random.default_rng(2)
    data = EmulatedBoard(0).light(LIGHT)
    size = len(data) // FRAMES
    frames = [data[k * size : (k + 1) * size] for k in range(FRAMES)]
    found, framing = read(b''.join(chance.bytes(37) + frame for frame in frames) + b'\0' * 300)
    assert found == list(range(0, 15 * FRAMES, 15))
    assert framing.frames == FRAMES


@pytest.mark.parametrize('kind', ['random', 'markers', 'heads', 'frames with a bit wrong'])
def test_a_million_malformed_bytes_are_each_looked_at_once(kind, monkeypatch):
    chance = np.random.default_rng(3)
    million = 1_000_000
    frame = EmulatedBoard(0).light(LIGHT[:15])
    data = {
        'random': chance.bytes(million),
        'markers': b'\xfd' * million,
        # Heads of the longest frame of ours, one inside the other: each must be checked.
        'heads': (b'\xfd\xff\0\0\0\1\1' + frame[7:10]) * (million // 10),
        'frames with a bit wrong': (frame[:40] + b'\xaa' + frame[41:]) * (million // len(frame)),
    }[kind]
    framing, looked = Framing(), Counter()
    look = Framing._end

    def looking(held, at):
        looked['at'] += 1
        return look(held, at)

    monkeypatch.setattr(Framing, '_end', looking)
    pieces = range(0, len(data), 4096)
    for at in pieces:
        assert list(framing.take(data[at : at + 4096])) == []
    # No byte is taken for a frame's beginning twice, but for one that waits for its end.
    assert looked['at'] <= len(data) + len(pieces)
    assert read(frame * 3, framing)[0]  # and it goes on
