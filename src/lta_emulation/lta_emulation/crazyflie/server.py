# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Serve the emulated Crazyflie on a UDP port, in real time, in a separate thread."""

from dataclasses import dataclass, field
import heapq
from random import Random
import socket
import threading
import time
from typing import Final, final, Self

from lta_emulation.crazyflie.firmware import Firmware, unpack_datagram
from lta_emulation.step_thread import StepThread


@final
@dataclass(slots=True)
class LossyLink:
    """A lossy link in one direction."""

    # Fractions of datagrams that are lost, duplicated and truncated
    drop: float = 0.0
    double: float = 0.0
    torn: float = 0.0
    # Delay, and largest additional random delay, which may reorder datagrams [s]
    delay: float = 0.0
    jitter: float = 0.0
    silent: bool = False  # whether all datagrams are lost
    random: Random = field(default_factory=lambda: Random(1))  # random number generator
    _waiting: list[tuple[float, int, bytes]] = field(default_factory=list)
    _count: int = 0

    def send(self, datagram: bytes, now: float) -> None:
        """Send a datagram [s]."""
        if self.silent or self.random.random() < self.drop:
            return
        for _ in range(2 if self.random.random() < self.double else 1):
            due = now + self.delay + self.jitter * self.random.random()
            self._count += 1
            if self.torn and self.random.random() < self.torn:
                datagram = datagram[: self.random.randrange(len(datagram) + 1)]
            # The counter keeps the order of datagrams with equal times
            heapq.heappush(self._waiting, (due, self._count, datagram))

    @property
    def has_pending(self) -> bool:
        """Whether any datagram is in transit."""
        return bool(self._waiting)

    def receive(self, now: float) -> list[bytes]:
        """Return the datagrams that have arrived by a time [s], in the order of arrival."""
        arrived = []
        while self._waiting and self._waiting[0][0] <= now:
            arrived.append(heapq.heappop(self._waiting)[2])
        return arrived


SERVER_TICK: Final = 0.002  # s between two ticks


@final
class CrazyflieServer:
    """
    A Crazyflie at `udp://127.0.0.1:port`.

    Parameters
    ----------
    port : int
        0 for any free one.
    up, down : Link, optional
        Fault models of the datagrams to and from the drone.

    Attributes
    ----------
    uri : str
        Its URI for cflib.

    """

    def __init__(
        self,
        firmware: Firmware,
        port: int = 0,
        up: LossyLink | None = None,
        down: LossyLink | None = None,
    ) -> None:
        self.firmware = firmware
        self.up, self.down = up or LossyLink(), down or LossyLink()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        # Loopback only: anybody on the network could command the drone otherwise
        self._socket.bind(('127.0.0.1', port))
        self._socket.settimeout(SERVER_TICK)
        self.uri = f'udp://127.0.0.1:{self._socket.getsockname()[1]}'
        self._peer: tuple[str, int] | None = None
        self._began = time.monotonic()
        self._shut = threading.Event()
        self._thread = StepThread(self._serve, 'emulated_crazyflie')

    @property
    def now(self) -> float:
        """Time since the boot [s]."""
        return time.monotonic() - self._began

    def __enter__(self) -> Self:
        """Boot."""
        self._began = time.monotonic()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Switch off; the port is closed, so that senders get an ICMP error."""
        self.close()

    def close_port(self) -> None:
        """Close the port for good but keep flying; senders get an ICMP error."""
        self._shut.set()

    def close(self) -> None:
        """Switch off."""
        self._thread.stop()
        self._socket.close()

    def _serve(self) -> None:
        self._receive_datagrams()
        now = self.now
        for datagram in self.up.receive(now):
            self._answer_datagram(datagram, now)
        for packet in self.firmware.tick(now):
            self.down.send(packet.pack_datagram(), now)
        self._send_datagrams(now)

    def _receive_datagrams(self) -> None:
        """Receive packets, or wait a moment."""
        if self._shut.is_set():
            self._socket.close()
            time.sleep(SERVER_TICK)
            return
        wait = SERVER_TICK
        while True:
            self._socket.settimeout(wait)
            try:
                # Answers go to the last sender, as with a radio
                datagram, self._peer = self._socket.recvfrom(64)
            # ConnectionError: an ICMP error of an earlier answer whose receiver is gone
            except (TimeoutError, BlockingIOError, ConnectionError):
                return
            self.up.send(datagram, self.now)
            # Wait only for the first datagram, then take those that have arrived
            wait = 0.0

    def _answer_datagram(self, datagram: bytes, now: float) -> None:
        packet = unpack_datagram(datagram)
        if packet is not None:
            for answer in self.firmware.receive(packet, now):
                self.down.send(answer.pack_datagram(), now)

    def _send_datagrams(self, now: float) -> None:
        for datagram in self.down.receive(now):
            if self._peer is not None and not self._shut.is_set():
                self._socket.sendto(datagram, self._peer)
