# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The tracker's core: poses chained, sieved, dated, and their motion, against hand calculation."""

import math
import sys
from types import ModuleType
from typing import NamedTuple

from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion
from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.tracking.messages import find_pose_type, to_stamped_pose
from lta_bridge.tracking.motion import estimate_motion, GAP_NS, MotionWindow
from lta_bridge.tracking.pose import (
    angle_between,
    build_level_pose,
    compose_poses,
    MapCorrection,
    TrackerPose,
)
from lta_bridge.tracking.tracked_drone import (
    FOUND_NS,
    FROZEN_NS,
    PoseFault,
    PoseFilter,
    SILENT_TRACKER_NS,
    TrackedDrone,
)
from lta_config.errors import BadInput
from lta_graph.health import HealthLevel
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

MS = 1_000_000
S = 1000 * MS
TEN = 10 * MS
NOWHERE = TrackerPose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
numbers = st.floats(-10.0, 10.0)
places = st.tuples(numbers, numbers, numbers)
turns = st.integers(0, 2**32 - 1).map(
    lambda seed: tuple(Rotation.random(rng=np.random.default_rng(seed)).as_quat().tolist())
)
poses = st.builds(TrackerPose, places, turns)


class NamedPose(NamedTuple):
    """A message of `motion_capture_tracking_interfaces`, which no wheel has."""

    name: str
    pose: Pose


class NamedPoses(NamedTuple):
    """The same of several bodies."""

    poses: list[NamedPose]


@given(poses, poses, places)
def test_chained_poses_are_matrices_multiplied(a, b, point):
    c = compose_poses(a, b)
    ra, rb, rc = (Rotation.from_quat(each.turn).as_matrix() for each in (a, b, c))
    inner = rb @ point + b.place
    assert rc @ point + c.place == pytest.approx(ra @ inner + a.place, abs=1e-9)
    cosine = 0.5 * (np.trace(ra.T @ rb) - 1.0)
    assert math.cos(angle_between(a.turn, b.turn)) == pytest.approx(cosine, abs=1e-9)


