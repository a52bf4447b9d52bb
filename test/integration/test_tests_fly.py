# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta tests fly`: the flights that calibrate a vehicle, by a noisy tracker, and without it."""

from geometry_msgs.msg import PoseStamped
from lta_data.bag.recorded_flight import open_flight
import numpy as np
import pytest
from rclpy.qos import qos_profile_sensor_data

from .peer import Peer

NOISE = 0.002  # m


@pytest.fixture
def start_flight(lta, scenario, tmp_path):
    """Return a function that starts one flight in the middle of the room, for some seconds."""

    def start(seconds):
        return lta.start(
            'tests', 'fly', 'gtmab', '--flights', 1, '--seconds', seconds, '--height', 0.7,
            '--out', tmp_path / 'tests', f'scenario:={scenario(walls="solid")}', 'processes:=one',
            'offset_x:=3.5', 'tracker_pose:=tracker/pose',
        )  # fmt: skip

    return start


class Camera:
    """The tracker of the simulated drone: 25 poses a second with noise, while it `sees`."""

    def __init__(self, peer):
        self.sees = True
        self._draw = np.random.default_rng(1)
        self._poses = peer.node.create_publisher(
            PoseStamped, 'tracker/pose', qos_profile_sensor_data
        )
        peer.hear('ground_truth/odom', self._relay)

    def _relay(self, odom):
        if self.sees and odom.header.stamp.nanosec // 10_000_000 % 4 == 0:
            place = odom.pose.pose.position
            dx, dy, dz = self._draw.normal(0.0, NOISE, 3)
            place.x, place.y, place.z = place.x + dx, place.y + dy, place.z + dz
            self._poses.publish(PoseStamped(header=odom.header, pose=odom.pose.pose))


def test_a_flight_whose_tracker_is_lost_lands_and_fails(start_flight, domain_id, tmp_path):
    with Peer(domain_id) as peer:
        camera = Camera(peer)
        heights, held = [], []
        peer.hear('ground_truth/odom', lambda odom: heights.append(odom.pose.pose.position.z))
        peer.hear('teleop/held', lambda each: held.append(each.data))
        flight = start_flight(20)
        peer.until(lambda: (held and held[-1]) or flight.popen.poll() is not None)
        assert held, flight.text
        camera.sees = False
        peer.until(lambda: flight.popen.poll() is not None)
    assert flight.end() == 1
    assert 'The flight ended early: the tracker is lost.' in flight.text
    assert max(heights) > 0.6
    assert heights[-1] == pytest.approx(heights[0], abs=0.03)
    assert not held[-1]
    assert 'Next:' not in flight.text
    assert (tmp_path / 'tests/flight_1').is_dir()


@pytest.mark.long
def test_a_flight_excites_all_axes_and_ends_with_the_command_that_calibrates(
    start_flight, domain_id, tmp_path
):
    with Peer(domain_id) as peer:
        Camera(peer)
        flight = start_flight(27)  # the first three pieces
        peer.until(lambda: flight.popen.poll() is not None, 300.0)
    bag = tmp_path / 'tests/flight_1'
    assert flight.end() == 0, flight.text
    assert flight.text.rstrip().endswith(f'calibrate --vehicle gtmab --train {bag}')
    table = open_flight(bag)
    assert {'motors', 'tracker/odom', 'teleop/held'} <= set(table.topics)
