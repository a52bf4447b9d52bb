# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The tracker node: it publishes `tracker/odom` from an external tracker, and map -> odom.

Poses come as PoseStamped (vrpn, libsurvive's Lighthouse), Odometry or NamedPoseArray (the motion
capture of Crazyswarm2), or as a frame on /tf. With the estimate on `odom`, the node publishes on
/tf where `odom` is in `map`, so that base_link is at the tracked pose there (REP-105). Of a real
drone it also publishes `ground_truth/odom`, for evaluation and viewers.
"""

from typing import Any, Unpack

from lta_bridge.parameters import TrackerSettings
from lta_bridge.tracking.messages import (
    find_pose_type,
    from_odometry,
    from_transform,
    to_odometry,
    to_stamped_pose,
)
from lta_bridge.tracking.pose import build_level_pose, MapCorrection, TrackerPose
from lta_bridge.tracking.tracked_drone import TrackedDrone
from lta_config.errors import BadInput
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_graph.ros.transforms import build_transform
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from tf2_msgs.msg import TFMessage

# Many publishers share /tf, so a shallow queue would lose the tracker's messages
DEPTH = 100  # queue depth of /tf, as in tf2


class TrackerNode(GraphNode):
    """Publish the tracked pose and motion of the drone."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('tracker', role='vehicle', **options)
        if self.lockstep:
            raise BadInput('A real tracker works only in real time; remove time:=lockstep.')
        self._motion = self.create_output('tracker/odom')
        self._tf = self.create_output('/tf')
        settings = NodeParameters(self, TrackerSettings).value
        self._tracked = TrackedDrone(
            build_level_pose(*settings.origin),
            build_level_pose(*settings.body),
            round(1e9 * settings.delay),
            # A computed motion may stand still
            noisy=settings.type != 'odometry',
        )
        self._correction = MapCorrection()
        self.subscribe_topic('odom', self._on_estimate)
        self._truth = self.create_output('ground_truth/odom') if settings.truth else None
        self._frame, self._body_name = settings.frame, settings.body_name
        if not settings.frame:
            kind = find_pose_type(settings.type)
            self.create_subscription(kind, settings.pose, self._on_pose, qos_profile_sensor_data)
        else:
            self.create_subscription(TFMessage, '/tf', self._on_frames, DEPTH)

    def _on_pose(self, message: Any) -> None:
        pose = to_stamped_pose(message, self._body_name)
        if pose is not None:
            self._publish_motion(from_stamp(message.header.stamp), pose)

    def _on_frames(self, message: TFMessage) -> None:
        for each in message.transforms:
            if each.child_frame_id == self._frame:
                self._publish_motion(from_stamp(each.header.stamp), from_transform(each))

    def _publish_motion(self, stamp_ns: int, pose: TrackerPose) -> None:
        now_ns = self.graph_time_ns()
        # The clock of a simulation has not begun: its pose would be stamped at 0
        if not now_ns:
            return
        for motion in self._tracked.receive_pose(stamp_ns, pose, now_ns):
            frame = self.table['tracker/odom'].frame
            stamp = to_stamp(motion.stamp_ns)
            message = to_odometry(stamp, frame, motion)
            self._motion.publish(message)
            if self._truth is not None:
                self._truth.publish(message)
            odom = self._correction.locate_odom(motion.stamp_ns, motion.pose)
            if odom is not None:
                moved = build_transform(stamp, (frame, 'odom'), *odom)
                self._tf.publish(TFMessage(transforms=[moved]))

    def _on_estimate(self, odom: Odometry) -> None:
        self._correction.add_estimate(from_stamp(odom.header.stamp), from_odometry(odom))

    def update_health(self) -> None:
        """Report the health of the tracker."""
        fact = self._tracked.describe_health(self.graph_time_ns())
        self.health.report(fact.task, fact.level, fact.message, **fact.values)


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(TrackerNode, args)
