# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Serve the actions of a commanded flight: convert their goals, feedback and results."""

from functools import partial
from typing import Any, Final

from lta_config.errors import BadInput
from lta_control.actions.tasks import FlightTask, TaskKind, TaskOutcome
from lta_control.commanded_flight import CommandedFlight
from lta_control.place_hold import Place, Route
from lta_graph.ros.contained_node import ContainedNode
from lta_graph.ros.goal_server import GoalServer
from lta_msgs.action import FollowPath, GoToLamp, GoToPose, Land, TakeOff

ACTION_TYPES: Final = {
    TaskKind.TAKE_OFF: TakeOff,
    TaskKind.GO_TO_LAMP: GoToLamp,
    TaskKind.GO_TO_POSE: GoToPose,
    TaskKind.FOLLOW_PATH: FollowPath,
    TaskKind.LAND: Land,
}
PLACE_FRAMES: Final = ('map', '')  # frames of a place to fly to


def serve_tasks(node: ContainedNode, flight: CommandedFlight) -> list[GoalServer[FlightTask]]:
    """Offer the actions of a flight; see `GoalServer`."""
    return [
        GoalServer(
            node,
            action,
            kind.value,
            partial(find_goal_obstacle, flight),
            lambda goal: flight.request(*to_task(goal)),
            flight.cancel,
            partial(from_task_result, flight),
            partial(from_task_progress, kind, flight),
        )
        for kind, action in ACTION_TYPES.items()
    ]


def find_goal_obstacle(flight: CommandedFlight, goal: Any) -> str:
    """Return why a goal is refused, or ''."""
    try:
        return flight.find_obstacle(*to_task(goal))
    except BadInput as error:
        return f'{error}'


def to_task(goal: Any) -> tuple[TaskKind, float, Route]:
    """
    Return the task of a goal: a height [m], the frequency of a lamp [Hz] or 0, and places.

    Raise `BadInput` for places in another frame than the map.
    """
    if isinstance(goal, GoToPose.Goal):
        return TaskKind.GO_TO_POSE, 0.0, _to_route(goal.pose.header, [goal.pose.pose], goal)
    if isinstance(goal, FollowPath.Goal):
        return TaskKind.FOLLOW_PATH, 0.0, _to_route(goal.path.header, goal.path.poses, goal)
    if isinstance(goal, TakeOff.Goal):
        return TaskKind.TAKE_OFF, float(goal.height), Route()
    if isinstance(goal, GoToLamp.Goal):
        return TaskKind.GO_TO_LAMP, float(goal.frequency), Route()
    return TaskKind.LAND, 0.0, Route()


def _to_route(header: Any, poses: Any, goal: Any) -> Route:
    if header.frame_id not in PLACE_FRAMES:
        raise BadInput(f"The frame of a place is map, not '{header.frame_id}'.")
    places = [pose.position for pose in poses]
    return Route(tuple(Place(each.x, each.y, each.z) for each in places), goal.tolerance)


def from_task_progress(kind: TaskKind, flight: CommandedFlight) -> dict[str, float | bool]:
    """Return the fields of an action's feedback."""
    now = flight.progress
    if kind is TaskKind.GO_TO_LAMP:
        return {'seen': now.seen, 'distance': now.distance, 'bearing': now.bearing}
    if kind is TaskKind.GO_TO_POSE:
        return {'distance': now.distance}
    if kind is TaskKind.FOLLOW_PATH:
        return {'distance': now.distance, 'place': now.place}
    if kind is TaskKind.TAKE_OFF:
        return {'height': now.height, 'climb_rate': now.climb}
    return {'height': now.height, 'sink_rate': -now.climb}


def from_task_result(
    flight: CommandedFlight, task: FlightTask
) -> tuple[bool, dict[str, int | str | float]] | None:
    """Return whether a task succeeded and the fields of its result; None while it is flown."""
    if task.result is None:
        return None
    fields: dict[str, int | str | float] = {
        'outcome': int(task.result.outcome), 'message': task.result.message
    }  # fmt: skip
    if task.kind is TaskKind.TAKE_OFF:
        fields['height'] = flight.progress.height
    elif task.kind is not TaskKind.LAND:
        fields['distance'] = flight.progress.distance
    if task.kind is TaskKind.FOLLOW_PATH:
        fields['place'] = task.place
    return task.result.outcome is TaskOutcome.SUCCEEDED, fields
