"""An independent decoder, MAVSDK's in C++, where it is installed: `pip install mavsdk`."""

import json
from pathlib import Path
from queue import SimpleQueue
import socket
import threading

from lta_emulation.teensy.emulated_board import EmulatedBoard
import numpy as np
from ports import free_port, UDP
import pytest
from waiting import PATIENCE, wait_until

mavsdk = pytest.importorskip('mavsdk', reason='MAVSDK is an optional judge: pip install mavsdk')

XML = Path(__file__).resolve().parents[3] / 'firmware/light_board/mavlink/lta.xml'
ROWS = 15


def test_mavsdk_reads_our_blocks_from_our_xml():
    """Every value of a block, through somebody else's framing, checksum and dialect reader."""
    from mavsdk.plugins.mavlink_direct import MavlinkDirect

    samples = np.random.default_rng(1).integers(0, 4096, (ROWS, 8)).astype(np.uint16)
    told, over = SimpleQueue(), threading.Event()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        ours.bind(('127.0.0.1', 0))
        kind = mavsdk.ComponentType.GROUND_STATION
        station = mavsdk.Mavsdk(mavsdk.Configuration.create_with_component_type(kind))
        port = free_port(UDP)
        station.add_any_connection(f'udpin://127.0.0.1:{port}')
        board = EmulatedBoard(0)

        def send():
            while not over.wait(0.05):
                ours.sendto(
                    board.encode_status() + board.encode_light(samples), ('127.0.0.1', port)
                )

        sender = threading.Thread(target=send)
        sender.start()
        try:
            (system,) = wait_until(station.get_systems, 'a system')
            direct = MavlinkDirect(system)
            direct.load_custom_xml(XML.read_text())
            direct.subscribe_message('LTA_LIGHT_BLOCK', lambda message, *_: told.put(message))
            fields = json.loads(told.get(timeout=PATIENCE).fields_json)
        finally:
            over.set()
            sender.join()
            station.destroy()
    assert fields['samples'] == samples.ravel().tolist()
    assert (fields['rows'], fields['diodes']) == (ROWS, 8)
    assert fields['sequence'] % ROWS == 0
