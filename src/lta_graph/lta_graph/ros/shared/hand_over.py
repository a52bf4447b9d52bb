"""
Hand messages from node to node within one process.

A message goes to the readers of its process through a queue. The middleware gets it only if there
are readers outside, or if some may come late and want it. Its own copy then comes back to the
readers of this process, and is dropped: it is recognised by its bytes.

Readers share the message object, so nobody may change a message after its publication.
"""

from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache, partial
import struct
from typing import Any, final

from lta_graph.cdr_encoder import encode_cdr, import_item_class, parse_field
from lta_graph.rejections import RejectionCount
from lta_graph.ros.cdr_decoder import decode_cdr
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, qos_check_compatible, QoSCompatibility
from rclpy.service import Service
from rclpy.subscription import Subscription

ECHOES = 5000  # messages of one reader that may be under way in the middleware
_SINGLE = struct.Struct('f')


@final
@dataclass(slots=True, eq=False)
class LocalReader:
    """A subscription, as the publishers of its process see it."""

    node: Node
    callback: Callable[[Any], None]
    receive_data: Callable[[bytes], None]  # calls back with the message of some bytes
    raw: bool  # whether the callback gets bytes
    # Bytes that the middleware will deliver although they were handed over already
    echoes: deque[bytes] = field(default_factory=lambda: deque(maxlen=ECHOES))
    subscription: Any = None

    def receive_outside(self, data: bytes) -> None:
        """Pass on what the middleware has delivered, if it is from another process."""
        # In the order of their publication, so the first is the one in general
        if self.echoes and data in self.echoes:
            while self.echoes.popleft() != data:
                pass
            return
        self.receive_data(data)


@final
class HandOver:
    """
    The messages under way between the nodes of one process.

    Attributes
    ----------
    queue : deque of (LocalReader, object)
        Messages, or bytes for raw readers, in the order of publication.
    changes : int
        How often the readers have changed.
    rounds : int
        How often the process has looked at the middleware. Publishers look for readers outside
        once a round, since asking takes as long as handing over.

    """

    def __init__(self) -> None:
        self.queue: deque[tuple[LocalReader, Any]] = deque()
        self.changes = self.rounds = 0
        self._readers: dict[str, list[LocalReader]] = defaultdict(list)

    def list_readers(self, topic: str) -> list[LocalReader]:
        """Return the readers of an absolute topic; the list is kept up to date."""
        return self._readers[topic]

    def add_reader(self, topic: str, reader: LocalReader) -> None:
        """Add a reader of an absolute topic."""
        self._readers[topic].append(reader)
        self.changes += 1

    def remove_reader(self, subscription: Subscription) -> None:
        """Remove the reader of a subscription, which gets no further message."""
        for readers in self._readers.values():
            readers[:] = [one for one in readers if one.subscription is not subscription]
        remaining = [item for item in self.queue if item[0].subscription is not subscription]
        self.queue.clear()
        self.queue.extend(remaining)
        self.changes += 1


class CdrPublisher(Publisher):
    """A publisher that encodes its messages by `encode_cdr`, faster than rclpy would."""

    def publish(self, msg: Any) -> None:  # noqa: ANN401 - whatever the topic carries
        """Publish a message, or its bytes."""
        super().publish(msg if isinstance(msg, bytes) else encode_cdr(msg))


@final
class LocalPublisher(CdrPublisher):
    """
    A publisher that hands its messages over to the readers of its process.

    Attribute `latched`: whether the middleware gets every message, for readers outside that come
    late.
    """

    def __init__(self, hand_over: HandOver, *arguments: Any, **more: Any) -> None:  # noqa: ANN401
        super().__init__(*arguments, **more)
        self._hand_over = hand_over
        self._readers = hand_over.list_readers(self.topic_name)
        self._round = build_rounding(self.msg_type)
        self._seen = (-1, -1)
        self._matched = 0
        self._outside = False
        self.latched = self.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL

    def publish(self, msg: Any) -> None:  # noqa: ANN401 - whatever the topic carries
        """Publish a message, or its bytes."""
        outside = self.latched or self._has_outside_readers()
        if not self._readers:
            if outside:
                super().publish(msg)
            return
        data = msg if isinstance(msg, bytes) else None
        message = decode_cdr(data, self.msg_type) if data is not None else msg
        if self._round is not None:
            self._round(message)
        if data is None and (outside or any(reader.raw for reader in self._readers)):
            data = encode_cdr(message)
        put = self._hand_over.queue.append
        for reader in self._readers:
            put((reader, data if reader.raw else message))
        if outside:
            # Before the message leaves: it may be back at once
            for reader in self._readers:
                if data is not None:
                    reader.echoes.append(data)
            super().publish(data)

    def wait_for_all_acked(self, *arguments: Any) -> bool:  # noqa: ANN401 - as rclpy
        """
        Wait as `rclpy.publisher.Publisher` does, but only for readers of other processes.

        Those of this process have their messages, and acknowledge the middleware's copy of a
        latched one at its next heartbeat, seconds later.
        """
        return not self._has_outside_readers() or super().wait_for_all_acked(*arguments)

    def _has_outside_readers(self) -> bool:
        """Return whether more readers have matched than there are in this process."""
        now = self._hand_over.changes, self._hand_over.rounds
        if now == self._seen:
            return self._outside
        if now[0] != self._seen[0]:
            self._matched = sum(
                qos_check_compatible(self.qos_profile, reader.subscription.qos_profile)[0]
                != QoSCompatibility.ERROR
                for reader in self._readers
            )
        self._seen = now
        self._outside = self.get_subscription_count() > self._matched
        return self._outside


