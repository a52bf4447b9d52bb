"""Offered QoS profiles in the format of rosbag2, version 9 and later."""

from collections.abc import Sequence
from typing import Literal, TypedDict

import yaml


class QosDuration(TypedDict):
    """A duration of a QoS profile."""

    sec: int
    nsec: int


class OfferedQos(TypedDict):
    """QoS profile of one publisher; keys and order are those of rosbag2."""

    history: str
    depth: int
    reliability: str
    durability: str
    deadline: QosDuration
    lifespan: QosDuration
    liveliness: str
    liveliness_lease_duration: QosDuration
    avoid_ros_namespace_conventions: bool


def infinite_duration() -> QosDuration:
    """Return the duration that means no limit: 2^63 - 1 ns."""
    return {'sec': 9223372036, 'nsec': 854775807}


def build_offered_qos(
    reliability: Literal['reliable', 'best_effort'],
    durability: Literal['volatile', 'transient_local'],
    depth: int,
) -> OfferedQos:
    """Return a keep-last profile without deadline, lifespan or liveliness lease."""
    return {
        'history': 'keep_last',
        'depth': depth,
        'reliability': reliability,
        'durability': durability,
        'deadline': infinite_duration(),
        'lifespan': infinite_duration(),
        'liveliness': 'automatic',
        'liveliness_lease_duration': infinite_duration(),
        'avoid_ros_namespace_conventions': False,
    }


def has_mixed_durability(profiles: Sequence[OfferedQos]) -> bool:
    """Return whether only some publishers of a topic are transient local."""
    return len({each['durability'] for each in profiles}) > 1


def format_offered_qos(profiles: Sequence[OfferedQos]) -> str:
    """Return the YAML text of a channel's `offered_qos_profiles`; empty without profiles."""
    if not profiles:
        return ''
    return yaml.safe_dump([dict(profile) for profile in profiles], sort_keys=False).strip()
