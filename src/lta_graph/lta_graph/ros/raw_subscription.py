"""Subscribe to serialised messages with a compatible quality of service, and count losses."""

from collections.abc import Callable, Sequence
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
    node : Node
        The subscribing node.
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
        kind: Any,  # noqa: ANN401 - a generated class
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
        self._asked = profile
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
        found: list[QoSProfile] = []
        for info in self._node.get_publishers_info_by_topic(self.name):
            if info.qos_profile not in found:
                found.append(info.qos_profile)
        return found

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
        return match_profile(self._asked, self.list_offered_profiles()) != self._asked

    def resubscribe(self) -> None:
        """Subscribe anew with what all publishers offer; not while the node spins."""
        self._losses.destroy_when_not_in_use()
        self._node.destroy_subscription(self._subscription)
        self._subscribe(match_profile(self._asked, self.list_offered_profiles()))
