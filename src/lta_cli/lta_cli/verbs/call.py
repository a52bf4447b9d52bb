# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta call: call a service of a running graph."""

from typing import Annotated

from lta_analysis.console import plain_console
from lta_config.topics import robot_topic
from lta_graph.ros import listener
import typer


def call(
    service: Annotated[
        str, typer.Argument(help="Service name, relative to the robot's namespace or absolute.")
    ],
    data: Annotated[
        bool | None, typer.Argument(help='Value to send to a SetBool service, true or false.')
    ] = None,
    robot: Annotated[str, typer.Option(help='Namespace of the robot.')] = 'lta1',
) -> None:
    """
    Call a service of a running graph and print its response.

    emergency_stop stops the motors, crazyflie_bridge/arm true|false arms and disarms a real drone.
    Works like "ros2 service call" in the domain ROS_DOMAIN_ID.

    Exit status 0: success. 1: the service reports a failure. 2: no such service, or no response.

    Example: lta call emergency_stop

    Example: lta call crazyflie_bridge/arm false
    """
    answer = listener.call_service(robot_topic(robot, service), data)
    # A response may have no text
    words = answer.message or ('done' if answer.success else 'not done')
    plain_console().print(words, highlight=False, markup=False, soft_wrap=True)
    if not answer.success:
        raise typer.Exit(1)
