# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read-only WebSocket server for Foxglove, based on Foxglove's SDK.

Viewers may not publish, set parameters or call services, and foreign pages may not look (see
`origin_gate`). If a viewer is slow, the SDK drops its oldest messages. The server runs in threads
of the SDK.
"""

from collections.abc import Mapping
from ipaddress import IPv4Address
import logging
import secrets
import threading
from typing import final

import foxglove
from foxglove.websocket import Capability, ChannelView, Client, ServerListener
from lta_bridge.live.origin_gate import OriginGate
from lta_config.errors import BadInput

LOOPBACK = int(IPv4Address('127.1.0.0'))  # addresses of this machine alone (RFC 1122, 3.2.1.3)
LOOPBACK_SIZE = int(IPv4Address('127.255.255.255')) - LOOPBACK
BACKLOG = 512  # queue limit of messages for a slow viewer

# Do not log viewers that disconnect or send forbidden requests.
logging.getLogger('foxglove').addHandler(logging.NullHandler())


@final
class Audience(ServerListener):
    """Track the viewers of each topic; called by threads of the SDK."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._looks: set[tuple[int, str]] = set()  # client and topic
        self._newcomers: set[str] = set()

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Add a viewer of a topic."""
        with self._lock:
            self._looks.add((client.id, channel.topic))
            self._newcomers.add(channel.topic)

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:
        """Remove a viewer of a topic."""
        with self._lock:
            self._looks.discard((client.id, channel.topic))

    @property
    def viewer_count(self) -> int:
        """Return the number of viewers of any topic."""
        with self._lock:
            return len({client for client, _ in self._looks})

    def has_new_viewer(self, topic: str) -> bool:
        """Return whether a topic has a new viewer since the last call."""
        with self._lock:
            is_new = topic in self._newcomers
            self._newcomers.discard(topic)
            return is_new


@final
class LiveServer:
    """
    Serve channels of serialised messages.

    `name`: name of the source, shown to viewers. `host`, `port`: address to listen on. `channels`:
    encoding and schema by topic. Raise `BadInput` if the address cannot be listened on.
    """

    def __init__(
        self, name: str, host: str, port: int, channels: Mapping[str, tuple[str, foxglove.Schema]]
    ) -> None:
        self.audience = Audience()
        context = self._context = foxglove.Context()  # channels end with it
        self._channels = {
            topic: foxglove.Channel(
                topic, message_encoding=encoding, schema=schema, context=context
            )
            for topic, (encoding, schema) in channels.items()
        }
        # No page can know this address, so all have to pass the gate
        address = str(IPv4Address(LOOPBACK + secrets.randbelow(LOOPBACK_SIZE)))
        self._server = foxglove.start_server(
            name=name,
            host=address,
            port=0,
            capabilities=[Capability.Time],
            server_listener=self.audience,
            context=context,
            message_backlog_size=BACKLOG,
        )
        try:
            self._gate = OriginGate(host, port, (address, self._server.port))
        except BadInput:
            self._server.stop()
            raise

    def has_viewers(self, topic: str) -> bool:
        """Return whether a topic has viewers."""
        return self._channels[topic].has_sinks()

    def send_message(self, topic: str, data: bytes, when_ns: int) -> None:
        """Send a message with its log time in graph time [ns]."""
        self._channels[topic].log(data, log_time=when_ns)

    def broadcast_time(self, now_ns: int) -> None:
        """Send the graph time to all viewers [ns]."""
        self._server.broadcast_time(now_ns)

    def close(self) -> None:
        """Disconnect all viewers."""
        self._gate.close()
        self._server.stop()
