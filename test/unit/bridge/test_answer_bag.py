# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What nodes answer in a replay is safe soon, and a full disk is said once."""

import errno
import os
from pathlib import Path
import struct
from types import SimpleNamespace

from lta_bag import storage
from lta_bag.reader import read_bag
from lta_bridge.playback import answer_bag
from lta_bridge.playback.answer_bag import AnswerBag
from lta_bridge.playback.node_selection import NodeSelection
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
import pytest

TABLE = load_topic_table()
S = 10**9
RECORDING = SimpleNamespace(path=Path('flight'), provenance={'seed': '3'})
CAST = NodeSelection(('controller',), ('odom',), ('motors',))


def duties(stamp):
    return bytes([0, 1, 0, 0]) + struct.pack('<iI', *divmod(stamp, S)) + bytes(24)


def answers(folder):
    return AnswerBag(folder, RECORDING, CAST, TABLE, 'lta1', lockstep=True)


@pytest.fixture
def wall(monkeypatch):
    """Return a clock that stands still until it is moved."""
    now = SimpleNamespace(s=100.0)
    monkeypatch.setattr(answer_bag.time, 'monotonic', lambda: now.s)
    return now


@pytest.fixture
def full(monkeypatch):
    """Fill the disk when called."""

    def refuse(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    return lambda: monkeypatch.setattr(storage.os, 'pwrite', refuse)


def test_answers_survive_the_death_of_the_player_from_the_next_flush_on(tmp_path, wall):
    bag = answers(tmp_path / 'bag')
    for step in range(5):
        bag.write('motors', duties(S + step), None, 0)
    bag.flush()  # not due yet
    assert read_bag(tmp_path / 'bag').topics == {}
    wall.s += 1.0
    bag.flush()
    times = [when for _, when, _ in read_bag(tmp_path / 'bag').iterate_messages()]
    assert times == [S + step for step in range(5)]
    bag.close()


def test_a_disk_that_fills_ends_the_bag_with_a_sentence_and_not_the_player(tmp_path, wall, full):
    bag = answers(tmp_path / 'bag')
    bag.write('motors', duties(S), None, 0)
    full()
    wall.s += 1.0
    bag.flush()
    assert 'No space left on device' in (first := bag.fault)
    bag.write('motors', duties(2 * S), None, 0)
    bag.close()
    assert bag.fault == first


def test_a_disk_that_is_full_from_the_start_is_bad_input(tmp_path, full):
    full()
    with pytest.raises(BadInput, match='No space left on device'):
        answers(tmp_path / 'bag')
