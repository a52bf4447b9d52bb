"""Hear the other robots of a launch: where in time they are, and when they have ended."""

from collections.abc import Callable, Sequence
import time
from typing import Any, final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_config.errors import BadInput
from lta_config.topics import is_name, robot_topic
from lta_graph.peers import Peers
from lta_graph.ros.message_types import find_message_type
from lta_graph.ros.node import GraphNode, PATIENCE
from lta_graph.ros.qos import select_profile
from lta_graph.ros.stamps import from_stamp

PULSE = 'wind'  # small, regular, and of the vehicle alone; its period is how far one may lead
ENDING = (': flight', ': playback')  # facts in which simulator and player tell how it stands
OVER = 'over'  # and the value in it


@final
class PeerListener:
    """
    The other robots, for a node that must keep step with them.

    Parameters
    ----------
    node : GraphNode
        Who listens.
    names : sequence of str
        Namespaces of the others; nothing is heard and nobody waited for where there are none.
    on_news : callable
        Called at every pulse and every end.

    Raises
    ------
    BadInput
        If a name cannot be a namespace, or is the node's own.

    """

    def __init__(self, node: GraphNode, names: Sequence[str], on_news: Callable[[], None]) -> None:
        own = node.get_namespace().strip('/')
        for name in names:
            if not is_name(name) or name == own:
                raise BadInput(
                    f"The peer '{name}' of '{own}' is no other namespace; give those of the other "
                    'robots, with spaces between.'
                )
        table = node.table
        self.names = list(names)
        self._peers = Peers(names, table.start_ns, table[PULSE].period_ns)
        self._on_news = on_news
        self._held: list[str] = []
        self._since = 0.0
        rows = [
            (robot_topic(name, PULSE), PULSE, self._build_pulse_callback(name)) for name in names
        ]
        if names:
            rows.append(('/diagnostics', '/diagnostics', self._on_diagnostics))
        self.subscriptions = [
            node.create_subscription(
                find_message_type(table[row]),
                topic,
                callback,
                select_profile(table[row], node.lockstep),
            )
            for topic, row, callback in rows
        ]

    @property
    def has_active_peers(self) -> bool:
        """Whether any of the others has not ended."""
        return bool(self._peers.active)

    @property
    def is_waiting(self) -> bool:
        """Whether the last step had to wait."""
        return bool(self._held)

    def may_advance(self, stamp_ns: int) -> bool:
        """Tell whether the node may go on to a time, and remember if it has to wait. [ns]"""
        held = self._peers.find_lagging(stamp_ns)
        if held and not self._held:
            self._since = time.monotonic()
        self._held = held
        return not held

    def list_missing(self) -> list[str]:
        """Return the pulses for which the node has been waiting longer than patience lasts."""
        if not self._held or time.monotonic() - self._since < PATIENCE:
            return []
        # Who has not begun may still load: the launcher and its own silence tell more.
        return [robot_topic(name, PULSE) for name in self._held if self._peers.has_started(name)]

    def launch_time(self, own_ns: int) -> int:
        """Return the time of the launch once the node's own has stopped. [ns]"""
        return self._peers.launch_time(own_ns)

    def _build_pulse_callback(self, name: str) -> Callable[[Any], None]:
        def record_pulse(message: Any) -> None:  # noqa: ANN401 - whatever the pulse is made of
            self._peers.record_pulse(name, from_stamp(message.header.stamp))
            self._on_news()

        return record_pulse

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id in self._peers.active and is_over(status):
                self._peers.mark_ended(status.hardware_id)
                self._on_news()


def is_over(status: DiagnosticStatus) -> bool:
    """Tell whether a simulator or a player says that it has ended and all have answered."""
    facts = {item.key: item.value for item in status.values}
    return status.name.endswith(ENDING) and facts.get(OVER) == str(True)
