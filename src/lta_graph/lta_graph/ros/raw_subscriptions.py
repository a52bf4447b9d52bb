# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""All raw subscriptions of one node: requested topics, and others that it discovers."""

from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from typing import Any, final

from rclpy.event_handler import QoSSubscriptionEventType, SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def match_profile(preferred: QoSProfile, offered: Sequence[QoSProfile]) -> QoSProfile:
    """Return the profile nearest to `preferred` that is compatible with all publishers."""
    reliable = all(each.reliability != ReliabilityPolicy.BEST_EFFORT for each in offered)
    latched = all(each.durability != DurabilityPolicy.VOLATILE for each in offered)
    return QoSProfile(
        depth=preferred.depth,
        reliability=preferred.reliability if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=preferred.durability if latched else DurabilityPolicy.VOLATILE,
    )


@final
class RawSubscription:
    """
    A subscription to one topic that passes messages on as bytes.

    A request for more than a publisher offers would silently receive nothing, so the request is
    lowered. It is never raised again, because that would deliver latched messages twice.

    Parameters
    ----------
    name : str
        Absolute name of the topic.
    kind : type
        Class of its messages.
    preferred : QoSProfile
        The profile to request if the publishers offer it.
    callback : callable
        Gets each message as bytes.

    Attributes
    ----------
    lost : int
        Messages that the middleware reports as lost.
    publishers : int
        Publishers at the last poll.

    """

    def __init__(
        self,
        node: Node,
        name: str,
        kind: Any,
        preferred: QoSProfile,
        callback: Callable[[bytes], None],
    ) -> None:
        self.name = name
        self.lost = 0
        self._node = node
        self._kind = kind
        self._callback = callback
        self.publishers = 0
        self._subscribe(match_profile(preferred, self.list_offered_profiles()))

    def _subscribe(self, profile: QoSProfile) -> None:
        self._profile = profile
        self._subscription = self._node.create_subscription(
            self._kind,
            self.name,
            self._callback,
            profile,
            raw=True,
            # rclpy's default callbacks would only log; losses are counted in `poll_changes`
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
        )
        kind = QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST
        # A loss event of DDS, polled directly since rclpy offers only callbacks
        self._losses = _rclpy.EventHandle(self._subscription.handle, kind)

    def list_offered_profiles(self) -> list[QoSProfile]:
        """Return the distinct profiles of the known publishers."""
        profiles: list[QoSProfile] = []
        for info in self._node.get_publishers_info_by_topic(self.name):
            if info.qos_profile not in profiles:
                profiles.append(info.qos_profile)
        return profiles

    def poll_changes(self) -> bool:
        """Count losses, and return whether the number of publishers has changed."""
        # The handle must not be destroyed while it is read
        with self._losses:
            self.lost += self._losses.take_event().total_count_change
        # The number changes with every publisher that comes or goes
        before, self.publishers = self.publishers, self._node.count_publishers(self.name)
        return before != self.publishers

    def has_mismatch(self) -> bool:
        """Return whether a publisher offers less than requested and is therefore not received."""
        return match_profile(self._profile, self.list_offered_profiles()) != self._profile

    def resubscribe(self) -> None:
        """Subscribe anew with what all publishers offer."""
        self._losses.destroy_when_not_in_use()
        self._node.destroy_subscription(self._subscription)
        self._subscribe(match_profile(self._profile, self.list_offered_profiles()))


RAW_DEPTH = 1000  # messages that may wait in the middleware between two polls
GENEROUS_PROFILE = QoSProfile(depth=RAW_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def load_message_class(type_name: str) -> Any:
    """Return the Python class of a message type; None if it is not installed."""
    package, _, name = type_name.partition('/msg/')
    try:
        return getattr(import_module(f'{package}.msg'), name)
    except (ImportError, AttributeError):
        return None


@final
class RawSubscriptions:
    """
    The raw subscriptions of one node.

    `node`: the subscribing node. `receiver`: returns the callback for a topic from its name and
    type. `accepts`: returns whether to subscribe to a discovered topic, from its name and type (''
    if it has several); None to discover none.
    """

    def __init__(
        self,
        node: Node,
        receiver: Callable[[str, str], Callable[[bytes], None]],
        accepts: Callable[[str, str], bool] | None,
    ) -> None:
        self._node = node
        self._receiver = receiver
        self._accepts = accepts
        # By absolute topic name
        self._taps: dict[str, RawSubscription] = {}
        # Rejected once, so that `accepts` is not called at every poll
        self._refused: set[str] = set()

    def __getitem__(self, name: str) -> RawSubscription:
        """Return the subscription of a topic."""
        return self._taps[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the absolute names of the subscribed topics."""
        return iter(self._taps)

    @property
    def lost_counts(self) -> dict[str, int]:
        """Messages that the middleware reports as lost, by topic."""
        return {name: tap.lost for name, tap in self._taps.items() if tap.lost}

    def subscribe(
        self, name: str, type_name: str, preferred: QoSProfile = GENEROUS_PROFILE
    ) -> None:
        """
        Subscribe to a topic.

        `name`, `type_name`: absolute name and type, whose Python class must be installed.
        `preferred`: the profile to request if the publishers offer it.
        """
        deep = QoSProfile(
            # A poll may come late on a busy machine, and no message should be lost
            depth=max(RAW_DEPTH, preferred.depth),
            reliability=preferred.reliability,
            durability=preferred.durability,
        )
        kind = load_message_class(type_name)
        self._taps[name] = RawSubscription(
            self._node, name, kind, deep, self._receiver(name, type_name)
        )

    def poll_changes(self) -> list[str]:
        """Follow the graph, and return the topics whose publishers have changed."""
        changed = [name for name, tap in self._taps.items() if tap.poll_changes()]
        for name in changed:
            if self._taps[name].has_mismatch():
                self._taps[name].resubscribe()
        self._discover_topics()
        return changed

    def _discover_topics(self) -> None:
        """Subscribe to accepted topics that are new."""
        if self._accepts is None:
            return
        for name, types in self._node.get_topic_names_and_types():
            if name not in self._taps and name not in self._refused:
                # A topic with several types cannot be subscribed to as one
                type_name = types[0] if len(types) == 1 else ''
                if not self._accepts(name, type_name):
                    self._refused.add(name)
                # A topic with readers only has no offered profile yet, so ask again later
                elif self._node.count_publishers(name):
                    self.subscribe(name, type_name)
