"""Convert ROS diagnostics and QoS profiles for recordings."""

from collections.abc import Iterator, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_bridge.bag.qos import OfferedQos, QosDuration
from lta_bridge.fault_watch import DiagnosticsEntry
from lta_graph.ros.peer_listener import reports_end
from rclpy.duration import Duration
from rclpy.qos import HistoryPolicy, LivelinessPolicy, QoSProfile


def parse_statuses(message: DiagnosticArray) -> Iterator[DiagnosticsEntry]:
    """Yield the statuses of a diagnostics message, with faults and ends of flights."""
    for status in message.status:
        failing = status.level == DiagnosticStatus.ERROR
        yield DiagnosticsEntry(status.hardware_id, status.name, failing, reports_end(status))


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
