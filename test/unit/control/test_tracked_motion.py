# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tracked poses and the estimate: the same way in both frames, and what holds after a loss."""

import math

from lta_control.odometry.tracked_motion import (
    Locator,
    LOST_NS,
    OdomMotion,
    TrackedMotion,
    TrackedPath,
)
import pytest

S = 1_000_000_000
QUARTER = 0.5 * math.pi
# Seen from odom, the map is turned by a quarter: who flies along odom x flies along map -y
ODOM = OdomMotion(S, (2.0, 0.0), 0.0, 0.0, (0.5, 0.0), (0.3, 0.1))
TRACKED = TrackedMotion(S, (7.0, 8.0), -QUARTER, (0.0, -0.5))


def test_a_tracked_way_is_added_in_the_axes_of_odom():
    path = TrackedPath()
    assert path.follow(TRACKED, ODOM, ready=True) == (2.0, 0.0)
    # 1 m along map -y is 1 m along odom x, wherever the estimate thinks it is
    later = TRACKED._replace(stamp_ns=3 * S, position=(7.0, 7.0))
    moved = ODOM._replace(stamp_ns=3 * S, position=(5.0, 5.0))
    assert path.follow(later, moved, ready=True) == pytest.approx((3.0, 0.0))


def test_a_late_pose_is_carried_on_by_its_velocity():
    """0.2 s at 0.5 m/s is 0.1 m; meanwhile the drone has turned by 0.2 s times 0.1 rad/s."""
    late = ODOM._replace(stamp_ns=S + S // 5, yaw=0.02, yaw_rate=0.1)
    located = Locator().locate(late, TRACKED)
    assert located.position == pytest.approx((7.0, 7.9))
    assert located.turn == pytest.approx(QUARTER)
    assert located.heading == pytest.approx(0.02 - QUARTER)


def test_before_the_estimate_is_ready_the_way_begins_anew():
    path = TrackedPath()
    path.follow(TRACKED, ODOM, ready=True)
    still = ODOM._replace(position=(0.0, 0.0))
    assert path.follow(TRACKED._replace(position=(1.0, 1.0)), still, ready=False) == (0.0, 0.0)


def test_between_poses_and_after_their_loss():
    locator = Locator()
    seen = locator.locate(ODOM, TRACKED)
    assert seen.tracked
    assert seen.position == (7.0, 8.0)
    assert seen.velocity == pytest.approx((0.0, -0.5))
    # Over ground less through the air: (0.2, -0.1) in odom
    assert seen.wind == pytest.approx((-0.1, -0.2))
    on = ODOM._replace(stamp_ns=2 * S, position=(2.5, 0.1))
    between = locator.locate(on, None)
    assert between.tracked
    assert between.position == pytest.approx((7.1, 7.5))
    lost = locator.locate(on._replace(stamp_ns=S + LOST_NS + 1), None)
    assert not lost.tracked
    assert (lost.position, lost.heading, lost.turn) == ((2.5, 0.1), 0.0, 0.0)


def test_a_wind_that_changes_is_followed_with_a_time_of_two_seconds():
    """A step of 0.3 m/s: after 2 s the share is 1/2."""
    locator = Locator()
    calm = ODOM._replace(air=ODOM.velocity)
    assert locator.locate(calm, None).wind == (0.0, 0.0)
    gust = ODOM._replace(stamp_ns=3 * S, air=(0.2, 0.0))
    assert locator.locate(gust, None).wind == pytest.approx((0.15, 0.0))
