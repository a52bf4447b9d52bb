"""Ask whether somebody listens at the UDP port of an emulated Crazyflie."""

import socket
from typing import Final

from lta_bridge.crazyflie.drone_lock import normalize_uri

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
