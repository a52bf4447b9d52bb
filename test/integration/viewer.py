# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A viewer that speaks Foxglove's WebSocket protocol, from its text and RFC 6455 alone."""

import base64
from collections.abc import Callable, Iterator
import hashlib
import json
import os
import select
import socket
import struct
import time

from waiting import PATIENCE, wait_until

GUID = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11'  # RFC 6455, 1.3
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
DATA, TIME = 1, 2  # opcodes of the server's binary messages


class Viewer:
    """
    Connect to a live view.

    Attributes
    ----------
    protocol : str
        The subprotocol that the server chose.
    channels : dict of str to dict
        What it advertises, by topic.
    messages : dict of str to list of (int, bytes)
        Log time and payload of what came, by topic.
    times : list of int
        The server times that came.
    statuses : list of dict
        What it complained about.

    """

    def __init__(self, port: int) -> None:
        self._socket = wait_until(lambda: _connected(port), f'a server on port {port}')
        self._rest = b''
        self.channels: dict[str, dict[str, object]] = {}
        self.info: dict[str, object] = {}
        self.messages: dict[str, list[tuple[int, bytes]]] = {}
        self.times: list[int] = []
        self.statuses: list[dict[str, object]] = []
        self._topics: dict[int, str] = {}
        self.protocol = self._handshake(port)
        self._heed_all()

    def _handshake(self, port: int) -> str:
        key = base64.b64encode(os.urandom(16)).decode()
        lines = (
            'GET / HTTP/1.1',
            f'Host: 127.0.0.1:{port}',
            'Upgrade: websocket',
            'Connection: Upgrade',
            f'Sec-WebSocket-Key: {key}',
            'Sec-WebSocket-Version: 13',
            'Sec-WebSocket-Protocol: foxglove.sdk.v1',
        )
        self._socket.sendall('\r\n'.join((*lines, '', '')).encode())
        while b'\r\n\r\n' not in self._rest:
            self._rest += self._socket.recv(65536)
        head, self._rest = self._rest.split(b'\r\n\r\n', 1)
        status, *rows = head.decode().split('\r\n')
        assert ' 101 ' in status
        told = {name.lower(): value.strip() for name, _, value in (r.partition(':') for r in rows)}
        digest = hashlib.sha1((key + GUID).encode(), usedforsecurity=False).digest()
        assert told['sec-websocket-accept'] == base64.b64encode(digest).decode()
        return told['sec-websocket-protocol']

    def send(self, content: dict[str, object] | bytes) -> None:
        """Send a JSON or binary message; clients mask what they send."""
        binary = isinstance(content, bytes)
        data = content if binary else json.dumps(content).encode()
        size = len(data)
        head = struct.pack('>BB', 0x80 | (BINARY if binary else TEXT), 0x80 | min(size, 126))
        head += struct.pack('>H', size) if size >= 126 else b''
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[k % 4] for k, byte in enumerate(data))
        self._socket.sendall(head + mask + masked)

    def subscribe(self, *topics: str) -> None:
        """Look at some topics, or at all."""
        asked = []
        for number, topic in enumerate(topics or self.channels):
            self._topics[number] = topic
            asked.append({'id': number, 'channelId': self.channels[topic]['id']})
        self.send({'op': 'subscribe', 'subscriptions': asked})

    def until(self, holds: Callable[[], object]) -> None:
        """Take what comes until a condition holds."""

        def step() -> None:
            if not self._take():
                raise EOFError('the server has gone')

        def arrived() -> dict[str, object]:
            seen = {topic: len(messages) for topic, messages in self.messages.items()}
            return {**seen, 'statuses': self.statuses}

        wait_until(holds, 'messages of the live view', arrived, step)

    def pause(self, seconds: float) -> None:
        """Take what comes within a while."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            if select.select([self._socket], [], [], left)[0]:
                assert self._take(), 'the server has gone'

    def to_the_end(self) -> None:
        """Take what comes until the server goes."""
        while self._take():
            pass

    def _take(self) -> bool:
        """Take what has come; False once the server has gone."""
        try:
            chunk = self._socket.recv(1 << 18)
        except ConnectionResetError:
            return False
        self._rest += chunk
        return self._heed_all() and bool(chunk)

    def _heed_all(self) -> bool:
        """Take whole frames; False once the server has said goodbye."""
        return all(self._heed(*frame) for frame in self._frames())

    def _frames(self) -> Iterator[tuple[int, bytes]]:
        """Yield whole frames: opcode and payload; a server does not mask."""
        while len(self._rest) >= 2:
            code, size = self._rest[0] & 15, self._rest[1]
            start = {126: 4, 127: 10}.get(size, 2)
            if len(self._rest) < start:
                return
            if start > 2:
                size = int.from_bytes(self._rest[2:start], 'big')
            if len(self._rest) < start + size:
                return
            payload, self._rest = self._rest[start : start + size], self._rest[start + size :]
            yield code, payload

    def _heed(self, code: int, payload: bytes) -> bool:
        if code == TEXT:
            told = json.loads(payload)
            if told['op'] == 'serverInfo':
                self.info = told
            elif told['op'] == 'advertise':
                self.channels |= {item['topic']: item for item in told['channels']}
            elif told['op'] == 'status':
                self.statuses.append(told)
        elif code == BINARY and payload[0] == DATA:
            number, when = struct.unpack_from('<IQ', payload, 1)
            self.messages.setdefault(self._topics[number], []).append((when, payload[13:]))
        elif code == BINARY and payload[0] == TIME:
            self.times.append(int.from_bytes(payload[1:9], 'little'))
        return code != CLOSE

    def close(self) -> None:
        """Leave."""
        self._socket.close()


def _connected(port: int) -> socket.socket | None:
    try:
        return socket.create_connection(('127.0.0.1', port), timeout=PATIENCE)
    except ConnectionRefusedError:
        return None
