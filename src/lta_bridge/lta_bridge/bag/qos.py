"""The quality of service a publisher offered, as rosbag2 writes it from version 9 on."""

from collections.abc import Sequence
from typing import Literal, TypedDict

import yaml


class QosDuration(TypedDict):
    """A time span of a profile."""

    sec: int
    nsec: int


class OfferedQos(TypedDict):
    """One publisher's profile; the keys and their order are rosbag2's."""

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
    """Return the interval that stands for no limit, 2^63 - 1 ns."""
    return {'sec': 9223372036, 'nsec': 854775807}


def build_offered_qos(
    reliability: Literal['reliable', 'best_effort'],
    durability: Literal['volatile', 'transient_local'],
    depth: int,
) -> OfferedQos:
    """
    Return a profile that keeps the last messages, without deadline, lifespan or lease.

    Parameters
    ----------
    reliability : str
        'reliable' or 'best_effort'.
    durability : str
        'volatile' or 'transient_local'.
    depth : int
        Messages kept.

    """
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


def is_latched(profiles: Sequence[OfferedQos]) -> bool:
    """Tell whether all publishers of a topic keep messages for late joiners."""
    return bool(profiles) and all(each['durability'] == 'transient_local' for each in profiles)


def has_mixed_durability(profiles: Sequence[OfferedQos]) -> bool:
    """Tell whether some publishers of a topic keep messages for late joiners, and some do not."""
    return len({each['durability'] for each in profiles}) > 1


def format_offered_qos(profiles: Sequence[OfferedQos]) -> str:
    """Return the text of a channel's `offered_qos_profiles`; empty where none is known."""
    if not profiles:
        return ''
    return yaml.safe_dump([dict(profile) for profile in profiles], sort_keys=False).strip()
