# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Open the link to a light board: a serial port or a UDP port."""

from collections.abc import Callable, Hashable
import errno
from pathlib import Path
import re
import select
import socket
import termios
import time
from typing import Final, final, Protocol

from lta_config.errors import BadInput
import serial
from serial.tools import list_ports

LOYAL_NS: Final = 2_000_000_000  # of silence after which another sender is accepted


@final
class SenderFilter:
    """
    Accept the first sender until it has been silent for a while; count all others.

    Two boards on one link would mix their rows, and a third party could fake a lamp. The filter
    cannot know the right sender, but it never mixes two.

    Attribute `who`: the accepted sender; None before the first. Attribute `others`: number of
    ignored messages from other senders.
    """

    def __init__(self) -> None:
        self.who: Hashable | None = None
        self.others = 0
        self._heard_ns = 0

    def accept_sender(self, who: Hashable, now_ns: int) -> bool:
        """Return whether to accept a message of a sender that arrives now, at `now_ns`."""
        loyal = (
            0 <= now_ns - self._heard_ns <= LOYAL_NS
        )  # a clock that was set back also ends the preference
        if self.who is None or (who != self.who and not loyal):
            self.who = who
        if who != self.who:
            self.others += 1
            return False
        self._heard_ns = now_ns
        return True


READ_BYTES = 65536  # bytes per read at most
# Ignored over USB, except 134 baud, at which a Teensy restarts into its boot loader.
BAUD = 115_200
DATAGRAMS_PER_READ = 256  # datagrams per read at most, so that a flood cannot block the reader
LISTEN: Final = re.compile(
    r'udp://(?P<host>[^/?#:]+):(?P<port>\d{1,5})(\?from=(?P<board>[^&#]+))?'
)
SEND_TIMEOUT = 0.1  # s; a board that does not read must not block reception


class Unplugged(OSError):
    """The link was disconnected."""


class BoardPort(Protocol):
    """An open link to a board."""

    @property
    def strangers(self) -> int:
        """Return the number of ignored datagrams from other senders than the board."""
        ...

    def read(self, timeout: float) -> bytes:
        """Return the received bytes within a time [s]; raise `Unplugged` if the link is gone."""
        ...

    def write(self, data: bytes) -> None:
        """Send if a board is known; raise `Unplugged` if the link is gone."""
        ...

    def close(self) -> None:
        """Give the link back."""
        ...


def open_port(address: str) -> BoardPort:
    """
    Open a link to a board.

    `address`: a serial port (`/dev/ttyACM0`), or `udp://HOST:PORT` to listen on; with
    `?from=ADDRESS` it ignores all other senders. Raise `BadInput` if it cannot be opened.
    """
    if address.startswith('udp://'):
        return UdpPort(address)
    return SerialPort(address)


def require_port(address: str) -> None:
    """Raise `BadInput` for a serial port that does not exist."""
    if not address.startswith('udp://') and not Path(address).exists():
        raise BadInput(_explain_missing_port(address))


def _explain_missing_port(path: str) -> str:
    ports = ', '.join(sorted(port.device for port in list_ports.comports())) or 'none'
    return f'There is no serial port {path}; plug the light board in (found: {ports}).'


@final
class SerialPort:
    """A serial port or pseudo terminal, opened exclusively."""

    strangers = 0

    def __init__(self, path: str) -> None:
        try:
            self._port = serial.Serial(
                path, BAUD, timeout=0.0, write_timeout=SEND_TIMEOUT, exclusive=True
            )
        except (
            OSError,
            ValueError,
            termios.error,
        ) as error:  # termios.error: pulled out meanwhile
            raise BadInput(_explain_open_error(path, error)) from None

    def read(self, timeout: float) -> bytes:
        """Return what has come, after at most so long [s]."""
        try:
            select.select([self._port.fileno()], [], [], timeout)
            return bytes(self._port.read(READ_BYTES))
        # pyserial raises TypeError if the port is closed by another thread during the read
        except (OSError, TypeError) as error:
            raise Unplugged(str(error)) from None

    def write(self, data: bytes) -> None:
        """Send."""
        try:
            self._port.write(data)
        except serial.SerialTimeoutException:
            return  # time requests are repeated
        except OSError as error:
            raise Unplugged(str(error)) from None

    def close(self) -> None:
        """Give the port back."""
        self._port.close()


