# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly by commands in plain rclpy: take off, go to the lamp, land.

    ./lta launch fly commanded:=true strategy:=homing
    ./lta run examples/own_commander.py --ros-args -r __ns:=/lta1

Each action ends with an outcome and the reason in words; of a refused one, the navigator logs the
reason. Ctrl-C here cancels nothing: the drone finishes its task, then holds until the next command
or until the energy reserve lands it.

Exit status 0: it stayed at the lamp and landed. 1: it did not, or its navigator is gone, for
example because the drone left the room. 3: a time limit passed.
"""

import sys
from typing import Any

from lta_msgs.action import GoToLamp, Land, TakeOff
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future

STATUSES = {GoToLamp.Result.SUCCEEDED: 0, GoToLamp.Result.TIMEOUT: 3}  # alike in all three


class Commander(Node):
    """Send goals one after the other."""

    def __init__(self) -> None:
        super().__init__('commander')
        kinds = {'take_off': TakeOff, 'go_to_lamp': GoToLamp, 'land': Land}
        self.actions = {name: ActionClient(self, kinds[name], name) for name in kinds}

    def fly(self, name: str, goal: Any) -> int | None:
        """Send a goal, wait for its end, and return the outcome; None if it is refused."""
        action = self.actions[name]
        action.wait_for_server()
        sent = action.send_goal_async(goal, feedback_callback=self.show_feedback)
        handle = self.wait(action, sent)
        if not handle.accepted:
            return None
        result = self.wait(action, handle.get_result_async()).result
        self.get_logger().info(f'{name}: outcome {result.outcome}, {result.message}')
        return int(result.outcome)

    def wait(self, action: ActionClient, future: Future) -> Any:
        """Serve this node until a future is done; end it if the server of the action is gone."""
        while not future.done():
            if not action.server_is_ready():
                sys.exit('The navigator is gone: the flight has ended.')
            rclpy.spin_until_future_complete(self, future, timeout_sec=1.0)
        return future.result()

    def show_feedback(self, message: Any) -> None:
        """Print where the lamp or the ground is, about once a second."""
        self.get_logger().info(str(message.feedback), throttle_duration_sec=1.0)


def main() -> None:
    """Fly to the lamp and land there."""
    rclpy.init()
    commander = Commander()
    # Refused until the simulator flies and the estimator has calibrated its biases
    while (outcome := commander.fly('take_off', TakeOff.Goal(height=0.6))) is None:
        rclpy.spin_once(commander, timeout_sec=1.0)
    outcomes = [outcome]
    if outcome == TakeOff.Result.SUCCEEDED:
        # Where it fails, the drone holds
        outcomes.append(commander.fly('go_to_lamp', GoToLamp.Goal()))
        outcomes.append(commander.fly('land', Land.Goal()))
    rclpy.shutdown()
    sys.exit(max(STATUSES.get(each, 1) for each in outcomes))


if __name__ == '__main__':
    main()
