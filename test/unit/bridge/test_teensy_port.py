"""The link itself: ports, what cannot be opened, and a cable that is pulled and put back."""

import os
import socket
import threading
import time

from lta_bridge.teensy.emulator import Cable, EmulatedBoard
from lta_bridge.teensy.light_board import LightBoard
from lta_bridge.teensy.port import open_port, Unplugged
from lta_bridge.teensy.reader import Reader
from lta_config.errors import BadInput
from lta_config.topics import topic_table
import numpy as np
import pytest

LIGHT = topic_table().light
PATIENCE = 20.0  # s; what comes normally comes within milliseconds
ROWS = np.arange(1200 * 8, dtype=np.uint16).reshape(1200, 8)


@pytest.fixture
def cable(tmp_path):
    made = Cable(tmp_path / 'ttyACM0')
    yield made
    made.pull()


def until(condition):
    deadline = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < deadline
        time.sleep(0.002)
    return found


def test_bytes_go_both_ways_unaltered(cable, tmp_path):
    """Every value of a byte: a terminal that is not raw would eat some."""
    port = open_port(str(tmp_path / 'ttyACM0'))
    every = bytes(range(256))
    port.write(every)
    assert until(lambda: cable.read(0.1)) == every
    cable.write(every)
    assert until(lambda: port.read(0.1)) == every
    port.close()


def test_a_pulled_cable_is_noticed(cable, tmp_path):
    port = open_port(str(tmp_path / 'ttyACM0'))
    cable.pull()
    with pytest.raises(Unplugged):
        until(lambda: port.read(0.1))
    port.close()


@pytest.mark.parametrize(
    ('name', 'sentence'),
    [
        ('missing', 'There is no serial port .*missing; plug the light board in'),
        ('plain', 'plain is no serial port that can be opened'),
        ('udp://127.0.0.1', 'is no place to listen; give udp://0.0.0.0:14550'),
        ('udp://127.0.0.1:70000', 'is no place to listen'),
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
    with pytest.raises(BadInput, match='is in use by another program; stop it'):
        open_port(str(tmp_path / 'ttyACM0'))
    first.close()


def test_no_right_to_open_names_the_group(cable, tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, 'Permission denied')

    monkeypatch.setattr(os, 'open', refuse)
    with pytest.raises(BadInput, match='sudo usermod -aG dialout'):
        open_port(str(tmp_path / 'ttyACM0'))


def test_a_udp_port_answers_whoever_sent(free_port):
    port = open_port(f'udp://127.0.0.1:{free_port}')
    with pytest.raises(BadInput, match='stop what uses it or give another port'):
        open_port(f'udp://127.0.0.1:{free_port}')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
        board.settimeout(PATIENCE)
        port.write(b'to nobody')
        board.sendto(b'light', ('127.0.0.1', free_port))
        assert until(lambda: port.read(0.1)) == b'light'
        port.write(b'time?')
        assert board.recv(100) == b'time?'
    port.close()


@pytest.fixture
def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def test_a_cable_that_comes_back_is_read_on(cable, tmp_path):
    board, blocks = EmulatedBoard(time.time_ns()), []
    link = LightBoard(LIGHT, 8)
    reader = Reader(str(tmp_path / 'ttyACM0'), link, blocks.append, time.time_ns)

    def heard(count):
        cable.write(board.answer(cable.read(0.01), time.time_ns()))
        cable.write(board.light(ROWS))
        return len(blocks) >= count

    until(lambda: heard(3))
    cable.pull()
    until(lambda: 'There is no serial port' in reader.trouble)
    cable.plug()
    until(lambda: not reader.trouble)
    before = len(blocks)
    until(lambda: heard(before + 2))
    assert reader.unplugged == 1
    reader.close()
    assert 'light board' not in [thread.name for thread in threading.enumerate()]
    assert all(block.samples.shape == (1000, 8) for block in blocks)
