"""
Read-only WebSocket server for Foxglove, based on Foxglove's SDK.

Viewers may not publish, set parameters or call services, and foreign pages may not look (see
`origin_gate`). If a viewer is slow, the SDK drops its oldest messages. The server runs in threads
of the SDK.
"""

from collections.abc import Callable, Mapping
from ipaddress import IPv4Address
import logging
import secrets
import threading
import time
from typing import final

from foxglove.websocket import Capability, ChannelView, Client, ServerListener
from lta_bridge.live.origin_gate import OriginGate
from lta_bridge.log_time_assigner import LogTimeAssigner, read_stamp
from lta_config.errors import BadInput
from lta_config.topics import TopicTable

import foxglove


@final
class RateLimiter:
    """
    Limit events to a mean rate. [Hz]

    Events at exactly this rate all pass despite jitter: one may be early by half an interval, and
    the next interval counts from when it was due.
    """

    def __init__(self, rate: float) -> None:
        self._interval = 1.0 / rate
        self._due = -float('inf')

    def try_acquire(self, now: float) -> bool:
        """Return whether an event at a wall time passes; count it if so. [s]"""
        if now < self._due - 0.5 * self._interval:
            return False
        self._due = max(self._due, now - 0.5 * self._interval) + self._interval
        return True


SCREEN_RATE = 60.0  # Hz of wall time: a usual screen rate
LARGE_MESSAGES = {'lta_msgs/msg/LightBlock': 10.0}  # Hz, limits of large messages; this has 16 kB


@final
class TopicThrottle:
    """
    Limit the rate of each topic for viewers.

    Only periodic topics with a stamp are thinned. On others, such as /diagnostics and /tf, each
    message may be from another node. `clock` returns the wall time. [s]

    Attributes `sent`, `left_out`: by topic: forwarded messages, and those dropped between them.
    """

    def __init__(self, table: TopicTable, clock: Callable[[], float] = time.monotonic) -> None:
        self._table = table
        self._clock = clock
        self._books = LogTimeAssigner(table, lockstep=False, clock=clock)
        self._paces = {
            name: RateLimiter(LARGE_MESSAGES.get(topic.type, SCREEN_RATE))
            for name, topic in table.topics.items()
            if topic.period_ns and topic.stamped
        }
        self._last: dict[str, int] = {}
        self.sent: dict[str, int] = {}
        self.left_out: dict[str, int] = {}

    @property
    def now(self) -> int:
        """Time of the newest plausible publication. [ns]"""
        return self._books.now

    def admit_message(self, name: str, data: bytes, *, has_viewers: bool) -> int | None:
        """
        Return the log time of a message to forward, None for one to drop. [ns]

        `name` is the relative topic name.
        """
        when = self._books.assign_log_time(name, data)
        if not has_viewers:
            self._last.pop(name, None)  # without viewers, messages do not count as dropped
            return None
        if name in self._paces and not self._paces[name].try_acquire(self._clock()):
            return None
        self._count_message(name, data)
        return when

    def _count_message(self, name: str, data: bytes) -> None:
        """Count a forwarded message, and by its stamp those dropped before it."""
        self.sent[name] = self.sent.get(name, 0) + 1
        topic = self._table[name]
        stamp = read_stamp(data) if topic.period_ns and topic.stamped else None
        if stamp is None:
            return
        before = self._last.get(name, stamp - topic.period_ns)
        between = (stamp - before) // topic.period_ns - 1
        if between > 0:
            self.left_out[name] = self.left_out.get(name, 0) + between
        self._last[name] = stamp


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
        """Number of viewers of any topic."""
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
        """Send a message with its log time in graph time. [ns]"""
        self._channels[topic].log(data, log_time=when_ns)

    def broadcast_time(self, now_ns: int) -> None:
        """Send the graph time to all viewers. [ns]"""
        self._server.broadcast_time(now_ns)

    def close(self) -> None:
        """Disconnect all viewers."""
        self._gate.close()
        self._server.stop()
