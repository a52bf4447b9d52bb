# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which settings open the graph to the network, and that the nodes say so, once."""

from lta_graph.health import HealthLevel
from lta_graph.reach import describe_reach
import pytest

RANGE, PEERS = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_STATIC_PEERS'
OWN = {'FASTRTPS_DEFAULT_PROFILES_FILE': '/lta/config/fastdds/this_machine.xml'}


@pytest.mark.parametrize(
    ('environment', 'cause'),
    [
        ({}, f'{RANGE}=SUBNET'),  # the default of ROS 2
        ({RANGE: ''}, f'{RANGE}=SUBNET'),
        ({RANGE: 'SUBNET'}, f'{RANGE}=SUBNET'),
        ({RANGE: 'SYSTEM_DEFAULT'}, f'{RANGE}=SYSTEM_DEFAULT'),
        ({RANGE: 'LOCALHOST', PEERS: '192.0.2.7'}, f'{PEERS}=192.0.2.7'),
        ({RANGE: 'LOCALHOST'}, ''),
        ({RANGE: 'OFF'}, ''),
        ({RANGE: 'SYSTEM_DEFAULT', **OWN}, ''),
        ({RANGE: 'SUBNET', PEERS: '192.0.2.7', 'ROS_LOCALHOST_ONLY': '1'}, ''),
    ],
)
def test_an_open_graph_is_a_warning_with_its_cause(environment, cause):
    fact = describe_reach(environment)
    assert (fact.level == HealthLevel.WARN) == bool(cause)
    assert ('anyone on the network can command the drone' in fact.message) == bool(cause)
    assert f'({cause})' in fact.message or not cause
