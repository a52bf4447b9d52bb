# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check the command line of a node and initialise ROS with it."""

from collections.abc import Sequence
from itertools import pairwise
import os

from lta_config.errors import BadInput
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

LOG_FOLDER = 'ROS_LOG_DIR'  # a user who sets it wants ROS's log files
OPTIONS = ('-p', '--param')
# Declared by rclpy in every node, so not worth listing in an error message
ROS_OWN = ('use_sim_time', 'start_type_description_service', 'qos_overrides.')


def initialize_ros(arguments: Sequence[str], context: Context | None = None) -> None:
    """
    Initialise ROS in this process, without its signal handlers and log files.

    rclpy's handlers would shut the context down before the last messages are sent. The log files
    in ~/.ros/log would only repeat what the processes print.

    `arguments`: the command line, with the program's name first. `context`: the context to
    initialise; None for the default one. Raise `BadInput` if ROS rejects an argument, or an
    argument is left over: a node has no options of its own.
    """
    words = list(arguments)
    quiet = [] if os.environ.get(LOG_FOLDER) else ['--ros-args', '--disable-external-lib-logs']
    try:
        strays = remove_ros_args(words)[1:]  # first: rclpy.init would add lines of its own
        rclpy.init(
            args=[*words, *quiet],
            context=context,
            signal_handler_options=SignalHandlerOptions.NO,
        )
    except RuntimeError as error:
        # rcl appends the place in its sources (', at /...'), which does not help the user
        why = str(error).partition(', at /')[0].rstrip('.')
        raise BadInput(f'ROS cannot start: {" ".join(why.split())}.') from None
    if strays:
        raise BadInput(
            f"The node does not know the argument '{strays[0]}'; set parameters with --ros-args "
            '-p '
            'NAME:=VALUE.'
        )


def reject_unknown_parameters(node: Node, arguments: Sequence[str]) -> None:
    """
    Reject command-line parameters that a node does not have.

    Parameter files are not checked, because they may hold parameters of other nodes.

    Raise `BadInput` if there is one; the message lists the node's own.
    """
    parameters = node.get_parameters_by_prefix('')
    for name in list_parameter_names(arguments, node.get_name()):
        if name not in parameters:
            own = ', '.join(sorted(item for item in parameters if not item.startswith(ROS_OWN)))
            raise BadInput(f"The node {node.get_name()} has no parameter '{name}'; known: {own}.")


def list_parameter_names(arguments: Sequence[str], node: str) -> list[str]:
    """Return the names of the parameters that a command line sets on a node."""
    rules = [rule.partition(':=')[0] for option, rule in pairwise(arguments) if option in OPTIONS]
    split = [rule.rpartition(':') for rule in rules]
    # A rule is `name:=value` or `node:name:=value`, where `**` stands for every node
    return [name for target, _, name in split if target.strip('/') in ('', '**', node)]
