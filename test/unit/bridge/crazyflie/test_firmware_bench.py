# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A simulated body behind the bench port of the firmware, which a socket stands for."""

import socket
import threading

from lta_config.errors import BadInput
from lta_emulation.crazyflie import firmware_bench
from lta_emulation.crazyflie.firmware_bench import FirmwareBench
from ports import free_port, UDP
import pytest
from waiting import wait_until

VALUES = {
    'acc.x': 0.1, 'acc.y': -0.2, 'acc.z': 1.0, 'gyro.x': 1.0, 'gyro.y': 2.0, 'gyro.z': -3.0,
    'range.zrange': 450.0, 'baro.pressure': 1013.25, 'pm.vbat': 3.9,
}  # fmt: skip


class RecordedBody:
    duties = (0.0,) * 4

    def __init__(self):
        self.commands = []

    def advance(self, _now, wish):
        self.commands.append(wish.duties)

    def read_log_values(self):
        return VALUES


@pytest.fixture
def firmware():
    """Return a socket that answers readings with four compare values, and what it has got."""
    received, over = [], threading.Event()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as bench:
        bench.bind(('127.0.0.1', 0))
        bench.settimeout(0.01)

        def answer():
            while not over.is_set():
                try:
                    data, sender = bench.recvfrom(256)
                except TimeoutError:
                    continue
                received.append(data.decode())
                bench.sendto(b'0 51 255 102', sender)

        thread = threading.Thread(target=answer)
        thread.start()
        yield bench.getsockname()[1], received
        over.set()
        thread.join()


def test_readings_go_to_the_firmware_and_its_motors_move_the_body(firmware):
    port, received = firmware
    body = RecordedBody()
    with FirmwareBench(body, port, 19850) as bench:
        wait_until(lambda: (0.0, 0.2, 1.0, 0.4) in body.commands, 'duties of the firmware')
        assert bench.uri == 'udp://127.0.0.1:19850'
    # g, deg/s, m, mbar and V, as linux_platform.h has them
    assert set(received) == {'sense 0.1 -0.2 1 1 2 -3 0.45 1013.25 3.9'}


def test_a_late_answer_does_not_delay_the_others(monkeypatch):
    """The firmware misses the first two exchanges, answers them late, and then counts on."""
    monkeypatch.setattr(firmware_bench, 'ANSWER', 0.2)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as firmware:
        firmware.bind(('127.0.0.1', 0))
        firmware.settimeout(5.0)
        bench = FirmwareBench(RecordedBody(), firmware.getsockname()[1], 19850)
        assert bench._exchange_readings() is None
        assert bench._exchange_readings() is None
        for _ in range(2):
            firmware.sendto(b'1 1 1 1', firmware.recvfrom(256)[1])
        thread = threading.Thread(
            target=lambda: firmware.sendto(b'51 51 51 51', firmware.recvfrom(256)[1])
        )
        thread.start()
        assert bench._exchange_readings() == (0.2,) * 4
        thread.join()
        bench._socket.close()


def test_without_a_firmware_it_says_how_to_start_one(monkeypatch):
    monkeypatch.setattr(firmware_bench, 'STARTUP', 0.05)
    port = free_port(UDP)
    with (
        pytest.raises(BadInput, match=f'No firmware answers at the UDP port {port}'),
        FirmwareBench(RecordedBody(), port, 19850),
    ):
        raise AssertionError
