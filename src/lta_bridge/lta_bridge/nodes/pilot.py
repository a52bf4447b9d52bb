# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The pilot node: it flies by motion capture what calibrates a vehicle, and ends.

It takes off, flies to a place, moves the sticks there (`teleop.stick_plan`), returns after each
piece, and lands. Actions of the navigator do all but the pieces. For these it does what a person
with a gamepad does: it publishes Joy messages, which the teleop node follows by its own rules. If
the pilot dies, the drone holds and lands, as without a gamepad; if the tracker is lost, the pilot
hands the drone back and lands it. It arms nothing.
"""

from collections.abc import Iterator
import sys
import time
from typing import Any, Unpack

from geometry_msgs.msg import PoseStamped
from lta_bridge.parameters import PilotSettings
from lta_bridge.teleop.steering import check_time_mode
from lta_bridge.teleop.stick_plan import Steps, StickFlight
from lta_bridge.teleop.sticks import from_sticks, GamepadLayout, JOY
from lta_control.messages import to_tracked
from lta_graph.health import HealthLevel
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_msgs.action import GoToPose, Land, TakeOff
from nav_msgs.msg import Odometry
from rclpy.action.client import ActionClient
from rclpy.task import Future
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool

JOY_PERIOD = 0.05  # s between two Joy messages
# Wall s in which a goal is accepted: nodes load a vehicle, and calibrate the estimator
GOAL_PATIENCE = 120.0
LANDING_PATIENCE = 10.0  # the same for a landing, which a drone that stands refuses
GOAL_PAUSE = 1.0  # wall s between two requests for a goal that was refused
PILOT_ACTIONS = {'take_off': TakeOff, 'go_to_pose': GoToPose, 'land': Land}


class Pilot(GraphNode):
    """Fly once, and end."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('pilot', **options)
        check_time_mode(lockstep=self.lockstep)
        settings = NodeParameters(self, PilotSettings).value
        self._joy = self.create_publisher(Joy, JOY, 1)
        self._layout, self._joy_at = GamepadLayout(), 0.0
        self._flight = StickFlight(settings, self._command, self._tell)
        self.subscribe_topic('teleop/held', self._on_held)
        self.subscribe_topic('tracker/odom', self._on_tracked)
        self._actions = {
            name: ActionClient(self, kind, name) for name, kind in PILOT_ACTIONS.items()
        }
        place = PoseStamped()
        place.header.frame_id = 'map'
        point = place.pose.position
        point.x, point.y, point.z = settings.x, settings.y, settings.height
        self._goals = {
            'take_off': TakeOff.Goal(height=settings.height),
            'go_to_pose': GoToPose.Goal(pose=place),
            'land': Land.Goal(),
        }

    def _on_held(self, held: Bool) -> None:
        self._flight.held = held.data

    def _on_tracked(self, odom: Odometry) -> None:
        tracked = to_tracked(odom)
        if tracked is not None:
            self._flight.receive_tracking(tracked, odom.pose.pose.position.z)

    def run(self) -> Iterator[None]:
        """Fly to the end; exit with status 1 if the flight did not reach it."""
        self.health.report('state', HealthLevel.OK, 'running')
        flight = self._flight.fly()
        failure = ''
        while self.running:
            try:
                next(flight)
            except StopIteration as end:
                failure, self.running = end.value, False
            self._publish_sticks()
            yield
        if failure:
            sys.stderr.write(f'The flight ended early: {failure}.\n')
            sys.exit(1)

    def _publish_sticks(self) -> None:
        """Publish the sticks when a message is due; without any, teleop lands the drone."""
        now = time.monotonic()
        if now - self._joy_at >= JOY_PERIOD:
            self._joy_at = now
            axes, buttons = from_sticks(self._layout, self._flight.sticks)
            self._joy.publish(Joy(axes=axes, buttons=buttons))

    def _command(self, name: str) -> Steps:
        """Fly by an action to its end."""
        self._tell(f'{name} begins')
        patience = LANDING_PATIENCE if name == 'land' else GOAL_PATIENCE
        action, since = self._actions[name], time.monotonic()
        while True:
            handle = None
            if action.server_is_ready():
                sent: Future = action.send_goal_async(self._goals[name])
                while not sent.done():
                    yield
                handle = sent.result()
            if handle is not None and handle.accepted:
                break
            # The navigator logs why it refuses
            if time.monotonic() - since > patience:
                return f'{name} was refused for {patience:.0f} s'
            again = time.monotonic() + GOAL_PAUSE
            while time.monotonic() < again:
                yield
        ended: Future = handle.get_result_async()
        while not ended.done():
            yield
        result: Any = ended.result()
        succeeded = result.result.outcome == TakeOff.Result.SUCCEEDED  # alike in all
        return '' if succeeded else f'{name}: {result.result.message}'

    def _tell(self, what: str) -> None:
        """Report what the drone does next."""
        self.health.report('tests', HealthLevel.OK, what)
        self.get_logger().info(what)


def main(args: list[str] | None = None) -> None:
    """Fly once, or until it is stopped."""
    run_node(Pilot, args)
