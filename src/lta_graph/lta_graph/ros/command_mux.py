# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Select the setpoints to follow: the navigator's, or a teleoperator's after a takeover.

The teleoperator keeps control until they return it, even if they stop sending. Their last
setpoint then ages, and the node that follows it holds position and lands. The navigator's
setpoints would let the vehicle fly on unnoticed.
"""

from collections.abc import Callable
from typing import Final, final

from geometry_msgs.msg import PoseStamped, TwistStamped
from lta_graph.health import HealthLevel
from lta_graph.ros.node import GraphNode
from std_msgs.msg import Bool

COMMAND_SOURCE_TASK: Final = 'helm'  # health task with the active source of setpoints
HELD_VALUE: Final = 'held'  # its value: whether that is the teleoperator


@final
class CommandMux:
    """
    Receive the teleoperator's setpoints and select the active ones.

    Parameters
    ----------
    node : GraphNode
        The node that follows setpoints. In lockstep there is no teleoperation.
    then : callable
        Called at each new velocity setpoint of the teleoperator.

    Attributes
    ----------
    held : bool
        Whether the teleoperator is in control.

    """

    def __init__(self, node: GraphNode, then: Callable[[], None] = lambda: None) -> None:
        self.held = False
        self._node = node
        self._pose: PoseStamped | None = None
        self._velocity: TwistStamped | None = None
        self._then = then
        # A person acts in real time, so a lockstep run could not be repeated
        if node.lockstep:
            return
        self._report_source()
        for name, callback in (
            ('teleop/held', self._on_takeover),
            ('teleop/velocity', self._on_velocity),
            ('teleop/pose', self._on_pose),
        ):
            node.subscribe_topic(name, callback)

    def select_setpoint(
        self, pose: PoseStamped | None, velocity: TwistStamped | None
    ) -> tuple[PoseStamped | None, TwistStamped | None]:
        """Return the active pose and velocity, of the teleoperator or as given."""
        return (self._pose, self._velocity) if self.held else (pose, velocity)

    def count_commanders(self) -> int:
        """Return how many nodes publish setpoints; two would fight each other."""
        # When the middleware finds a node varies, so a lockstep run could not be repeated
        if self._node.lockstep:
            return 1
        # Those of teleop do not count: one that has crashed may be started again in flight
        return max(map(self._node.count_publishers, ('setpoint/pose', 'setpoint/velocity')))

    def _on_takeover(self, held: Bool) -> None:
        if held.data != self.held:
            self.held = held.data
            self._report_source()
            self._node.publish_health()  # immediately: a starting teleop node reads it

    def _report_source(self) -> None:
        whose = 'operator' if self.held else 'navigator'
        self._node.health.report(
            COMMAND_SOURCE_TASK,
            HealthLevel.OK,
            f'the drone follows the setpoints of the {whose}',
            **{HELD_VALUE: self.held},
        )

    def _on_pose(self, pose: PoseStamped) -> None:
        self._pose = pose

    def _on_velocity(self, velocity: TwistStamped) -> None:
        self._velocity = velocity
        self._then()
