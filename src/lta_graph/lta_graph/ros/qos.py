"""
Quality of service by topic: one profile in real time, another in lockstep.

Real time uses the usual ROS 2 profiles. In lockstep no message may be lost, and a node that joins
late must still get the first one. So every repeatable topic is reliable, transient local and deep.
"""

from lta_config.topics import Qos, Topic
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

PROFILES: dict[Qos, QoSProfile] = {
    'sensor': QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT),
    'command': QoSProfile(depth=1),
    'default': QoSProfile(depth=10),
    'latched': QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    'clock': QoSProfile(depth=1),
}
LOCKSTEP_HISTORY_NS = 20_000_000_000  # of graph time: how far a slow reader may fall behind


def select_profile(topic: Topic, lockstep: bool) -> QoSProfile:
    """Return the profile that publishers and subscribers of a topic use."""
    # Other topics are one-off events that a late node must not get again
    if not (lockstep and topic.repeatable):
        return PROFILES[topic.qos]
    depth = LOCKSTEP_HISTORY_NS // topic.period_ns if topic.period_ns else 100
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)
