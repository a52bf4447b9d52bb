# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a tap asks for: as much as all publishers offer, and no more than it wants."""

from itertools import product

from lta_graph.ros.raw_subscriptions import match_profile
import pytest
from rclpy.qos import (
    DurabilityPolicy,
    qos_check_compatible,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
)

PROFILES = [
    QoSProfile(depth=3, reliability=reliability, durability=durability)
    for reliability, durability in product(
        (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        (DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
    )
]
BESIDE = [found for count in (1, 2) for found in product(PROFILES, repeat=count)]
LEAST = {'reliability': ReliabilityPolicy.BEST_EFFORT, 'durability': DurabilityPolicy.VOLATILE}


@pytest.mark.parametrize('asked', PROFILES)
@pytest.mark.parametrize(
    'publishers', [*product(PROFILES, repeat=1), *product(PROFILES, repeat=2)]
)
def test_no_publisher_is_incompatible_and_nothing_is_given_up_without_need(asked, publishers):
    found = match_profile(asked, publishers)
    for each in publishers:
        assert qos_check_compatible(each, found)[0] != QoSCompatibility.ERROR
    for policy, least in LEAST.items():
        given_up = getattr(found, policy) != getattr(asked, policy)
        assert given_up == (
            getattr(asked, policy) != least
            and any(getattr(each, policy) == least for each in publishers)
        )
    assert found.depth == asked.depth


def test_where_nobody_is_there_everything_is_asked_for():
    assert match_profile(PROFILES[0], []) == PROFILES[0]
