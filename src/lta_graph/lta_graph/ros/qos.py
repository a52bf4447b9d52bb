"""Profiles of rclpy for the quality of service of each topic, see `lta_graph.quality`."""

from lta_config.topics import Topic
from lta_graph.quality import select_quality
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def select_profile(topic: Topic, lockstep: bool) -> QoSProfile:
    """Return the profile that publishers and subscribers of a topic use."""
    quality = select_quality(topic, lockstep)
    return QoSProfile(
        depth=quality.depth,
        reliability=ReliabilityPolicy[quality.reliability.upper()],
        durability=DurabilityPolicy[quality.durability.upper()],
    )