@cache
def build_rounding(kind: Any) -> Callable[[Any], None] | None:  # noqa: ANN401 - a generated class
    """
    Return a function that rounds the float32 fields of a message; None if it has none.

    Python holds them in double precision until they are sent. Arrays round when they are filled.
    """
    steps: list[Callable[[Any], None]] = []
    for name, described in kind.get_fields_and_field_types().items():
        if described == 'float':
            steps.append(partial(_round_field, name))
            continue
        is_sequence, item, size = parse_field(described)
        if '/' not in item:
            continue
        if (step := build_rounding(import_item_class(item))) is not None:
            steps.append(partial(_round_parts, name, step, is_sequence or size > 0))
    if not steps:
        return None

    def round_message(message: Any) -> None:  # noqa: ANN401 - of the type
        for step in steps:
            step(message)

    return round_message


def _round_field(name: str, message: Any) -> None:  # noqa: ANN401 - a generated class
    setattr(message, name, _SINGLE.unpack(_SINGLE.pack(getattr(message, name)))[0])


def _round_parts(name: str, step: Callable[[Any], None], several: bool, message: Any) -> None:  # noqa: ANN401
    part = getattr(message, name)
    for one in part if several else (part,):
        step(one)


@final
@dataclass(frozen=True, slots=True)
class NodePlace:
    """Where the next node is created: in which process, and with which command line."""

    hand_over: HandOver
    arguments: Sequence[str]


_PLACE: ContextVar[NodePlace | None] = ContextVar('place', default=None)


@contextmanager
def place_node(hand_over: HandOver, arguments: Sequence[str]) -> Iterator[None]:
    """Let the node that is created meanwhile share messages, with arguments of its own."""
    token = _PLACE.set(NodePlace(hand_over, arguments))
    try:
        yield
    finally:
        _PLACE.reset(token)


@final
class ServiceFault(Exception):
    """The fault of a node in a service, which the executor of all nodes would raise."""

    def __init__(self, node: Node, error: Exception) -> None:
        super().__init__(str(error))
        self.node, self.error = node, error


class SharingNode(Node):
    """
    A node that hands messages over within its process, if it was created for that.

    Attribute `undecodable`: received data that are no message of their topic, which are dropped.
    """

    def __init__(self, name: str) -> None:
        place = _PLACE.get()
        self.undecodable = RejectionCount()
        # rclpy's constructor creates publishers
        self.hand_over = None if place is None else place.hand_over
        own = (
            {}
            if place is None
            else {'cli_args': list(place.arguments), 'use_global_arguments': False}
        )
        super().__init__(name, **own)

    def create_publisher(self, *arguments: Any, **more: Any) -> Publisher:  # noqa: ANN401 - as rclpy
        """Return a publisher as `rclpy.node.Node` does."""
        more['publisher_class'] = (
            CdrPublisher if self.hand_over is None else partial(LocalPublisher, self.hand_over)
        )
        return super().create_publisher(*arguments, **more)

    def create_service(
        self,
        srv_type: Any,  # noqa: ANN401 - a generated class
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        **more: Any,  # noqa: ANN401 - as rclpy
    ) -> Service:
        """Return a service as `rclpy.node.Node` does."""
        if self.hand_over is None:
            return super().create_service(srv_type, srv_name, callback, **more)

        def serve(request: Any, response: Any) -> Any:  # noqa: ANN401 - of the type
            try:
                return callback(request, response)
            except Exception as error:
                raise ServiceFault(self, error) from error

        return super().create_service(srv_type, srv_name, serve, **more)

    def create_subscription(
        self,
        msg_type: Any,  # noqa: ANN401 - a generated class
        topic: str,
        callback: Callable[[Any], None],
        *arguments: Any,  # noqa: ANN401 - as rclpy
        raw: bool = False,
        **more: Any,  # noqa: ANN401 - as rclpy
    ) -> Subscription:
        """Return a subscription as `rclpy.node.Node` does."""
        receive_data = callback if raw else self._build_decoder(msg_type, topic, callback)
        if self.hand_over is None:
            return super().create_subscription(
                msg_type, topic, receive_data, *arguments, raw=True, **more
            )
        reader = LocalReader(self, callback, receive_data, raw)
        # Bytes, to recognise what was handed over already
        subscription = super().create_subscription(
            msg_type, topic, reader.receive_outside, *arguments, raw=True, **more
        )
        reader.subscription = subscription
        self.hand_over.add_reader(subscription.topic_name, reader)
        return subscription

    def _build_decoder(
        self,
        msg_type: Any,  # noqa: ANN401 - a generated class
        topic: str,
        callback: Callable[[Any], None],
    ) -> Callable[[bytes], None]:
        """Return a function that decodes a message and calls back with it."""

        def receive_data(data: bytes) -> None:
            try:
                message = decode_cdr(data, msg_type)
            except ValueError as error:
                self.undecodable.add(f'{topic}: {error}')
            else:
                callback(message)

        return receive_data

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy a subscription as `rclpy.node.Node` does."""
        if self.hand_over is not None:
            self.hand_over.remove_reader(subscription)
        return super().destroy_subscription(subscription)
