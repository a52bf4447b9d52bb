"""All topics that one node takes as bytes: the ones it asks for, and what else it finds."""

from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, final

from lta_graph.ros.raw_subscription import RawSubscription
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

DEPTH = 1000  # messages that may wait in the middleware between two looks
GENEROUS = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def load_message_class(type_name: str) -> Any:  # noqa: ANN401 - a generated class
    """Return the Python class of a message type; None where it is not installed."""
    package, _, name = type_name.partition('/msg/')
    try:
        return getattr(import_module(f'{package}.msg'), name)
    except (ImportError, AttributeError):
        return None


@final
class RawSubscriptions:
    """
    The taps of one node.

    Subscriptions cannot be made while the node spins: `poll_changes` finds out what is to be done,
    `has_pending_changes`
    tells that there is something, and `apply_changes` does it between two spins.

    Parameters
    ----------
    node : Node
        Who listens.
    receiver : callable
        Returns what takes the messages of a topic, from its name and type.
    wanted : callable or None
        Tells of a topic on the graph, from its name and its type ('' where it has several),
        whether to take it; None where nothing is taken but what was asked for.

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
        self._taps: dict[str, RawSubscription] = {}
        self._refused: set[str] = set()
        self._new: dict[str, str] = {}
        self._misfits: list[RawSubscription] = []

    def __getitem__(self, name: str) -> RawSubscription:
        """Return the tap of a topic."""
        return self._taps[name]

    def __iter__(self) -> Iterator[str]:
        """Return the absolute names of the topics that are taken."""
        return iter(self._taps)

    @property
    def lost_counts(self) -> dict[str, int]:
        """Messages that the middleware counts as lost, by topic."""
        return {name: tap.lost for name, tap in self._taps.items() if tap.lost}

    @property
    def has_pending_changes(self) -> bool:
        """Whether there is something to mend."""
        return bool(self._new or self._misfits)

    def subscribe(self, name: str, type_name: str, preferred: QoSProfile = GENEROUS) -> None:
        """
        Take a topic from now on; not while the node spins.

        Parameters
        ----------
        name, type_name : str
            Absolute name and type, whose Python class must be installed.
        asked : QoSProfile
            What to ask for where the publishers offer it.

        """
        deep = QoSProfile(
            depth=max(DEPTH, preferred.depth),
            reliability=preferred.reliability,
            durability=preferred.durability,
        )
        kind = load_message_class(type_name)
        self._taps[name] = RawSubscription(
            self._node, name, kind, deep, self._receiver(name, type_name)
        )

    def poll_changes(self) -> list[str]:
        """Look at the graph, and return the topics whose publishers have come or gone."""
        changed = [name for name, tap in self._taps.items() if tap.poll_changes()]
        self._misfits = [self._taps[name] for name in changed if self._taps[name].has_mismatch()]
        self.discover_topics()
        return changed

    def discover_topics(self) -> None:
        """Look for topics that are wanted and not taken yet."""
        if self._wanted is None:
            return
        for name, types in self._node.get_topic_names_and_types():
            if name not in self._taps and name not in self._refused:
                type_name = types[0] if len(types) == 1 else ''
                if not self._wanted(name, type_name):
                    self._refused.add(name)
                elif self._node.count_publishers(name):
                    self._new[name] = type_name

    def apply_changes(self) -> None:
        """Do what the last look found to be done."""
        for tap in self._misfits:
            tap.resubscribe()
        for name, type_name in self._new.items():
            self.subscribe(name, type_name)
        self._misfits, self._new = [], {}
