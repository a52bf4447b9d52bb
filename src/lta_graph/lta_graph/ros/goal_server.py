# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Serve an action whose goals a node advances in its own steps.

rclpy's action server runs a coroutine per goal. Here it only waits until the node says that the
goal has a result, so that everything else happens in the steps, in the node's one thread.
"""

from collections.abc import Callable
from typing import Any, final, Generic, TypeVar

from lta_graph.ros.contained_node import ContainedNode
from rclpy.action.server import ActionServer, CancelResponse, GoalResponse, ServerGoalHandle
from rclpy.task import Future

Task = TypeVar('Task')


@final
class GoalServer(Generic[Task]):
    """
    Serve one action.

    A goal that cannot begin is refused. ROS tells its client no reason: the node logs it.

    Parameters
    ----------
    node : ContainedNode
        The node; it calls `update` after each step.
    find_obstacle : callable
        Return why a goal is refused, or ''.
    begin : callable
        Return the task of a goal that is not refused.
    cancel : callable
        End a task early; returns whether it was still flown.
    get_result : callable
        Return whether a task succeeded and the fields of its result; None while it is flown.
    get_feedback : callable
        Return the fields of the feedback.

    """

    def __init__(
        self,
        node: ContainedNode,
        action: Any,
        name: str,
        find_obstacle: Callable[[Any], str],
        begin: Callable[[Any], Task],
        cancel: Callable[[Task], bool],
        get_result: Callable[[Task], tuple[bool, dict[str, Any]] | None],
        get_feedback: Callable[[], dict[str, Any]],
    ) -> None:
        self._action, self._name, self._logger = action, name, node.get_logger()
        self._find_obstacle, self._begin, self._cancel = find_obstacle, begin, cancel
        self._get_result, self._get_feedback = get_result, get_feedback
        self._running: dict[bytes, tuple[ServerGoalHandle, Task, Future]] = {}
        self._server = ActionServer(
            node,
            action,
            name,
            self._execute,
            goal_callback=node.contain(self._on_goal),
            handle_accepted_callback=node.contain(self._on_accepted),
            cancel_callback=node.contain(self._on_cancel),
        )

    def update(self) -> None:
        """Publish feedback, and let finished goals end."""
        for goal, task, ended in list(self._running.values()):
            if self._get_result(task) is not None:
                ended.set_result(None)
            else:
                goal.publish_feedback(self._action.Feedback(**self._get_feedback()))

    def _on_goal(self, goal: Any) -> GoalResponse:
        """Refuse a goal, or accept it: it begins once it has a handle, before any other event."""
        if why := self._find_obstacle(goal):
            self._logger.warning(f'{self._name} is refused: {why}')
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _on_accepted(self, goal: ServerGoalHandle) -> None:
        key = bytes(goal.goal_id.uuid)
        self._running[key] = goal, self._begin(goal.request), Future()
        goal.execute()

    def _on_cancel(self, goal: ServerGoalHandle) -> CancelResponse:
        running = self._running.get(bytes(goal.goal_id.uuid))
        ended = running is not None and self._cancel(running[1])
        return CancelResponse.ACCEPT if ended else CancelResponse.REJECT

    async def _execute(self, goal: ServerGoalHandle) -> Any:
        key = bytes(goal.goal_id.uuid)
        _, task, ended = self._running[key]
        if self._get_result(task) is None:
            await ended
        result = self._get_result(task)
        assert result is not None
        del self._running[key]
        succeeded, fields = result
        if goal.is_cancel_requested:
            goal.canceled()
        elif succeeded:
            goal.succeed()
        else:
            goal.abort()
        return self._action.Result(**fields)
