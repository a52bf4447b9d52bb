# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Keep foreign web pages away from the live view.

A browser lets any page open a WebSocket to any address, also to this machine, and names the page
in the header `Origin`. Foxglove's SDK does not check it. So the gate listens in its place, reads
the request, and connects a viewer with the SDK's server only if its origin is allowed.
"""

import asyncio
from contextlib import closing, suppress
import os
import socket
import threading
from typing import Final, final
from urllib.parse import urlencode, urlsplit

from lta_config.errors import BadInput

FOXGLOVE_URL = 'https://app.foxglove.dev/'
LIVE_PORT = 8765  # Foxglove's default
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


# Web apps of Foxglove, and its desktop app, whose pages are files
APPS: Final = ('https://app.foxglove.dev', 'https://app.foxglove.com', 'file://')
LOCALHOST: Final = ('localhost', '127.0.0.1', '::1')
REQUEST_TIME: Final = 10.0  # s for a viewer to send its request
REFUSAL: Final = b'HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\nConnection: close\r\n\r\n'
REQUEST_BYTES: Final = 1 << 16  # bytes


def is_allowed_origin(origin: str | None) -> bool:
    """
    Return whether the page of a request may look: Foxglove's, or one of this machine.

    A program that is no browser sends no origin, and is allowed. A sandboxed page sends `null`,
    and may be anybody's.
    """
    if origin is None or origin in APPS:
        return True
    try:
        parts = urlsplit(origin)
        return parts.scheme in ('http', 'https') and parts.hostname in LOCALHOST
    except ValueError:
        return False


def read_origins(head: bytes) -> list[str]:
    """Return the values of all headers `Origin` of a request."""
    lines = head.decode('latin-1').split('\r\n')[1:]
    headers = (line.partition(':') for line in lines)
    return [value.strip() for name, _, value in headers if name.strip().lower() == 'origin']


@final
class OriginGate:
    """
    Listen on an address for viewers, and connect those that are allowed.

    `host`, `port`: address to listen on. `target`: address of the server behind. Raise `BadInput`
    if the address cannot be listened on.
    """

    def __init__(self, host: str, port: int, target: tuple[str, int]) -> None:
        self._target = target
        try:
            family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
            listener = socket.create_server(address[:2], family=family)
        except OSError as error:
            raise build_port_error(port, error) from None
        runner = asyncio.Runner(loop_factory=asyncio.new_event_loop)
        self._loop, self._ended = runner.get_loop(), asyncio.Event()

        def serve() -> None:
            with runner:  # which cancels what is left
                runner.run(self._listen(listener))

        self._thread = threading.Thread(target=serve, name='origin_gate', daemon=True)
        self._thread.start()

    async def _listen(self, listener: socket.socket) -> None:
        server = await asyncio.start_server(self._admit, sock=listener)
        await self._ended.wait()
        server.close()

    async def _admit(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Read a viewer's request, and serve it or refuse it."""
        # A viewer that leaves, sends no request or a huge one, ends its own connection only
        with closing(writer), suppress(OSError, EOFError, asyncio.LimitOverrunError):
            head = await asyncio.wait_for(reader.readuntil(b'\r\n\r\n'), REQUEST_TIME)
            if not all(map(is_allowed_origin, read_origins(head))):
                writer.write(REFUSAL)
                await writer.drain()
                return
            source, behind = await asyncio.open_connection(*self._target)
            with closing(behind):
                behind.write(head)
                pipes = [pass_on(reader, behind), pass_on(source, writer)]
                tasks = [asyncio.create_task(pipe) for pipe in pipes]
                # As soon as one side has left, the other one has nobody to talk to
                await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
                for task in tasks:
                    task.cancel()

    def close(self) -> None:
        """Listen no more, and disconnect all viewers."""
        self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join(REQUEST_TIME)


async def pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Pass on what arrives until one side leaves, no faster than the other side takes it."""
    with suppress(OSError):
        while data := await reader.read(REQUEST_BYTES):
            writer.write(data)
            await writer.drain()
