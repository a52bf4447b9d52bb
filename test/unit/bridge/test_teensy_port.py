# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The link itself: ports, what cannot be opened, and a cable that is pulled and put back."""

import os
import socket
import termios
import threading
import time

from lta_bridge.teensy.light_board import LightBoard
from lta_bridge.teensy.port import LOYAL_NS, open_port, UdpPort, Unplugged
from lta_bridge.teensy.reader import BoardReader
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import Cable, EmulatedBoard
import numpy as np
from ports import free_port, UDP
import pytest
from waiting import PATIENCE, wait_until

LIGHT = load_topic_table().light
ROWS = np.arange(1200 * 8, dtype=np.uint16).reshape(1200, 8)


@pytest.fixture
def cable(tmp_path):
    made = Cable(tmp_path / 'ttyACM0')
    yield made
    made.pull()


@pytest.mark.parametrize('kind', ['folder', 'file', 'no folder above'])
def test_a_cable_that_cannot_have_its_name_is_one_sentence(tmp_path, kind):
    name = tmp_path / 'lta_light_board'
    if kind == 'folder':
        name.mkdir()
    elif kind == 'file':
        name.write_text('mine')
    else:
        name = name / 'port'
    with pytest.raises(BadInput, match=rf"^The light board's port '{name}' cannot be created"):
        Cable(name)
    assert kind != 'file' or name.read_text() == 'mine'


def test_a_cable_left_behind_is_replaced(cable, tmp_path):
    Cable(tmp_path / 'ttyACM0').pull()
    assert not (tmp_path / 'ttyACM0').is_symlink()


def test_bytes_go_both_ways_unaltered(cable, tmp_path):
    """Every value of a byte: a terminal that is not raw would eat some."""
    port = open_port(str(tmp_path / 'ttyACM0'))
    every = bytes(range(256))
    port.write(every)
    assert wait_until(lambda: cable.read(0.1), 'the bytes') == every
    cable.write(every)
    assert wait_until(lambda: port.read(0.1), 'the bytes') == every
    port.close()


def test_a_pulled_cable_is_noticed(cable, tmp_path):
    port = open_port(str(tmp_path / 'ttyACM0'))
    cable.pull()
    with pytest.raises(Unplugged):
        wait_until(lambda: port.read(0.1), 'the pull')
    port.close()


@pytest.mark.parametrize(
    ('name', 'sentence'),
    [
        ('missing', 'There is no serial port .*missing; plug the light board in'),
        ('plain', 'plain cannot be opened as a serial port'),
        ('udp://127.0.0.1', 'is not a UDP address to listen on; write udp://0.0.0.0:14550'),
        ('udp://127.0.0.1:70000', 'is not a UDP address to listen on'),
        ('udp://127.0.0.1:7000?only=1', 'is not a UDP address to listen on'),
        ('udp://127.0.0.1:7000?from=a..b', 'is unknown; give its IP address'),
    ],
)
def test_what_cannot_be_opened_is_one_sentence(tmp_path, name, sentence):
    (tmp_path / 'plain').write_text('')
    address = name if name.startswith('udp') else str(tmp_path / name)
    with pytest.raises(BadInput, match=sentence) as refused:
        open_port(address)
    assert str(refused.value).endswith('.')


def test_two_bridges_on_one_board_are_refused(cable, tmp_path):
    first = open_port(str(tmp_path / 'ttyACM0'))
    with pytest.raises(BadInput, match=r'Another program uses .*; stop it'):
        open_port(str(tmp_path / 'ttyACM0'))
    first.close()


def test_no_right_to_open_names_the_group(cable, tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, 'Permission denied')

    monkeypatch.setattr(os, 'open', refuse)
    with pytest.raises(BadInput, match='sudo usermod -aG dialout'):
        open_port(str(tmp_path / 'ttyACM0'))


def test_a_cable_that_goes_while_it_is_opened_is_no_port_yet(cable, tmp_path, monkeypatch):
    def gone(*_):
        raise termios.error(5, 'Input/output error')

    monkeypatch.setattr(termios, 'tcsetattr', gone)
    with pytest.raises(BadInput, match='cannot be opened as a serial port'):
        open_port(str(tmp_path / 'ttyACM0'))


