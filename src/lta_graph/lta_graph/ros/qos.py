"""Profiles of rclpy for the quality of service of each topic, see `lta_graph.quality`."""

from lta_config.topics import Topic
from lta_graph.quality import select_quality
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def select_profile(topic: Topic, lockstep: bool) -> QoSProfile:
    """Return the profile that the publishers of a topic offer."""
    quality = select_quality(topic, lockstep)
    return QoSProfile(
        depth=quality.depth,
        reliability=ReliabilityPolicy[quality.reliability.upper()],
        durability=DurabilityPolicy[quality.durability.upper()],
    )


def select_reader_profile(topic: Topic, lockstep: bool) -> QoSProfile:
    """Return the profile that our nodes request of a topic."""
    profile = select_profile(topic, lockstep)
    if topic.qos == 'sensor' and not lockstep:
        # A repeated reading comes too late, and a driver of others may offer no more
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    return profile
