# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One flight of a drone.

ros2 launch lta_bringup fly.launch.py seed:=2  where ROS 2 Jazzy is installed
lta launch fly seed:=2  where it is not
"""

from lta_graph.launches import FLY as LAUNCH


def generate_launch_description() -> object:
    """Return the description for `ros2 launch`, whose package only an installed ROS 2 has."""
    from lta_graph.ros.launch_description import describe_launch

    return describe_launch(LAUNCH)
