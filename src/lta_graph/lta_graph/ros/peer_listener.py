"""
Synchronise the simulation time of several robots in one launch.

Each robot publishes a pulse with its time every `lead_ns`, and waits before it would get further
ahead of the newest pulse of any other. There is no deadlock, because the slowest robot never
waits: the pulses of the others are at most one period older than its own.
"""

from collections.abc import Callable, Sequence
import time
from typing import Any, final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_config.errors import BadInput
from lta_config.topics import is_name, robot_topic
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.node import GraphNode, REPORTED_WAIT
from lta_graph.ros.qos import select_profile
from lta_graph.ros.stamps import from_stamp


@final
class Peers:
    """
    The other robots of a launch.

    `names`: their namespaces. `start_ns`: the first stamp of every robot [ns]. `lead_ns`: pulse
    period and largest lead over a pulse [ns].
    """

    def __init__(self, names: Sequence[str], start_ns: int, lead_ns: int) -> None:
        self._start_ns, self._lead_ns = start_ns, lead_ns
        self._newest: dict[str, int] = {}
        self._flying = list(names)

    @property
    def active_robots(self) -> list[str]:
        """Robots that have not ended."""
        return list(self._flying)

    def record_pulse(self, name: str, stamp_ns: int) -> None:
        """Record a pulse. [ns]"""
        # A late or repeated pulse must not move time back
        self._newest[name] = max(stamp_ns, self._newest.get(name, self._start_ns))

    def mark_ended(self, name: str) -> None:
        """Mark a robot as ended; others stop waiting for it."""
        if name in self._flying:
            self._flying.remove(name)

    def find_lagging(self, stamp_ns: int) -> list[str]:
        """Return the robots to wait for before advancing to a time. [ns]"""
        # A robot without a pulse counts as being at the start
        limit = stamp_ns - self._lead_ns
        return [name for name in self._flying if self._newest.get(name, self._start_ns) < limit]

    def has_started(self, name: str) -> bool:
        """Return whether a robot has sent a pulse."""
        return name in self._newest

    def common_time(self, own_ns: int) -> int:
        """Return the common time after the own robot has stopped; it never decreases. [ns]"""
        others = [self._newest.get(name, self._start_ns) for name in self._flying]
        return max(own_ns, min(others, default=own_ns))


PULSE_TOPIC = 'wind'  # small, periodic and only of the vehicle; its period is the largest lead
ENDING_TASKS = (': flight', ': playback')  # tasks in which simulator and player report their state
OVER_VALUE = 'over'  # the value in these tasks


@final
class PeerListener:
    """
    The other robots of a launch, for a node that must not run ahead of them.

    `node`: the node of the own robot. `names`: namespaces of the others; without any, nothing is
    subscribed and nothing delayed. `on_news`: called at every pulse and when a robot ends. Raise
    `BadInput` if a name is not a valid namespace, or is the node's own.
    """

    def __init__(self, node: GraphNode, names: Sequence[str], on_news: Callable[[], None]) -> None:
        own = node.get_namespace().strip('/')
        for name in names:
            if not is_name(name) or name == own:
                raise BadInput(
                    f"'{name}' cannot be a peer of '{own}'; give the namespaces of the other "
                    'robots, '
                    'separated by spaces.'
                )
        table = node.table
        self.names = list(names)
        self._peers = Peers(names, table.start_ns, table[PULSE_TOPIC].period_ns)
        self._on_news = on_news
        self._held: list[str] = []
        self._since = 0.0
        rows = [
            (robot_topic(name, PULSE_TOPIC), PULSE_TOPIC, self._build_pulse_callback(name))
            for name in names
        ]
        # The topic is absolute, so it carries the reports of all robots
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
        """Whether any of the others is still running."""
        return bool(self._peers.active_robots)

    @property
    def is_waiting(self) -> bool:
        """Whether the last step had to wait."""
        return bool(self._held)

    def may_advance(self, stamp_ns: int) -> bool:
        """Return whether the node may advance to a time [ns]; record if it has to wait."""
        held = self._peers.find_lagging(stamp_ns)
        if held and not self._held:
            self._since = time.monotonic()
        self._held = held
        return not held

    def list_missing_pulses(self) -> list[str]:
        """Return the pulses that the node has been waiting for longer than `REPORTED_WAIT`."""
        if not self._held or time.monotonic() - self._since < REPORTED_WAIT:
            return []
        # A robot without a pulse may still load; the launcher reports it if it is silent
        return [
            robot_topic(name, PULSE_TOPIC) for name in self._held if self._peers.has_started(name)
        ]

    def common_time(self, own_ns: int) -> int:
        """Return the common time of the launch after the own robot has stopped. [ns]"""
        return self._peers.common_time(own_ns)

    def _build_pulse_callback(self, name: str) -> Callable[[Any], None]:
        def record_pulse(message: Any) -> None:  # noqa: ANN401 - whatever the pulse is made of
            self._peers.record_pulse(name, from_stamp(message.header.stamp))
            self._on_news()

        return record_pulse

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id in self._peers.active_robots and reports_end(status):
                self._peers.mark_ended(status.hardware_id)
                self._on_news()


def reports_end(status: DiagnosticStatus) -> bool:
    """Return whether a status reports the end of a simulator or player."""
    facts = {item.key: item.value for item in status.values}
    return status.name.endswith(ENDING_TASKS) and facts.get(OVER_VALUE) == str(True)
