# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One to ten drones in one scene, one bag and one /clock.

ros2 launch lta_bringup fleet.launch.py n:=3  where ROS 2 Jazzy is installed
lta launch fleet n:=3  where it is not
"""

from lta_graph.launches import FLEET as LAUNCH


def generate_launch_description() -> object:
    """Return the description for `ros2 launch`, whose package only an installed ROS 2 has."""
    from lta_graph.ros.launch_description import describe_launch

    return describe_launch(LAUNCH)