def test_a_udp_port_answers_the_board(udp_port):
    port = open_port(f'udp://127.0.0.1:{udp_port}')
    with pytest.raises(
        BadInput, match='stop the program that uses this port, or give another port'
    ):
        open_port(f'udp://127.0.0.1:{udp_port}')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
        board.settimeout(PATIENCE)
        port.write(b'to nobody')
        board.sendto(b'light', ('127.0.0.1', udp_port))
        assert wait_until(lambda: port.read(0.1), 'the light') == b'light'
        port.write(b'time?')
        assert board.recv(100) == b'time?'
    port.close()


class Sender:
    """Somebody at a port of this machine."""

    def __init__(self, to, host='127.0.0.1'):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((host, 0))
        self.socket.settimeout(PATIENCE)
        self._to = ('127.0.0.1', to)

    def says(self, data):
        self.socket.sendto(data, self._to)

    def close(self):
        self.socket.close()


@pytest.fixture
def people(udp_port):
    """Return a function that makes senders to the port, and closes them in the end."""
    made = []

    def sender(host='127.0.0.1'):
        made.append(Sender(udp_port, host))
        return made[-1]

    yield sender
    for one in made:
        one.close()


def heard_all(port, count):
    """Read until so many datagrams were taken or left out; return what was taken."""
    taken, parts = 0, []
    while (before := taken + port.strangers) < count:
        if data := port.read(PATIENCE):
            parts.append(data)
            taken += len(data) // SIZE
        assert taken + port.strangers > before, 'a datagram was lost'
    return b''.join(parts)


SIZE = 4


def test_a_stranger_on_the_udp_port_is_neither_heard_nor_answered_and_counted(
    udp_port, people, monkeypatch
):
    monkeypatch.setattr('lta_bridge.teensy.port.DATAGRAMS_PER_READ', 8)  # a flood ends no read
    clock = [0]
    port = UdpPort(f'udp://127.0.0.1:{udp_port}', lambda: clock[0])
    board, stranger = people(), people()
    board.says(b'one.')
    assert heard_all(port, 1) == b'one.'
    for turn in range(1, 4):
        for _ in range(100):
            stranger.says(b'lamp')
        assert heard_all(port, 100 * turn) == b''
    board.says(b'two.')
    assert heard_all(port, 301) == b'two.'
    assert port.strangers == 300
    port.write(b'time')
    assert board.socket.recv(10) == b'time'
    port.close()


def test_another_is_believed_once_the_board_has_been_silent(udp_port, people):
    clock = [0]
    port = UdpPort(f'udp://127.0.0.1:{udp_port}', lambda: clock[0])
    board, again = people(), people()
    board.says(b'one.')
    assert heard_all(port, 1) == b'one.'
    clock[0] += LOYAL_NS
    again.says(b'two.')
    assert heard_all(port, 1) == b''
    clock[0] += 1
    again.says(b'tri.')
    assert heard_all(port, 2) == b'tri.'
    board.says(b'old.')
    assert heard_all(port, 2) == b''
    port.close()


def test_a_port_for_one_address_is_deaf_to_all_others_from_the_first(udp_port, people):
    port = UdpPort(f'udp://127.0.0.1:{udp_port}?from=127.0.0.2')
    stranger, board = people(), people('127.0.0.2')
    stranger.says(b'lamp')
    assert heard_all(port, 1) == b''
    board.says(b'sun.')
    assert heard_all(port, 2) == b'sun.'
    assert port.strangers == 1
    port.close()


@pytest.fixture
def udp_port():
    return free_port(UDP)


def test_a_cable_that_comes_back_is_read_on(cable, tmp_path):
    board, blocks = EmulatedBoard(time.time_ns()), []
    link = LightBoard(LIGHT, 8)
    reader = BoardReader(str(tmp_path / 'ttyACM0'), link, blocks.append, time.time_ns)

    def heard(count):
        cable.write(board.answer_timesync(cable.read(0.01), time.time_ns()))
        cable.write(board.encode_light(ROWS))
        return len(blocks) >= count

    wait_until(lambda: heard(3), 'three blocks', lambda: len(blocks))
    cable.pull()
    absent = 'There is no serial port'
    wait_until(lambda: absent in reader.trouble, 'the pull', lambda: reader.trouble)
    cable.plug()
    wait_until(lambda: not reader.trouble, 'the port again', lambda: reader.trouble)
    before = len(blocks)
    wait_until(lambda: heard(before + 2), 'two more blocks', lambda: len(blocks))
    assert reader.unplugged == 1
    reader.close()
    assert 'light board' not in [thread.name for thread in threading.enumerate()]
    assert all(block.samples.shape == (1000, 8) for block in blocks)
