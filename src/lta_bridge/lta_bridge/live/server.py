"""
A WebSocket server that Foxglove connects to, by Foxglove's own SDK: it shows, and takes nothing.

Viewers can look and nothing else: they may not publish, set parameters or call services. What a
slow one cannot take is dropped by the SDK, oldest first. The server runs in threads of the SDK's.
"""

from collections.abc import Mapping
import logging
import threading
from typing import final

from foxglove.websocket import Capability, ChannelView, Client, ServerListener
from lta_bridge.live.address import build_port_error

import foxglove

BACKLOG = 512  # messages that may wait for a slow viewer

# Viewers that leave in a hurry, or ask for what they may not have, are no news to a flight.
logging.getLogger('foxglove').addHandler(logging.NullHandler())


@final
class Audience(ServerListener):
    """Who looks at what; called by threads of the SDK."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._looks: set[tuple[int, str]] = set()
        self._newcomers: set[str] = set()

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Take note of somebody who begins to look at a topic."""
        with self._lock:
            self._looks.add((client.id, channel.topic))
            self._newcomers.add(channel.topic)

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:
        """Take note of somebody who no longer looks at a topic."""
        with self._lock:
            self._looks.discard((client.id, channel.topic))

    @property
    def viewer_count(self) -> int:
        """How many look at anything."""
        with self._lock:
            return len({client for client, _ in self._looks})

    def pop_newcomer(self, topic: str) -> bool:
        """Tell whether somebody has begun to look at a topic since this was last asked."""
        with self._lock:
            found = topic in self._newcomers
            self._newcomers.discard(topic)
            return found


@final
class LiveServer:
    """
    Serve channels of serialised messages.

    Parameters
    ----------
    name : str
        What viewers see as the source.
    host, port : str and int
        Where to listen.
    channels : mapping of str to (str, foxglove.Schema)
        By topic: how its messages are encoded, and what they are.

    Raises
    ------
    BadInput
        If nothing can listen there.

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
        try:
            self._server = foxglove.start_server(
                name=name,
                host=host,
                port=port,
                capabilities=[Capability.Time],
                server_listener=self.audience,
                context=context,
                message_backlog_size=BACKLOG,
            )
        except (OSError, RuntimeError, ValueError) as error:
            raise build_port_error(
                port, str(error).rpartition(': ')[2].partition(' (os error')[0]
            ) from None

    def has_viewers(self, topic: str) -> bool:
        """Tell whether anybody looks at a topic."""
        return self._channels[topic].has_sinks()

    def send_message(self, topic: str, data: bytes, when_ns: int) -> None:
        """Show a message, logged at a graph time. [ns]"""
        self._channels[topic].log(data, log_time=when_ns)

    def broadcast_time(self, now_ns: int) -> None:
        """Tell all viewers the graph time. [ns]"""
        self._server.broadcast_time(now_ns)

    def close(self) -> None:
        """Let all viewers go."""
        self._server.stop()
