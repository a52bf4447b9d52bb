"""What a light board hangs on: a serial port or a UDP port, opened or refused in one sentence."""

import errno
import select
import socket
from typing import final, Protocol

from lta_config.errors import BadInput
import serial
from serial.tools import list_ports

CHUNK = 65536  # bytes a read may bring
# Means nothing over USB, but for 134 baud, at which a Teensy restarts into its loader.
BAUD = 115_200
SEND_TIMEOUT = 0.1  # s; a board that takes nothing must not hold up what it sends


class Unplugged(OSError):
    """The link is gone."""


class Port(Protocol):
    """An open link."""

    def read(self, timeout: float) -> bytes:
        """Return what has come, after at most so long [s]; raise Unplugged where it is gone."""
        ...

    def write(self, data: bytes) -> None:
        """Send, if anybody listens; raise Unplugged where the link is gone."""
        ...

    def close(self) -> None:
        """Give the link back."""
        ...


def open_port(address: str) -> Port:
    """
    Return an open link.

    Parameters
    ----------
    address : str
        A serial port (`/dev/ttyACM0`), or `udp://HOST:PORT` to listen on.

    Raises
    ------
    BadInput
        If it cannot be had; says why and what to do.

    """
    if address.startswith('udp://'):
        return UdpPort(address)
    return SerialPort(address)


@final
class SerialPort:
    """A serial port, or the end of a pseudo terminal."""

    def __init__(self, path: str) -> None:
        try:
            self._port = serial.Serial(
                path, BAUD, timeout=0.0, write_timeout=SEND_TIMEOUT, exclusive=True
            )
        except (OSError, ValueError) as error:
            raise BadInput(_why(path, error)) from None

    def read(self, timeout: float) -> bytes:
        """Return what has come, after at most so long. [s]"""
        try:
            select.select([self._port.fileno()], [], [], timeout)
            return bytes(self._port.read(CHUNK))
        except (OSError, TypeError) as error:
            raise Unplugged(str(error)) from None

    def write(self, data: bytes) -> None:
        """Send."""
        try:
            self._port.write(data)
        except serial.SerialTimeoutException:
            return  # whoever asked asks again
        except OSError as error:
            raise Unplugged(str(error)) from None

    def close(self) -> None:
        """Give the port back."""
        self._port.close()


@final
class UdpPort:
    """A UDP port that one board sends to; it is answered where it last sent from."""

    def __init__(self, address: str) -> None:
        host, _, number = address.removeprefix('udp://').rpartition(':')
        if not number.isdecimal() or not 0 < int(number) < 65536:
            raise BadInput(f"'{address}' is no place to listen; give udp://0.0.0.0:14550.")
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._board: tuple[str, int] | None = None
        try:
            self._socket.bind((host, int(number)))
        except OSError as error:
            self._socket.close()
            raise BadInput(
                f'{address} cannot be listened on ({error.strerror or error}); '
                'stop what uses it or give another port.'
            ) from None
        self._socket.setblocking(False)

    def read(self, timeout: float) -> bytes:
        """Return what has come, after at most so long. [s]"""
        select.select([self._socket], [], [], timeout)
        parts = []
        try:
            while True:
                data, self._board = self._socket.recvfrom(CHUNK)
                parts.append(data)
        except OSError:  # nothing more, or word that an answer found nobody
            return b''.join(parts)

    def write(self, data: bytes) -> None:
        """Send to where the board last sent from."""
        if self._board is not None:
            try:
                self._socket.sendto(data, self._board)
            except OSError:
                self._board = None

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


def _why(path: str, error: OSError | ValueError) -> str:
    """Return why a serial port cannot be opened and what to do."""
    number = getattr(error, 'errno', None)
    if number == errno.ENOENT:
        found = ', '.join(sorted(port.device for port in list_ports.comports())) or 'none'
        return f'There is no serial port {path}; plug the light board in (there are: {found}).'
    if number == errno.EACCES:
        return (
            f'You may not open {path}; join its group (sudo usermod -aG dialout $USER), '
            'log in again, and try again.'
        )
    if number in (errno.EAGAIN, errno.EBUSY) or 'exclusively lock' in str(error):
        return f'{path} is in use by another program; stop it, since two would tear the stream.'
    return f'{path} is no serial port that can be opened ({error}); give another.'
