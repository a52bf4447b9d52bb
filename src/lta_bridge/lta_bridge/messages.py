"""Convert ROS QoS profiles for recordings."""

from collections.abc import Sequence

from lta_bridge.bag.metadata import OfferedQos, QosDuration
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
