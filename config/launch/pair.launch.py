"""
Two drones in one scene, one bag and one /clock.

ros2 launch lta_config pair.launch.py seed2:=7  where ROS 2 Jazzy is installed
lta launch pair seed2:=7  where it is not
"""

from lta_graph.launches import PAIR

LAUNCH = PAIR


def generate_launch_description() -> object:
    """Return the description for `ros2 launch`, whose package only an installed ROS 2 has."""
    from lta_graph.ros.launch_description import describe_launch

    return describe_launch(LAUNCH)
