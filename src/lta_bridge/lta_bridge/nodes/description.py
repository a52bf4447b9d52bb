# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The description node: it publishes the drone's shape and frames for RViz and other tools.

The vehicle's URDF is latched on `robot_description`, the frames of sensors and rotors on
/tf_static, and the room and lamps of a scenario as markers on `scene`. The estimator publishes
odom -> base_link on /tf; with the parameter `pose` this node does it for a graph without our
estimator. The simulator or a tracker publishes map -> odom; without both, `map` does.
"""

from typing import Unpack

from lta_bridge.description.messages import iterate_descriptions
from lta_bridge.parameters import DescriptionSettings
from lta_graph.health import HealthLevel
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.qos import select_profile
from lta_graph.ros.transforms import from_odometry, from_start, prefix_frames
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry

AT_ORIGIN = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)  # place [m] and attitude of a start, x y z w


class DescriptionNode(GraphNode):
    """Publish URDF, scene and transforms."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('description', **options)
        outputs = {
            name: self.create_output(name) for name in self.table.published_by('description')
        }
        settings = NodeParameters(self, DescriptionSettings).value
        scenario = load_scenario(settings.scene) if settings.scene else None
        vehicle = load_vehicle(settings.vehicle)
        for name, message in iterate_descriptions(vehicle, scenario):
            if name == '/tf_static' and settings.map:
                message.transforms += from_start(AT_ORIGIN).transforms
            outputs[name].publish(message)
        if settings.pose:
            row = self.table['/tf']
            quality = select_profile(row, self.lockstep)
            self._tf = self.create_publisher(find_message_type(row), '/tf', quality)
            self.subscribe_topic(settings.pose, self._on_pose)
        self.health.report(
            'frames',
            HealthLevel.OK,
            f'the pose of base_link is published on /tf, from the topic {settings.pose}'
            if settings.pose
            else 'the fixed frames are published on /tf_static',
        )

    def _on_pose(self, odom: Odometry) -> None:
        moved = from_odometry(odom)
        prefix_frames(self.frame_prefix, moved)
        self._tf.publish(moved)


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(DescriptionNode, args)
