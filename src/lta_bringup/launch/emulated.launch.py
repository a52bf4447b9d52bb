# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The graph of a real drone on emulated hardware; `lta call crazyflie_bridge/arm true` flies.

ros2 launch lta_bringup emulated.launch.py vehicle:=multirotor  where ROS 2 Jazzy is installed
lta launch emulated vehicle:=multirotor  where it is not
"""

from lta_graph.launches import EMULATED as LAUNCH


def generate_launch_description() -> object:
    """Return the description for `ros2 launch`, whose package only an installed ROS 2 has."""
    from lta_graph.ros.launch_description import describe_launch

    return describe_launch(LAUNCH)
