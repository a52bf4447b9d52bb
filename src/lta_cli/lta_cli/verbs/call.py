"""lta call: ask a service of a running graph."""

from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_config.topics import robot_topic
from lta_graph.ros import service_call
import typer


def call(
    service: Annotated[str, typer.Argument(help='Relative to the robot, or absolute.')],
    data: Annotated[bool | None, typer.Argument(help='true or false, where it wants one.')] = None,
    robot: Annotated[str, typer.Option(help='Namespace of the robot.')] = 'lta1',
) -> None:
    """
    Ask a service of a running graph once, and say what it answers.

    recorder/snapshot writes what the recorder keeps in memory; player/pause true|false and
    player/step hold a replay and let it go on. What `ros2 service call` does where there is a
    ROS 2; the graph is that of ROS_DOMAIN_ID.

    Exit status 0: it was done. 1: the service says that it was not. 2: there is no such service,
    or it does not answer.

    Example: lta call recorder/snapshot

    Example: lta call player/pause true
    """
    answer = service_call.call_service(robot_topic(robot, service), data)
    words = answer.message or ('done' if answer.success else 'not done')
    plain_console().print(words, highlight=False, markup=False, soft_wrap=True)
    if not answer.success:
        raise typer.Exit(1)
