# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""When a link that is gone is opened again, and that none is left open: without a thread."""

from types import SimpleNamespace

from lta_bridge.teensy import reader
from lta_bridge.teensy.port import Unplugged
import pytest


class Pulled:
    """A port that breaks at every read, or at some."""

    strangers = 0

    def __init__(self, well=0):
        self.well, self.open = well, True

    def read(self, seconds):
        if self.well == 0:
            raise Unplugged('pulled')
        self.well -= 1
        patience.append(seconds)
        return b''

    def close(self):
        self.open = False


slept, patience, threads = [], [], []  # how long it slept and waited for bytes; its threads


@pytest.fixture
def read(monkeypatch, event_after):
    """Return a function that reads such ports to the end: the reader, its waits."""

    def read(ports, waits):
        ended, left = event_after(waits), iter(ports)
        slept.clear()
        patience.clear()
        monkeypatch.setattr(reader, 'open_port', lambda address: next(left))
        monkeypatch.setattr(reader.time, 'sleep', slept.append)
        monkeypatch.setattr(reader, 'threading', SimpleNamespace(
            Event=lambda: ended,
            Thread=lambda target, **told: threads.append(told)
            or SimpleNamespace(start=target, join=lambda: None),
        ))  # fmt: skip
        board = SimpleNamespace(
            compose_due_messages=lambda now: b'', receive_data=lambda data, now: []
        )
        return reader.BoardReader('any', board, lambda block: None, lambda: 0), ended.waited

    return read


def test_it_waits_longer_each_time_and_a_second_at_most(read):
    ports = [Pulled() for _ in range(7)]
    held, waited = read(ports, 6)
    assert waited == [0.1, 0.2, 0.5, 1.0, 1.0, 1.0]
    assert (held.unplugged, held.trouble, held.strangers) == (6, 'pulled', 0)
    assert [port.open for port in ports] == [False] * 6 + [True]  # never opened


def test_one_that_came_back_begins_with_the_shortest_wait_again(read):
    ports = [Pulled(), Pulled(), Pulled(well=1), Pulled()]
    assert read(ports, 4)[1] == [0.1, 0.2, 0.1, 0.2]


def test_bytes_gather_for_a_millisecond_and_are_waited_for_fifty(read):
    read([Pulled(well=3), Pulled()], 2)
    assert patience == [0.05] * 3
    assert slept == [0.001] * 3


def test_its_thread_keeps_no_process_alive(read):
    threads.clear()
    read([Pulled()], 1)
    assert threads == [{'name': 'light board', 'daemon': True}]
