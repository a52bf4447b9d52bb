# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What spoils messages, flies without end, and sees a leak or a lost message."""

import math

from builtin_interfaces.msg import Time
from campaigns.chaos_spoilt import AGE_NS, spoil, SPOILT
from campaigns.graph_trial import write_endless_flight
from campaigns.soak import fit_slope, LEAK
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_control.messages import from_duties
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import from_stamp
from lta_model.scenario import load_scenario
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message

TABLE = load_topic_table()
TOPICS = TABLE.topics


@pytest.mark.parametrize('kind', SPOILT)
def test_any_topic_can_be_spoilt_and_sent(kind):
    for name, row in TOPICS.items():
        message = find_message_type(row)()
        if hasattr(message, 'header'):
            message.header.stamp.sec = 1000
        spoilt = spoil(kind, message)
        back = deserialize_message(serialize_message(spoilt), type(message))
        assert type(back) is type(message), name
        if hasattr(message, 'header') and kind in ('stale', 'future'):
            by = from_stamp(back.header.stamp) - from_stamp(message.header.stamp)
            assert by == (AGE_NS if kind == 'future' else -AGE_NS)


def test_what_is_spoilt_is_what_it_says():
    odom = find_message_type(TOPICS['odom'])()
    assert math.isnan(spoil('nan', odom).pose.pose.position.z)
    assert np.isnan(spoil('nan', odom).pose.covariance).all()
    motors = from_duties(Time(), ['a', 'b'], (0.1, 0.2))
    assert len(spoil('lengths', motors).duty) == 3
    assert list(spoil('names', motors).name) != ['a', 'b']
    assert motors.name == ['a', 'b']  # a copy was spoilt


@pytest.mark.parametrize(('leak', 'flat'), [(0.0, True), (3.0 * LEAK, False)])
def test_a_leak_is_told_from_noise(leak, flat):
    """Two hours with a look each 5 s, and 1 MB of noise that hangs together over a minute."""
    times = np.arange(0.0, 7200.0, 5.0)
    noise = np.convolve(
        np.random.default_rng(1).normal(size=len(times)), np.ones(12) / 3.5, 'same'
    )
    found = fit_slope(times, 100.0 + noise + leak * times / 3600.0)
    assert found.flat == flat
    assert abs(found.slope - leak) < 2.0 * found.within


def test_the_soak_flies_for_longer_than_a_day(tmp_path):
    scene, vehicle, strategy = map(str, write_endless_flight(tmp_path).values())
    scenario = load_scenario(scene)
    assert scenario.goal.time_limit.si == 86400.0
    assert len(scenario.route) * 29.0 > 86400.0  # 7 m at less than 0.25 m/s
    assert scenario.room.walls == 'solid'  # nobody escapes
    assert load_vehicle_file(vehicle).energy.battery.capacity.si == 250.0 * 3600.0  # C
    assert strategy == 'homing'
