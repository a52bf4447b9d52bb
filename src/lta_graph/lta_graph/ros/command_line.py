"""The command line of a node: started with it or refused in one sentence, nothing swallowed."""

from collections.abc import Sequence
from itertools import pairwise
import os

from lta_config.errors import BadInput
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

LOG_FOLDER = 'ROS_LOG_DIR'  # whoever sets it wants ROS's log files
OPTIONS = ('-p', '--param')
ROS_OWN = ('use_sim_time', 'start_type_description_service')
ROS_PREFIX = 'qos_overrides.'


def initialize_ros(arguments: Sequence[str], context: Context | None = None) -> None:
    """
    Initialise ROS in this process: without its signal handlers, and without its log files.

    rclpy's handlers would tear the context down before the last messages are out. A flight would
    leave a log file of each process in ~/.ros/log, with what stands on its streams already.

    Parameters
    ----------
    arguments : sequence of str
        The command line, with the program's name first.
    context : Context or None
        What to initialise; the default context unless given.

    Raises
    ------
    BadInput
        If ROS cannot start with these arguments, or does not take all of them: a node has no
        options of its own.

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
        # Behind it stands where in ROS's sources it was raised.
        why = str(error).partition(', at /')[0].rstrip('.')
        raise BadInput(f'ROS cannot start: {" ".join(why.split())}.') from None
    if strays:
        raise BadInput(
            f"The node does not know '{strays[0]}'; give parameters as --ros-args -p NAME:=VALUE."
        )


def reject_unknown_parameters(node: Node, arguments: Sequence[str]) -> None:
    """
    Refuse parameters that were given on the command line and that a node does not have.

    A parameter file may hold those of other nodes and is not looked at.

    Raises
    ------
    BadInput
        If there is one; the node's own are listed.

    """
    known = node.get_parameters_by_prefix('')
    for name in list_parameter_names(arguments, node.get_name()):
        if name not in known and not name.startswith(ROS_PREFIX):
            own = ', '.join(sorted(item for item in known if item not in ROS_OWN))
            raise BadInput(f"{node.get_name()} has no parameter '{name}'; known: {own}.")


def list_parameter_names(arguments: Sequence[str], node: str) -> list[str]:
    """Return the names of the parameters that a command line gives to a node."""
    rules = [rule.partition(':=')[0] for option, rule in pairwise(arguments) if option in OPTIONS]
    split = [rule.rpartition(':') for rule in rules]
    return [name for target, _, name in split if target.strip('/') in ('', '**', node)]
