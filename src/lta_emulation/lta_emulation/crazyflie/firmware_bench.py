# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Connect a simulated drone to the real firmware, which runs on this machine.

The firmware is built for Linux by firmware/crazyflie/linux. Each control period its bench port
gets what the drone senses, and answers with what its motors do.
"""

from contextlib import suppress
import socket
import time
from typing import Final, final, Self

from lta_config.errors import BadInput
from lta_emulation.crazyflie.commander import BodyCommand, CrazyflieBody
from lta_emulation.step_thread import StepThread

EXCHANGE_PERIOD: Final = 0.01  # s between two exchanges
ANSWER: Final = 0.05  # s to wait for an answer; a busy machine may take longer, and misses one
STARTUP: Final = 10.0  # s for the firmware to answer first
FULL_PWM: Final = 255  # PWM compare value of a motor at full power (motors.c)
# In the order of `readings_t` (linux_platform.h); the range in metres follows, then the rest
IMU_NAMES: Final = ('acc.x', 'acc.y', 'acc.z', 'gyro.x', 'gyro.y', 'gyro.z')


@final
class FirmwareBench:
    """
    The bench port of the firmware, which moves a body in real time.

    Parameters
    ----------
    bench_port, port : int
        UDP ports of the firmware on this machine: of its bench, and of its radio link.

    Attributes
    ----------
    uri : str
        URI of the firmware for cflib.
    missed : int
        Exchanges without an answer.

    """

    def __init__(self, body: CrazyflieBody, bench_port: int, port: int) -> None:
        self.uri, self.missed = f'udp://127.0.0.1:{port}', 0
        self._body, self._bench_port = body, bench_port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(('127.0.0.1', bench_port))
        self._socket.settimeout(ANSWER)
        self._began, self._turn = 0.0, 0
        self._duties: tuple[float, ...] = (0.0,) * 4
        self._thread = StepThread(self._exchange, 'firmware_bench')

    def __enter__(self) -> Self:
        """Start, once the firmware answers."""
        deadline = time.monotonic() + STARTUP
        while self._exchange_readings() is None:
            if time.monotonic() > deadline:
                self._socket.close()
                raise BadInput(
                    f'No firmware answers at the UDP port {self._bench_port} of this machine; '
                    'start it first (docs/tutorials/rehearsal.md).'
                )
            time.sleep(ANSWER)
        self._began = time.monotonic()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop; the firmware keeps the last readings."""
        self._thread.stop()
        self._socket.close()

    def _exchange(self) -> None:
        self._turn += 1
        time.sleep(max(0.0, self._began + self._turn * EXCHANGE_PERIOD - time.monotonic()))
        self._body.advance(time.monotonic() - self._began, BodyCommand(self._duties))
        self._duties = self._exchange_readings() or self._duties

    def _exchange_readings(self) -> tuple[float, ...] | None:
        """Send what the body senses; return the duties of M1 to M4, None without an answer."""
        values = self._body.read_log_values()
        words = [*(values.get(name, 0.0) for name in IMU_NAMES), 1e-3 * values['range.zrange']]
        words += [values['baro.pressure'], values.get('pm.vbat', 4.0)]
        self._drop_late_answers()
        # ECONNREFUSED while nobody listens
        with suppress(OSError, ValueError):
            self._socket.send(('sense ' + ' '.join(f'{word:.6g}' for word in words)).encode())
            answer = self._socket.recv(256).decode().split()
            if len(answer) == 4:
                return tuple(int(word) / FULL_PWM for word in answer)
        self.missed += 1
        return None

    def _drop_late_answers(self) -> None:
        """Drop the answers to earlier exchanges; each would delay all that follow."""
        self._socket.settimeout(0.0)
        with suppress(OSError):
            while True:
                self._socket.recv(256)
        self._socket.settimeout(ANSWER)
