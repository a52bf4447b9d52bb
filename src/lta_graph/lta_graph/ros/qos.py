# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Profiles of rclpy for the quality of service of each topic, see `lta_graph.quality`."""

from collections.abc import Iterator
from contextlib import contextmanager

from lta_config.errors import BadInput
from lta_config.topics import Topic
from lta_graph.quality import select_quality
from rclpy.exceptions import InvalidParameterTypeException
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


@contextmanager
def reject_bad_overrides(name: str) -> Iterator[None]:
    """Raise `BadInput` for a parameter `qos_overrides.*` of a node that names no quality."""
    try:
        yield
    except (InvalidParameterTypeException, RuntimeError) as error:
        if 'qos' in str(error).lower():
            raise BadInput(f'{name}: {error}.') from None
        raise
