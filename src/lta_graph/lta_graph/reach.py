# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find out from the environment whether other computers reach the ROS graph."""

from collections.abc import Mapping
from typing import Final

from lta_graph.health import HealthFact, HealthLevel

OWN_PROFILE: Final = 'this_machine.xml'  # of config/fastdds: sockets on 127.0.0.1 alone
# As rmw reads them (docs.ros.org, "Improved Dynamic Discovery"): the first comes before the others
LOCALHOST_ONLY: Final = 'ROS_LOCALHOST_ONLY'
PEERS_VARIABLE: Final = 'ROS_STATIC_PEERS'
RANGE_VARIABLE: Final = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
PROFILE_VARIABLE: Final = 'FASTRTPS_DEFAULT_PROFILES_FILE'
NETWORK_TASK: Final = 'network'


def describe_reach(environment: Mapping[str, str]) -> HealthFact:
    """Return who can command the drone, as health; `environment`: the variables of a node."""
    cause = _find_opening(environment)
    if not cause:
        return HealthFact(
            NETWORK_TASK, HealthLevel.OK, 'only programs on this computer reach the graph'
        )
    words = f'anyone on the network can command the drone ({cause}); see docs/security.md'
    return HealthFact(NETWORK_TASK, HealthLevel.WARN, words)


def _find_opening(environment: Mapping[str, str]) -> str:
    """Return the setting that opens the graph; empty if none does."""
    if environment.get(LOCALHOST_ONLY) == '1':
        return ''
    if peers := environment.get(PEERS_VARIABLE):
        return f'{PEERS_VARIABLE}={peers}'
    scope = environment.get(RANGE_VARIABLE) or 'SUBNET'  # the default of ROS 2
    own = environment.get(PROFILE_VARIABLE, '').endswith(OWN_PROFILE)
    if scope == 'SUBNET' or (scope == 'SYSTEM_DEFAULT' and not own):
        return f'{RANGE_VARIABLE}={scope}'
    return ''
