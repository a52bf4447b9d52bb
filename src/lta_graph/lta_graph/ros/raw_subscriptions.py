"""All raw subscriptions of one node: requested topics, and others that it discovers."""

from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, final

from lta_graph.ros.raw_subscription import RawSubscription
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

DEPTH = 1000  # messages that may wait in the middleware between two polls
GENEROUS = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def load_message_class(type_name: str) -> Any:  # noqa: ANN401 - a generated class
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

    They cannot be created while the node spins. `poll_changes` finds out what to change,
    `has_pending_changes` reports that there is something, and `apply_changes` does it between
    spins.

    Parameters
    ----------
    node : Node
        The subscribing node.
    receiver : callable
        Returns the callback for a topic from its name and type.
    accepts : callable or None
        Returns whether to subscribe to a discovered topic, from its name and type ('' if it has
        several); None to discover none.

    """

    def __init__(
        self,
        node: Node,
        receiver: Callable[[str, str], Callable[[bytes], None]],
        accepts: Callable[[str, str], bool] | None,
    ) -> None:
        self._node = node
        self._receiver = receiver
        self._wanted = accepts
        # By absolute topic name
        self._taps: dict[str, RawSubscription] = {}
        # Rejected once, so that `accepts` is not called at every poll
        self._refused: set[str] = set()
        self._new: dict[str, str] = {}
        self._misfits: list[RawSubscription] = []

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

    @property
    def has_pending_changes(self) -> bool:
        """Whether `apply_changes` has something to do."""
        return bool(self._new or self._misfits)

    def subscribe(self, name: str, type_name: str, preferred: QoSProfile = GENEROUS) -> None:
        """
        Subscribe to a topic; not while the node spins.

        Parameters
        ----------
        name, type_name : str
            Absolute name and type, whose Python class must be installed.
        preferred : QoSProfile
            The profile to request if the publishers offer it.

        """
        deep = QoSProfile(
            # A poll may come late on a busy machine, and no message should be lost
            depth=max(DEPTH, preferred.depth),
            reliability=preferred.reliability,
            durability=preferred.durability,
        )
        kind = load_message_class(type_name)
        self._taps[name] = RawSubscription(
            self._node, name, kind, deep, self._receiver(name, type_name)
        )

    def poll_changes(self) -> list[str]:
        """Check the graph, and return the topics whose publishers have changed."""
        changed = [name for name, tap in self._taps.items() if tap.poll_changes()]
        self._misfits = [self._taps[name] for name in changed if self._taps[name].has_mismatch()]
        self.discover_topics()
        return changed

    def discover_topics(self) -> None:
        """Find accepted topics that are not subscribed yet."""
        if self._wanted is None:
            return
        for name, types in self._node.get_topic_names_and_types():
            if name not in self._taps and name not in self._refused:
                # A topic with several types cannot be subscribed to as one
                type_name = types[0] if len(types) == 1 else ''
                if not self._wanted(name, type_name):
                    self._refused.add(name)
                # A topic with readers only has no offered profile yet, so ask again later
                elif self._node.count_publishers(name):
                    self._new[name] = type_name

    def apply_changes(self) -> None:
        """Make the changes that the last poll found."""
        for tap in self._misfits:
            tap.resubscribe()
        for name, type_name in self._new.items():
            self.subscribe(name, type_name)
        self._misfits, self._new = [], {}
