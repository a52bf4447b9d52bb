"""The quality of service a publisher offered, as rosbag2 writes it from version 9 on."""

from collections.abc import Sequence
from typing import Literal, TypedDict

import yaml


class Interval(TypedDict):
    """A time span of a profile."""

    sec: int
    nsec: int


class Profile(TypedDict):
    """One publisher's profile; the keys and their order are rosbag2's."""

    history: str
    depth: int
    reliability: str
    durability: str
    deadline: Interval
    lifespan: Interval
    liveliness: str
    liveliness_lease_duration: Interval
    avoid_ros_namespace_conventions: bool


def infinite() -> Interval:
    """Return the interval that stands for no limit, 2^63 - 1 ns."""
    return {'sec': 9223372036, 'nsec': 854775807}


def offered_qos(
    reliability: Literal['reliable', 'best_effort'],
    durability: Literal['volatile', 'transient_local'],
    depth: int,
) -> Profile:
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
        'deadline': infinite(),
        'lifespan': infinite(),
        'liveliness': 'automatic',
        'liveliness_lease_duration': infinite(),
        'avoid_ros_namespace_conventions': False,
    }


def is_latched(profiles: Sequence[Profile]) -> bool:
    """Tell whether all publishers of a topic keep messages for late joiners."""
    return bool(profiles) and all(each['durability'] == 'transient_local' for each in profiles)


def is_mixed(profiles: Sequence[Profile]) -> bool:
    """Tell whether some publishers of a topic keep messages for late joiners, and some do not."""
    return len({each['durability'] for each in profiles}) > 1


def to_yaml(profiles: Sequence[Profile]) -> str:
    """Return the text of a channel's `offered_qos_profiles`; empty where none is known."""
    if not profiles:
        return ''
    return yaml.safe_dump([dict(profile) for profile in profiles], sort_keys=False).strip()
