# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lock a drone, so that only one process of this machine commands it, and look who listens."""

from contextlib import suppress
import hashlib
import socket
import struct
from typing import Final, final

from lta_config.errors import BadInput

DEFAULT_RADIO: Final = ('2M', 'E7E7E7E7E7')  # default rate and address of a radio URI


def normalize_uri(uri: str) -> str:
    """Return a canonical URI of a drone, without the number of the radio."""
    scheme, _, rest = uri.partition('://')
    rest = rest.partition('?')[0]
    if scheme == 'radio':
        channel, *others = rest.split('/')[1:]
        rate, address = (*others, *DEFAULT_RADIO[len(others) :])
        return f'radio://{int(channel)}/{rate}/{address.upper():0>10}'
    if scheme in ('udp', 'tcp'):
        host, _, port = rest.rpartition(':')
        with suppress(OSError):  # an unknown host is reported when the link connects
            host = socket.gethostbyname(host)
        return f'{scheme}://{host}:{int(port)}'
    return uri


@final
class DroneLock:
    """
    Exclusive lock on one drone, shared by all users of this machine; it ends with the process.

    It is the name of a socket without a file (unix(7), abstract), so a process that is killed
    leaves nothing behind.

    Raises
    ------
    BadInput
        If another process holds the lock.

    """

    def __init__(self, uri: str) -> None:
        name = '\0lta-crazyflie-' + hashlib.sha256(normalize_uri(uri).encode()).hexdigest()[:16]
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            self._socket.bind(name)
        except OSError:
            self._socket.close()
            raise BadInput(
                f'Another program (process {_find_holder(name)}) already commands the Crazyflie '
                f'{uri}; stop it first, because a drone obeys every sender.'
            ) from None
        # Nobody is accepted: who connects learns only which process holds the name
        self._socket.listen()

    def close(self) -> None:
        """Release the drone; a second call does nothing."""
        self._socket.close()


def _find_holder(name: str) -> str:
    """Return the number of the process that listens at a socket, or 'unknown'."""
    with socket.socket(socket.AF_UNIX) as asking:
        asking.settimeout(1.0)
        try:
            asking.connect(name)
            credentials = asking.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
        except OSError:  # it has just ended, or its queue is full
            return 'unknown'
    return str(struct.unpack('3i', credentials)[0])


ANSWER: Final = 0.05  # s for the ICMP error of a closed port of this machine


def is_port_closed(uri: str) -> bool:
    """Return whether a udp:// URI refuses datagrams; False for a radio, which cannot tell."""
    scheme, _, address = normalize_uri(uri).partition('://')
    if scheme != 'udp':
        return False
    host, _, port = address.rpartition(':')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.settimeout(ANSWER)
        try:
            probe.connect((host, int(port)))
            probe.send(b'')  # no packet of CRTP
            probe.recv(1)
        except ConnectionRefusedError:
            return True
        except OSError:
            return False
    return False