@final
class UdpPort:
    """
    A UDP port that one board sends to; answers go to its source address.

    Any host that reaches the port can send. The first sender counts as the board until it has been
    silent for a while, or only the given address. Addresses can be forged: use a cable on an
    untrusted network.

    `address`: as for `open_port`. `clock`: returns a monotonic time [ns]. Raise `BadInput` if it
    cannot be listened on.
    """

    def __init__(self, address: str, clock: Callable[[], int] = time.monotonic_ns) -> None:
        match = LISTEN.fullmatch(address)
        if match is None or not 0 < int(match['port']) < 65536:
            raise BadInput(
                f"'{address}' is not a UDP address to listen on; write udp://0.0.0.0:14550, or "
                'on a shared network udp://0.0.0.0:14550?from=192.168.4.2 for one sender only.'
            )
        self._clock, self._sender = clock, SenderFilter()
        self._only = None if match['board'] is None else _resolve_host(match['board'], address)
        self._foreign = 0  # datagrams of other addresses than the one that was given
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        # Bytes; room for bursts while the reader is busy
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._board: tuple[str, int] | None = None
        try:
            self._socket.bind((match['host'], int(match['port'])))
        except OSError as error:
            self._socket.close()
            raise BadInput(
                f'{address} cannot be opened ({error.strerror or error}); stop the program that '
                'uses this port, or give another port.'
            ) from None
        self._socket.setblocking(False)

    @property
    def strangers(self) -> int:
        """Return the number of ignored datagrams from other senders than the board."""
        return self._foreign + self._sender.others

    def read(self, timeout: float) -> bytes:
        """Return the bytes received from the board within a time [s]."""
        select.select([self._socket], [], [], timeout)
        parts = []
        try:
            for _ in range(DATAGRAMS_PER_READ):
                data, sender = self._socket.recvfrom(READ_BYTES)
                if self._accept_sender(sender):
                    self._board = sender
                    parts.append(data)
        except OSError:  # no more datagrams, or an ICMP error for an earlier answer
            pass
        return b''.join(parts)

    def _accept_sender(self, sender: tuple[str, int]) -> bool:
        if self._only not in (None, sender[0]):
            self._foreign += 1
            return False
        return self._sender.accept_sender(sender, self._clock())

    def write(self, data: bytes) -> None:
        """Send to the board's source address."""
        if self._board is not None:
            try:
                self._socket.sendto(data, self._board)
            except OSError:
                # Unreachable: the board's next datagram gives its address again
                self._board = None

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


def _resolve_host(host: str, address: str) -> str:
    """Return the address of a host; raise `BadInput` if it is unknown."""
    try:
        return socket.gethostbyname(host)
    except (OSError, UnicodeError):
        raise BadInput(
            f"The host {host} in '{address}' is unknown; give its IP address instead."
        ) from None


def _explain_open_error(path: str, error: Exception) -> str:
    """Return why a serial port cannot be opened, with the remedy."""
    number = getattr(error, 'errno', None)
    if number == errno.ENOENT:
        return _explain_missing_port(path)
    if number == errno.EACCES:
        return (
            f'You have no permission to open {path}; run "sudo usermod -aG dialout $USER" and log '
            'in again.'
        )
    if number in (errno.EAGAIN, errno.EBUSY) or 'exclusively lock' in str(error):
        return (
            f'Another program uses {path}; stop it, because each would get only part of the data.'
        )
    return f'{path} cannot be opened as a serial port ({error}); give another port.'
