"""Where a live view listens, and how people get there."""

import socket
from urllib.parse import urlencode

from lta_config.errors import BadInput

APP = 'https://app.foxglove.dev/'
PORT = 8765  # that Foxglove proposes
LOCAL = '127.0.0.1'


def build_port_error(port: int, reason: str) -> BadInput:
    """Return the sentence on a port that nothing can listen on."""
    return BadInput(
        f'Port {port} cannot be used for the live view ({reason}); end what listens there, or '
        'choose another port.'
    )


def check_port(host: str, port: int) -> None:
    """
    Refuse a port that nothing could listen on.

    Raises
    ------
    BadInput
        If it is in use, or the host is none of this machine's.

    """
    try:
        family, kind, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        raise build_port_error(port, error.strerror or str(error)) from None


def build_app_url(port: int) -> str:
    """Return the address at which Foxglove in a browser shows a live view of this machine."""
    query = {'ds': 'foxglove-websocket', 'ds.url': f'ws://localhost:{port}'}
    return f'{APP}?{urlencode(query, safe=":/")}'
