"""Address of a live view."""

import os
import socket
from urllib.parse import urlencode

from lta_config.errors import BadInput

FOXGLOVE_URL = 'https://app.foxglove.dev/'
PORT = 8765  # Foxglove's default
LOCAL = '127.0.0.1'


def build_port_error(port: int, error: OSError) -> BadInput:
    """Return the error for a port that cannot be listened on, and why."""
    # socket.create_server adds the address to the text; an unknown host has a number below zero
    number = error.errno or 0
    reason = os.strerror(number) if number > 0 else error.strerror or str(error)
    return BadInput(
        f'Port {port} cannot be used for the live view ({reason}); stop the program '
        'that uses the port, or choose another port.'
    )


def check_port_available(host: str, port: int) -> None:
    """
    Check that a port can be listened on.

    Raise `BadInput` if it is in use, or the host is not an address of this machine.
    """
    try:
        family, kind, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        raise build_port_error(port, error) from None


def build_app_url(port: int) -> str:
    """Return the URL that opens a live view of this machine in Foxglove's web app."""
    query = {'ds': 'foxglove-websocket', 'ds.url': f'ws://localhost:{port}'}
    return f'{FOXGLOVE_URL}?{urlencode(query, safe=":/")}'
