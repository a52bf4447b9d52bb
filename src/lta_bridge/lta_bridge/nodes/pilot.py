"""
The pilot node: it flies by motion capture what calibrates a vehicle, and ends.

It takes off, flies to a place, moves the sticks there (`teleop.stick_plan`), returns after each
piece, and lands. Actions of the navigator do all but the pieces. For these it does what a person
with a gamepad does: it publishes Joy messages, which the teleop node follows by its own rules. If
the pilot dies, the drone holds and lands, as without a gamepad; if the tracker is lost, the pilot
hands the drone back and lands it. It arms nothing.
"""

from collections.abc import Generator, Iterator
import math
import sys
import time
from typing import Any, Unpack

from geometry_msgs.msg import PoseStamped
from lta_bridge.parameters import PilotSettings
from lta_bridge.teleop.steering import check_time_mode
from lta_bridge.teleop.stick_plan import limit_climb, plan_pieces, StickHold
from lta_bridge.teleop.sticks import from_sticks, GamepadLayout, JOY, Sticks
from lta_control.messages import to_tracked
from lta_control.odometry.tracked_motion import TrackedMotion
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
# s without a tracked pose after which the flight ends; the navigator's own limit is 2 s
LONGEST_TRACKER_GAP = 1.0
COASTING_TIME = 8.0  # s for which a blimp flies on, as it has to turn about to brake
# Wall s in which a goal is accepted: nodes load a vehicle, and calibrate the estimator
GOAL_PATIENCE = 120.0
LANDING_PATIENCE = 10.0  # the same for a landing, which a drone that stands refuses
HANDOVER_PATIENCE = 10.0  # wall s in which teleop takes the sticks, or hands them back
GOAL_PAUSE = 1.0  # wall s between two requests for a goal that was refused
PILOT_ACTIONS = {'take_off': TakeOff, 'go_to_pose': GoToPose, 'land': Land}


# The steps of a flight; they return why it cannot go on, or ''
Steps = Generator[None, None, str]


class Pilot(GraphNode):
    """Fly once, and end."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('pilot', **options)
        check_time_mode(lockstep=self.lockstep)
        self._settings = NodeParameters(self, PilotSettings).value
        self._joy = self.create_publisher(Joy, JOY, 1)
        self._layout, self._joy_at = GamepadLayout(), 0.0
        self._sticks = Sticks()
        self._held = False
        self._tracked: TrackedMotion | None = None
        self._above = 0.0  # height above the place [m]
        self._tracked_at = -math.inf
        self.subscribe_topic('teleop/held', self._on_held)
        self.subscribe_topic('tracker/odom', self._on_tracked)
        self._actions = {
            name: ActionClient(self, kind, name) for name, kind in PILOT_ACTIONS.items()
        }

    def _on_held(self, held: Bool) -> None:
        self._held = held.data

    def _on_tracked(self, odom: Odometry) -> None:
        tracked = to_tracked(odom)
        if tracked is not None:
            self._tracked, self._tracked_at = tracked, time.monotonic()
            self._above = odom.pose.pose.position.z - self._settings.height

    def run(self) -> Iterator[None]:
        """Fly to the end; exit with status 1 if the flight did not reach it."""
        self.health.report('state', HealthLevel.OK, 'running')
        flight = self._fly()
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
            axes, buttons = from_sticks(self._layout, self._sticks)
            self._joy.publish(Joy(axes=axes, buttons=buttons))

    def _fly(self) -> Steps:
        """Fly all pieces and land, also where one of them fails."""
        settings = self._settings
        place = GoToPose.Goal(pose=PoseStamped())
        place.pose.header.frame_id = 'map'
        point = place.pose.pose.position
        point.x, point.y, point.z = settings.x, settings.y, settings.height
        failure = yield from self._command('take_off', TakeOff.Goal(height=settings.height))
        failure = failure or (yield from self._command('go_to_pose', place))
        for piece in plan_pieces(settings.seconds, settings.seed):
            if failure:
                break
            failure = yield from self._move_sticks(piece)
            failure = failure or (yield from self._command('go_to_pose', place))
        back = yield from self._hand_back()
        landing = yield from self._command('land', Land.Goal(), LANDING_PATIENCE)
        return failure or back or landing

    def _command(
        self,
        name: str,
        goal: Any,  # noqa: ANN401 - of an action
        patience: float = GOAL_PATIENCE,
    ) -> Steps:
        """Fly by an action to its end; `patience`: until it is accepted. [wall s]"""
        self._tell(f'{name} begins')
        action, since = self._actions[name], time.monotonic()
        while True:
            handle = None
            if action.server_is_ready():
                sent: Future = action.send_goal_async(goal)
                while not sent.done():
                    yield
                handle = sent.result()
            if handle is not None and handle.accepted:
                break
            # The navigator logs why it refuses
            if time.monotonic() - since > patience:
                return f'{name} was refused for {patience:.0f} s'
            yield from self._wait(GOAL_PAUSE)
        ended: Future = handle.get_result_async()
        while not ended.done():
            yield
        result: Any = ended.result()
        succeeded = result.result.outcome == TakeOff.Result.SUCCEEDED  # alike in all
        return '' if succeeded else f'{name}: {result.result.message}'

    def _move_sticks(self, piece: tuple[StickHold, ...]) -> Steps:
        """Fly a piece until its end, or until the drone leaves the room, and hand it back."""
        self._tell(f'sticks move for {sum(hold.seconds for hold in piece):.0f} s')
        since = time.monotonic()
        self._sticks = Sticks(take=True)
        while not self._held:
            if time.monotonic() - since > HANDOVER_PATIENCE:
                return 'teleop does not follow the sticks'
            yield
        for sticks, seconds in piece:
            until = time.monotonic() + seconds
            while time.monotonic() < until:
                if time.monotonic() - self._tracked_at > LONGEST_TRACKER_GAP:
                    return 'the tracker is lost'
                if self._is_outside():
                    return (yield from self._hand_back())
                self._sticks = limit_climb(sticks, self._above)
                yield
        return (yield from self._hand_back())

    def _is_outside(self) -> bool:
        """Return whether the drone could coast out of the room."""
        assert self._tracked is not None  # else the tracker is lost
        (x, y), (u, v) = self._tracked.position, self._tracked.velocity
        away = x + COASTING_TIME * u - self._settings.x, y + COASTING_TIME * v - self._settings.y
        return math.hypot(*away) > 0.5 * self._settings.room

    def _hand_back(self) -> Steps:
        """Hand the drone back to the navigator, if the sticks have it."""
        since = time.monotonic()
        self._sticks = Sticks(give_back=True)
        while self._held:
            if time.monotonic() - since > HANDOVER_PATIENCE:
                return 'teleop does not hand the drone back'
            yield
        self._sticks = Sticks()
        return ''

    def _wait(self, seconds: float) -> Iterator[None]:
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            yield

    def _tell(self, what: str) -> None:
        """Report what the drone does next."""
        self.health.report('tests', HealthLevel.OK, what)
        self.get_logger().info(what)


def main(args: list[str] | None = None) -> None:
    """Fly once, or until it is stopped."""
    run_node(Pilot, args)
