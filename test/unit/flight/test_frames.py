# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The frames in the bag of a simulated flight: one tree, whose root is the map."""

from xml.etree import ElementTree

from frame_tree import FrameTree, nanoseconds, resolve_all
from lta_bag.reader import read_bag
from lta_config.parameter_override import parse_assignment
from lta_config.topics import load_topic_table
from lta_flight.flight_spec import load_spec
from lta_flight.progress import FlightProgress
from lta_flight.simulate import simulate_once
import numpy as np
import pytest
from rich.console import Console
from scipy.spatial.transform import Rotation

TABLE = load_topic_table()
LINKS = {'imu_link', 'range_link', 'panel_link'}
# Not on the axes of the map, so that a transform that is turned the wrong way is seen
START = (
    'scenario.start.position.0=-2.5 m', 'scenario.start.position.1=1 m',
    'scenario.start.heading=30 deg', 'scenario.start.heading_spread=0 deg',
    'scenario.goal.time_limit=4.05 s',
)  # fmt: skip


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return the bag of a flight that climbs and turns."""
    out = tmp_path_factory.mktemp('frames') / 'out'
    spec = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    spec = spec.with_values(dict(map(parse_assignment, START)))
    flight, _ = simulate_once(spec, 3, out, FlightProgress(Console(quiet=True)))
    return read_bag(flight.bag)


def messages(bag, topic):
    return [bag.decode(topic, data) for _, _, data in bag.iterate_messages([topic])]


def pose(message):
    p, q = message.pose.pose.position, message.pose.pose.orientation
    return Rotation.from_quat([q.x, q.y, q.z, q.w]), np.array([p.x, p.y, p.z])


def test_every_frame_of_every_message_resolves_to_the_map_at_its_stamp(bag):
    assert resolve_all(bag) == {'map', 'odom', 'base_link', *LINKS}


def test_the_links_of_the_urdf_are_frames(bag):
    (text,) = messages(bag, '/lta1/robot_description')
    links = {link.get('name') for link in ElementTree.fromstring(text.data).findall('link')}
    assert links == {'base_link', *set(FrameTree(bag).parents) - {'odom', 'base_link'}}
    assert links > LINKS


def test_odom_to_base_link_is_each_odom_with_its_stamp(bag):
    """To the last bit."""
    odoms, moved = messages(bag, '/lta1/odom'), messages(bag, '/tf')
    assert len(odoms) == len(moved) > 400
    for odom, message in zip(odoms, moved, strict=True):
        (one,) = message.transforms
        assert nanoseconds(one.header.stamp) == nanoseconds(odom.header.stamp)
        assert (one.header.frame_id, one.child_frame_id) == ('odom', 'base_link')
        p, q = odom.pose.pose.position, odom.pose.pose.orientation
        t, r = one.transform.translation, one.transform.rotation
        assert (t.x, t.y, t.z, r.x, r.y, r.z, r.w) == (p.x, p.y, p.z, q.x, q.y, q.z, q.w)
    logged = [when for _, when, _ in bag.iterate_messages(['/tf'])]
    assert logged == [when for _, when, _ in bag.iterate_messages(['/lta1/odom'])]


def test_map_to_odom_is_where_the_scenario_starts_the_drone(bag):
    """By hand: x = -2.5 - sin(30 deg) y', y = 1 + sin(30 deg) x', and so on, z as it is."""
    turn, place = FrameTree(bag).step_up('odom', 0)
    assert place == pytest.approx([-2.5, 1.0, 0.0])
    assert turn.apply([2.0, 0.0, 1.0]) == pytest.approx([np.sqrt(3.0), 1.0, 1.0])


def test_the_drone_is_where_the_truth_says_at_the_start_and_drifts_little(bag):
    """The pose by tf is the estimate: exact at the start, and off by its drift after 4 s."""
    tree, truths = FrameTree(bag), messages(bag, '/lta1/ground_truth/odom')
    apart = []
    for truth in truths:
        turned, placed = pose(truth)
        turn, place = tree.locate('base_link', nanoseconds(truth.header.stamp))
        apart.append((np.abs(place - placed).max(), (turned.inv() * turn).magnitude()))
    assert max(apart[0]) < 1e-3
    # m, rad; a turn of 30 degrees would be seen
    assert (np.max(apart, axis=0) < [0.1, 0.02]).all()


def test_the_range_finder_looks_at_the_floor_from_where_tf_puts_it(bag):
    """Range along x of range_link ends at the floor, z = 0 of the map."""
    tree = FrameTree(bag)
    heights = []
    for message in messages(bag, '/lta1/range'):
        if message.min_range < message.range < message.max_range:
            turn, place = tree.locate('range_link', nanoseconds(message.header.stamp))
            heights.append((place + turn.apply([message.range, 0.0, 0.0]))[2])
    assert len(heights) > 20
    assert np.mean(heights) == pytest.approx(0.0, abs=0.02)


def test_what_is_sent_once_is_recorded_once_at_the_begin(bag):
    for topic in ('/lta1/robot_description', '/lta1/scene', '/tf_static'):
        times = [when for _, when, _ in bag.iterate_messages([topic])]
        # On /tf_static: the fixed frames, and where the drone starts
        assert times == [TABLE.start_ns] * (2 if topic == '/tf_static' else 1), topic
