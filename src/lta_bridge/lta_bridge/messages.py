# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Record raw topics of a graph: subscribe to them, and give a bag their types and QoS profiles."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import final

from lta_bag.background_writer import BackgroundWriter
from lta_bag.metadata import has_mixed_durability, OfferedQos, QosDuration
from lta_bag.schemas import is_defined_type
from lta_bridge.intake import MessageIntake
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.ros.node import GraphNode
from lta_graph.ros.qos import select_profile
from lta_graph.ros.raw_subscriptions import GENEROUS_PROFILE, load_message_class, RawSubscriptions
from rclpy.duration import Duration
from rclpy.qos import HistoryPolicy, LivelinessPolicy, QoSProfile


def to_offered_qos(
    offered: Sequence[QoSProfile], expected: QoSProfile | None = None
) -> list[OfferedQos]:
    """
    Return QoS profiles in the format of a bag.

    `offered`: profiles of the discovered publishers; Fast DDS does not report history and depth.
    `expected`: profile of the topic table. It supplies history and depth of a publisher that
    otherwise matches it, and the whole profile if no publisher is known yet.
    """
    offers: list[OfferedQos] = []
    for each in offered or ([expected] if expected else []):
        same = expected is not None and (each.reliability, each.durability) == (
            expected.reliability,
            expected.durability,
        )
        history_source = expected if same and each.history == HistoryPolicy.UNKNOWN else each
        profile = OfferedQos(
            history=(history_source or each).history.name.lower(),
            depth=(history_source or each).depth,
            reliability=each.reliability.name.lower(),
            durability=each.durability.name.lower(),
            deadline=to_qos_duration(each.deadline),
            lifespan=to_qos_duration(each.lifespan),
            liveliness=_format_liveliness(each.liveliness),
            liveliness_lease_duration=to_qos_duration(each.liveliness_lease_duration),
            avoid_ros_namespace_conventions=each.avoid_ros_namespace_conventions,
        )
        if profile not in offers:
            offers.append(profile)
    return offers


def _format_liveliness(policy: LivelinessPolicy) -> str:
    """Return the name of a policy; the system default is automatic."""
    default = policy == LivelinessPolicy.SYSTEM_DEFAULT
    return (LivelinessPolicy.AUTOMATIC if default else policy).name.lower()


def to_qos_duration(duration: Duration) -> QosDuration:
    """Convert a duration; 0 means no limit and becomes 2^63 - 1 ns."""
    total = duration.nanoseconds or 2**63 - 1
    return {'sec': total // 1_000_000_000, 'nsec': total % 1_000_000_000}


@final
class RecordedTopics:
    """
    The topics that a node records.

    Parameters
    ----------
    node : GraphNode
        Subscribes.
    topics : mapping
        Absolute names and types.
    is_everything : bool
        Whether to record all topics that are discovered, too.
    intake : MessageIntake
        Gets the messages.
    writer : BackgroundWriter
        Gets types and QoS profiles.

    """

    def __init__(
        self,
        node: GraphNode,
        topics: Mapping[str, str],
        is_everything: bool,
        intake: MessageIntake,
        writer: BackgroundWriter,
    ) -> None:
        self._table, self._lockstep = node.table, node.lockstep
        self._intake, self._writer = intake, writer
        self._types: dict[str, str] = {}
        self._announced: set[str] = set()
        self._offers: dict[str, list[OfferedQos]] = {}
        self._left_out: dict[str, str] = {}
        self._taps = RawSubscriptions(
            node, self._build_tap_receiver, self._accepts_topic if is_everything else None
        )
        for name, type_name in topics.items():
            if load_message_class(type_name) is None:  # tf2_msgs has to be compiled
                self._left_out[name] = type_name
            else:
                self._taps.subscribe(name, type_name, self._expected_profile(name))

    @property
    def lost_counts(self) -> Mapping[str, int]:
        """Return the number of messages lost by the middleware, by topic."""
        return self._taps.lost_counts

    def poll(self) -> Iterator[HealthFact]:
        """Follow the publishers of the topics, and yield what is missing in the bag."""
        for name in self._taps.poll_changes():
            if self._taps[name].publishers:
                self._update_topic_qos(name)
        if mixed := [
            name for name, profiles in self._offers.items() if has_mixed_durability(profiles)
        ]:
            yield HealthFact(
                'latched',
                HealthLevel.WARN,
                f'messages of {", ".join(mixed)} from before the start of the recorder are '
                'missing, because some publishers do not have transient-local durability; '
                'start the recorder first',
            )
        if self._left_out:
            yield HealthFact(
                'left out',
                HealthLevel.WARN,
                'some topics are not recorded, because their message types are neither in ROS 2 '
                "Jazzy's common interfaces nor in an installed package",
                dict(self._left_out),
            )

    def announce_silent(self) -> None:
        """List topics without messages in the bag, too."""
        for name in self._taps:
            if name not in self._announced:
                self._update_topic_qos(name)

    def _expected_profile(self, name: str) -> QoSProfile:
        """Return the expected QoS profile of a topic."""
        topic = self._table.topics.get(self._intake.find_owner(name)[1])
        return select_profile(topic, self._lockstep) if topic else GENEROUS_PROFILE

    def _accepts_topic(self, name: str, type_name: str) -> bool:
        """Return whether to record a discovered topic; note those of unknown types."""
        if not self._intake.covers_topic(name):
            return False
        is_decodable = is_defined_type(type_name) and load_message_class(type_name) is not None
        if not is_decodable:
            self._left_out[name] = type_name or 'several types'
        return is_decodable

    def _build_tap_receiver(self, name: str, type_name: str) -> Callable[[bytes], None]:
        """Return the callback for the messages of a topic."""
        self._types[name] = type_name
        announced, take = self._announced, self._intake.create_topic_callback(name)

        def receive_message(data: bytes) -> None:
            if name not in announced:
                self._update_topic_qos(name)
            take(data)

        return receive_message

    def _update_topic_qos(self, name: str) -> None:
        """Pass the QoS profiles of a topic's present and former publishers to the bag."""
        offered, expected = self._taps[name].list_offered_profiles(), self._expected_profile(name)
        earlier = self._offers.setdefault(name, [])
        fresh = [
            each for each in to_offered_qos(offered, expected) if offered and each not in earlier
        ]
        earlier += fresh
        if name not in self._announced:
            self._announced.add(name)
            offers = list(earlier) or to_offered_qos([], expected)
            self._writer.add_topic(name, self._types[name], offers)
        elif fresh:
            self._writer.update_qos(name, list(earlier))