@given(
    places,
    st.tuples(*[st.floats(-0.5, 0.5)] * 3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    st.lists(st.integers(1, 40), min_size=6, max_size=12),
)
def test_a_motion_of_constant_acceleration_is_exact_whatever_the_spacing(
    place, velocity, acceleration, steps
):
    """Poses come unevenly; velocity at each is that of the parabola, in the body's frame."""
    stamps = np.cumsum([0, *steps]) * 5 * MS
    turn = build_level_pose(0, 0, 0, 1.0).turn
    t = 1e-9 * stamps[:, None]
    path = np.array(place) + np.array(velocity) * t + 0.5 * np.array(acceleration) * t * t
    window = MotionWindow()
    told = [
        motion
        for stamp, at in zip(stamps.tolist(), path.tolist(), strict=True)
        for motion in window.add_pose(stamp, TrackerPose(tuple(at), turn))
    ]
    for motion in told:
        now = np.array(velocity) + np.array(acceleration) * 1e-9 * motion.stamp_ns
        own = Rotation.from_quat(turn).inv().apply(now)
        assert motion.velocity == pytest.approx(own, abs=1e-6)
        assert motion.rates == pytest.approx((0, 0, 0), abs=1e-9)
    assert [motion.stamp_ns for motion in told] == sorted({m.stamp_ns for m in told})


def test_rates_are_about_the_body_s_own_axes():
    start, rates = Rotation.from_euler('xyz', [0.3, -0.2, 1.0]), np.array([0.1, -0.4, 0.8])
    turned = [start * Rotation.from_rotvec(rates * 0.01 * k) for k in range(11)]
    seen = [
        (k * TEN, TrackerPose((0, 0, 0), tuple(turn.as_quat()))) for k, turn in enumerate(turned)
    ]
    assert estimate_motion(seen, 50 * MS).rates == pytest.approx(rates, abs=1e-6)


def test_deviations_say_what_noise_does():
    """Deviations of places and velocities are those that repeated noise makes [1 mm, 100 Hz]."""
    rng = np.random.default_rng(1)
    found = [
        estimate_motion(
            [
                (k * TEN + S, TrackerPose(tuple(rng.normal(0, 1e-3, 3)), NOWHERE.turn))
                for k in range(11)
            ],
            50 * MS + S,
        )
        for _ in range(300)
    ]
    velocities = np.array([motion.velocity for motion in found])
    assert np.mean([m.place_sigma for m in found]) == pytest.approx(1e-3, rel=0.05)
    assert np.mean([m.velocity_sigma for m in found]) == pytest.approx(velocities.std(), rel=0.05)


def test_a_window_begins_again_after_a_gap():
    window = MotionWindow()
    assert not [m for k in range(5) for m in window.add_pose(k * TEN, NOWHERE)]
    told = [m for k in range(12) for m in window.add_pose(GAP_NS + 5 * TEN + k * TEN, NOWHERE)]
    assert window.gaps == 1
    # The first has none before it, the last five not enough after them.
    assert [(m.stamp_ns - GAP_NS) // TEN - 5 for m in told] == [1, 2, 3, 4, 5, 6]


def at(x):
    return TrackerPose((x, 0.0, 1.0), NOWHERE.turn)


@pytest.mark.parametrize(
    ('stamp', 'pose', 'fault'),
    [
        (2 * S, TrackerPose((math.nan, 0, 0), NOWHERE.turn), PoseFault.NOT_A_NUMBER),
        (2 * S, TrackerPose((0, 0, 0), (0, 0, 0, 0)), PoseFault.NO_ATTITUDE),
        (0, at(0), PoseFault.NO_STAMP),
        (S, at(0), PoseFault.OLD),
        (S - TEN, at(0), PoseFault.OLD),
        (S + TEN, at(1.0), PoseFault.LEAP),
        (S + TEN, TrackerPose(at(0).place, (1.0, 0.0, 0.0, 0.0)), PoseFault.LEAP),
    ],
)
def test_what_cannot_be_is_refused_and_counted(stamp, pose, fault):
    sieve = PoseFilter()
    assert sieve.accept_pose(S, at(0))
    assert not sieve.accept_pose(stamp, pose)
    assert (sieve.newest, sieve.faults) == (fault, {fault: 1})
    assert sieve.accept_pose(S + 2 * TEN, at(0.001))


def test_a_leap_that_is_kept_was_one_to_the_right_place():
    sieve = PoseFilter()
    assert sieve.accept_pose(S, at(0))
    passed = [sieve.accept_pose(S + k * TEN, at(3 + 1e-3 * k)) for k in range(1, 40)]
    first = passed.index(True)
    assert first == FOUND_NS // TEN
    assert all(passed[first:])
    assert sieve.found == 1


def test_a_pose_that_never_changes_is_frozen():
    sieve = PoseFilter()
    passed = [sieve.accept_pose(S + k * TEN, at(0)) for k in range(100)]
    assert passed == [k * TEN <= FROZEN_NS for k in range(100)]
    assert sieve.accept_pose(S + 100 * TEN, at(0.001))


@given(st.lists(st.tuples(st.integers(-5, 10**9), poses), max_size=40))
def test_what_passes_goes_on_in_time_and_is_where_a_drone_can_be(stream):
    sieve = PoseFilter()
    believed, clocks = [], 0
    for stamp, pose in stream:
        backs, founds = sieve.set_back, sieve.found
        if sieve.accept_pose(stamp, pose):
            if believed and sieve.set_back == backs:
                assert stamp > believed[-1][0]
                if sieve.found == founds:
                    step = 1e-9 * (stamp - believed[-1][0])
                    assert math.dist(pose.place, believed[-1][1].place) <= 5.0 * step + 0.05
            believed.append((stamp, pose))
        clocks = sieve.set_back
    assert sum(sieve.faults.values()) + len(believed) == len(stream)
    assert clocks <= len(believed)


def stream(tracked, seconds, ahead_ns, late=lambda k: 2 * MS, drift=0.0):
    """Track a drone that flies at 0.3 m/s along x; yield true times and what was told."""
    for k in range(int(100 * seconds)):
        true = 10**18 + k * TEN
        said = true + ahead_ns + round(drift * k * TEN)
        arrival = true + late(k)
        for motion in tracked.receive_pose(said, at(0.3e-9 * k * TEN), arrival):
            yield motion, motion.pose.place[0] / 0.3


def test_stamps_are_ours_whatever_the_tracker_s_clock_says():
    rng = np.random.default_rng(2)
    tracked = TrackedDrone(NOWHERE, NOWHERE, 4 * MS)
    late = (4 * MS + rng.exponential(3 * MS, 10_000)).astype(int).tolist()
    told = list(stream(tracked, 40, -3600 * S, late.__getitem__, 40e-6))
    errors = [m.stamp_ns - 10**18 - x * 1e9 for m, x in told[2000:]]
    assert np.max(np.abs(errors)) < 0.3 * MS
    assert tracked.clock.drift == pytest.approx(40e-6, abs=5e-6)
    fact = tracked.describe_health(10**18 + 40 * S)
    assert fact.level is HealthLevel.OK
    assert float(fact.values['clock_offset_s']) == pytest.approx(-3600.0 + 40 * 40e-6, abs=1e-3)
    assert told[-1][0].velocity == pytest.approx((0.3, 0, 0), rel=1e-4)
    later = tracked.describe_health(10**18 + 40 * S + SILENT_TRACKER_NS + S)
    assert later.level is HealthLevel.ERROR


def test_a_clock_that_is_set_back_is_learnt_anew():
    tracked = TrackedDrone(NOWHERE, NOWHERE, 2 * MS)
    list(stream(tracked, 5, 50 * S))
    for k in range(100):
        true = 10**18 + 5 * S + k * TEN
        for motion in tracked.receive_pose(
            true + 48 * S, at(1.5 + 0.3e-9 * k * TEN), true + 2 * MS
        ):
            x = motion.pose.place[0] / 0.3
            assert motion.stamp_ns == pytest.approx(10**18 + x * 1e9, abs=MS)
    assert (tracked.sieve.set_back, tracked.clock.restarts) == (1, 1)


def test_our_own_clock_set_back_by_an_hour_keeps_nothing_from_being_told():
    tracked = TrackedDrone(NOWHERE, NOWHERE, 2 * MS)
    list(stream(tracked, 5, 50 * S))
    told = []
    for k in range(100):
        true = 10**18 + 5 * S + k * TEN
        arrival = true + 2 * MS - 3600 * S
        told += tracked.receive_pose(true + 50 * S, at(1.5 + 0.3e-9 * k * TEN), arrival)
    assert tracked.clock.restarts == 1
    assert len(told) > 90
    x = told[-1].pose.place[0] / 0.3
    assert told[-1].stamp_ns == pytest.approx(10**18 + x * 1e9 - 3600 * S, abs=MS)


def test_frames_are_placed_where_the_settings_say():
    """A tracker turned left by 90 degrees, 1 m east; the hull 0.3 m above the markers."""
    tracked = TrackedDrone(
        build_level_pose(1, 0, 0, math.pi / 2), build_level_pose(0, 0, 0.3, 0), 0
    )
    told = [
        motion
        for k in range(30)
        for motion in tracked.receive_pose(S + k * TEN, at(0.004 * k), S + k * TEN)
    ]
    motion = told[0]
    x = 0.004 * ((motion.stamp_ns - S) / TEN)
    assert motion.pose.place == pytest.approx((1.0, x, 1.3))
    assert motion.velocity == pytest.approx((0.4, 0, 0), abs=1e-9)


def test_odom_is_where_the_estimate_of_the_same_time_meets_the_truth():
    """
    By hand: the drone has flown 2 m along its odom's x, and stands 2 m north of the origin.

    So odom's x points north, from the origin: a turn of 90 degrees.
    """
    correction = MapCorrection()
    assert correction.locate_odom(S, NOWHERE) is None  # no estimate yet
    for k in range(300):
        moved = TrackerPose((0.01 * k, 0.0, 0.0), NOWHERE.turn)
        correction.add_estimate(S + k * TEN, moved)
    truth = build_level_pose(0.0, 2.0, 0.0, math.pi / 2)
    odom = correction.locate_odom(S + 200 * TEN + MS, truth)  # 1 ms off
    assert odom.place == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    ahead = Rotation.from_quat(odom.turn).apply((1.0, 0.0, 0.0))
    assert ahead == pytest.approx((0.0, 1.0, 0.0), abs=1e-9)
    assert correction.locate_odom(S, truth) is None  # long ago, and forgotten
    assert correction.locate_odom(S + 299 * TEN + S, truth) is None  # the estimates have ceased


def test_an_estimate_of_nonsense_or_of_a_clock_that_was_set_back_leaves_the_rest():
    correction = MapCorrection()
    correction.add_estimate(5 * S, NOWHERE)
    correction.add_estimate(5 * S + TEN, TrackerPose((math.nan, 0.0, 0.0), NOWHERE.turn))
    assert correction.locate_odom(5 * S, NOWHERE) == NOWHERE
    correction.add_estimate(S, NOWHERE)
    assert correction.locate_odom(5 * S, NOWHERE) is None
    assert correction.locate_odom(S, NOWHERE) == NOWHERE


def test_a_computed_motion_may_stand_still():
    sieve, pose = PoseFilter(noisy=False), build_level_pose(1.0, 2.0, 0.5, 0.3)
    assert all(sieve.accept_pose(S + k * FROZEN_NS // 2, pose) for k in range(6))


def test_a_body_is_found_by_its_name_among_those_of_motion_capture():
    there = Pose(position=Point(x=1.0, y=2.0, z=0.5), orientation=Quaternion(z=0.6, w=0.8))
    message = NamedPoses([NamedPose('lta2', Pose()), NamedPose('lta1', there)])
    assert to_stamped_pose(message, 'lta1') == TrackerPose((1.0, 2.0, 0.5), (0.0, 0.0, 0.6, 0.8))
    assert to_stamped_pose(message, 'lta3') is None


def test_the_messages_of_motion_capture_need_their_package(monkeypatch):
    package = 'motion_capture_tracking_interfaces'
    monkeypatch.setitem(sys.modules, f'{package}.msg', None)
    with pytest.raises(BadInput, match=f'needs the messages of {package}'):
        find_pose_type('named_poses')
    there = ModuleType(f'{package}.msg')
    there.NamedPoseArray = NamedPoses
    monkeypatch.setitem(sys.modules, package, ModuleType(package))
    monkeypatch.setitem(sys.modules, f'{package}.msg', there)
    assert find_pose_type('named_poses') is NamedPoses
    assert find_pose_type('pose') is PoseStamped
