"""A raw subscription that takes what the publishers of a topic offer, and tells what was lost."""

from collections.abc import Callable, Sequence
from typing import Any, final

from rclpy.event_handler import QoSSubscriptionEventType, SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def match_profile(preferred: QoSProfile, offered: Sequence[QoSProfile]) -> QoSProfile:
    """Return the profile nearest to `asked` that no publisher's is incompatible with."""
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
    One topic, taken as bytes.

    Of publishers that offer less than is asked, nothing would come and nobody would say so: then
    less is asked. More is never asked later, because that would bring latched messages twice.

    Parameters
    ----------
    node : Node
        Who listens.
    name : str
        Absolute name of the topic.
    kind : type
        Class of its messages.
    asked : QoSProfile
        What to ask for where the publishers offer it.
    callback : callable
        Gets each message as bytes.

    Attributes
    ----------
    lost : int
        Messages that the middleware has counted as lost on the way.
    publishers : int
        Publishers at the last look.

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
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
        )
        kind = QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST
        self._losses = _rclpy.EventHandle(self._subscription.handle, kind)

    def list_offered_profiles(self) -> list[QoSProfile]:
        """Return the profiles of the publishers that are known, each once."""
        found: list[QoSProfile] = []
        for info in self._node.get_publishers_info_by_topic(self.name):
            if info.qos_profile not in found:
                found.append(info.qos_profile)
        return found

    def poll_changes(self) -> bool:
        """Count what was lost, and tell whether publishers have come or gone."""
        with self._losses:
            self.lost += self._losses.take_event().total_count_change
        before, self.publishers = self.publishers, self._node.count_publishers(self.name)
        return before != self.publishers

    def has_mismatch(self) -> bool:
        """Tell whether a publisher offers less than is asked, so that nothing comes from it."""
        return match_profile(self._asked, self.list_offered_profiles()) != self._asked

    def resubscribe(self) -> None:
        """Ask for what all publishers offer; not while the node spins."""
        self._losses.destroy_when_not_in_use()
        self._node.destroy_subscription(self._subscription)
        self._subscribe(match_profile(self._asked, self.list_offered_profiles()))
