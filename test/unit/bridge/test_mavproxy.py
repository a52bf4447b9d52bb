"""An independent peer, MAVProxy, where it is installed: `pip install MAVProxy` (GPL)."""

import os
from pathlib import Path
import shutil
import socket
import subprocess
import threading

from lta_bridge.teensy.block_assembler import FrameParser
from lta_emulation.teensy.emulated_board import EmulatedBoard
import numpy as np
from ports import free_port, UDP
import pytest
from waiting import PATIENCE

PROXY = shutil.which('mavproxy.py')
pytestmark = pytest.mark.skipif(
    PROXY is None, reason='MAVProxy is an optional peer: pip install MAVProxy'
)
ROWS = 15
# MAVProxy brings its own pymavlink
ENVIRONMENT = {'PATH': f'{Path(PROXY or "").parent}{os.pathsep}{os.defpath}'}


def test_mavproxy_detects_the_board_and_forwards_its_blocks(tmp_path):
    """MAVProxy finds the board by its heartbeat, and passes on messages that it does not know."""
    samples = np.random.default_rng(1).integers(0, 4096, (ROWS, 8)).astype(np.uint16)
    port, over = free_port(UDP), threading.Event()
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board_socket,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as bridge_socket,
    ):
        bridge_socket.bind(('127.0.0.1', 0))
        bridge_socket.settimeout(PATIENCE)
        words = [
            PROXY, '--non-interactive', f'--master=udpin:127.0.0.1:{port}', '--dialect=common',
            f'--out=udpout:127.0.0.1:{bridge_socket.getsockname()[1]}',
            f'--state-basedir={tmp_path}',
        ]  # fmt: skip
        board = EmulatedBoard(0)

        def send():
            while not over.wait(0.05):
                frames = board.encode_status() + board.encode_light(samples)
                board_socket.sendto(frames, ('127.0.0.1', port))

        sender = threading.Thread(target=send)
        sender.start()
        with subprocess.Popen(
            words, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True,
            env={**ENVIRONMENT, 'MAVLINK20': '1', 'PYTHONUNBUFFERED': '1', 'HOME': str(tmp_path)},
        ) as proxy:  # fmt: skip
            late = threading.Timer(PATIENCE, proxy.kill)
            late.start()
            try:
                parser, blocks = FrameParser(), []
                while not blocks:
                    frames = parser.parse_frames(bridge_socket.recv(65536))
                    blocks = [one for one in frames if one.get_type() == 'LTA_LIGHT_BLOCK']
                assert any('Detected vehicle 1:191' in line for line in proxy.stdout)
            finally:
                late.cancel()
                over.set()
                sender.join()
                proxy.kill()
    assert blocks[0].samples == samples.ravel().tolist()
    assert (parser.crc_errors, parser.stray) == (0, 0)
