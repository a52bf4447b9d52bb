# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Who may look at a live view: programs, Foxglove and pages of this machine, but no other page."""

from collections.abc import Iterator
from contextlib import closing
import socket

from lta_bridge.live.origin_gate import is_allowed_origin
from lta_bridge.live.server import LiveServer
from lta_config.errors import BadInput
from ports import free_port
import pytest
from waiting import PATIENCE

ALLOWED = (
    None,
    'https://app.foxglove.dev',
    'https://app.foxglove.com',
    'file://',
    'http://localhost:8080',
    'https://localhost',
    'http://127.0.0.1:3000',
    'http://[::1]:8080',
)
FOREIGN = (
    'https://evil.example',
    'http://evil.example:8765',
    'null',
    '',
    'https://app.foxglove.dev.evil.example',
    'https://evil.example/https://app.foxglove.dev',
    'https://app.foxglove.dev@evil.example',
    'http://localhost.evil.example',
    'http://127.0.0.1.evil.example',
    'http://192.168.1.5:8080',
    'http://[::1',
    'ftp://localhost',
)
UPGRADE = (
    'Host: 127.0.0.1',
    'Upgrade: websocket',
    'Connection: Upgrade',
    'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==',
    'Sec-WebSocket-Version: 13',
    'Sec-WebSocket-Protocol: foxglove.sdk.v1',
)


@pytest.fixture(scope='module')
def port() -> Iterator[int]:
    number = free_port()
    with closing(LiveServer('LTA lta1', '127.0.0.1', number, {})):
        yield number


def ask(port: int, *headers: str) -> str:
    """Return the first line of the answer to a request for a WebSocket."""
    with socket.create_connection(('127.0.0.1', port), PATIENCE) as viewer:
        text = '\r\n'.join(['GET / HTTP/1.1', *UPGRADE, *headers, '', ''])
        viewer.sendall(text.encode())
        return viewer.makefile('rb').readline().decode().strip()


@pytest.mark.parametrize('origin', ALLOWED)
def test_programs_foxglove_and_this_machine_may_look(port, origin):
    assert is_allowed_origin(origin)
    headers = () if origin is None else (f'Origin: {origin}',)
    assert ask(port, *headers).startswith('HTTP/1.1 101')


@pytest.mark.parametrize('origin', FOREIGN)
def test_other_pages_may_not(port, origin):
    assert not is_allowed_origin(origin)
    for header in (f'Origin: {origin}', f'oRIGIN:{origin}'):
        assert ask(port, header) == 'HTTP/1.1 403 Forbidden'
    assert ask(port, 'Origin: http://localhost', f'Origin: {origin}') == 'HTTP/1.1 403 Forbidden'


def test_a_request_without_end_keeps_nobody_else_out(port):
    with socket.create_connection(('127.0.0.1', port), PATIENCE) as viewer:
        viewer.sendall(b'GET / HTTP/1.1\r\n' + b'x' * (1 << 20))
        assert ask(port).startswith('HTTP/1.1 101')


def test_a_port_in_use_is_refused_in_a_sentence(port):
    sentence = rf'Port {port} cannot be used for the live view \(Address already in use\);'
    with pytest.raises(BadInput, match=sentence):
        LiveServer('LTA lta1', '127.0.0.1', port, {})
