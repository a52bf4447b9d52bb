# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Describe a launch to the genuine `ros2 launch`.

ROS 2 alone ends with status 0 when a node has died, ignores misspelt arguments, and lets every
node complain about a wrong vehicle. Here the arguments are checked before anything starts, and the
unplanned exit of a node makes the status 1, as with `lta launch`.
"""

from functools import partial
from importlib.metadata import entry_points
from pathlib import Path
import signal
import sys

from launch import LaunchContext, LaunchDescription
from launch.action import Action
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.events.process import ProcessExited
from launch_ros.actions import Node
from lta_config.errors import BadInput
from lta_graph.child_process import signal_name
from lta_graph.launch_plan import Launch, LaunchProcess

# Entry points: functions that take a LaunchPlan and raise BadInput
CHECK_GROUP = 'lta.launch_checks'
# Nodes end with `ros2 launch`, however it ends, and Ctrl-C waits until Python has started, which
# would print a traceback. `lta launch` does both by itself.
PROCESS_PREFIX = 'setpriv --pdeathsig INT env --block-signal=INT'


def describe_launch(launch: Launch) -> LaunchDescription:
    """Return the arguments of a launch, and the function that starts its nodes."""
    declared = [
        DeclareLaunchArgument(
            argument.name,
            default_value=argument.default,
            description=argument.description,
            choices=list(argument.choices) or None,
        )
        for argument in launch.list_arguments()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start_nodes, args=[launch])])


def start_nodes(context: LaunchContext, launch: Launch) -> list[Action]:
    """
    Check a launch as `lta launch` does, and return the actions that start its nodes.

    Raise `BadInput` if it cannot fly; `ros2 launch` prints the sentence and ends with status 1.
    """
    plan = launch.build_plan(collect_arguments(context, launch))
    if any(process.shared for process in plan.processes):
        raise BadInput(
            'ros2 launch starts every node in a process of its own; for processes:=one use '
            '"ros2 run lta_cli lta launch" or "ros2 run lta_graph one_process".'
        )
    for check in entry_points(group=CHECK_GROUP):
        check.load()(plan)
    # launch hears a signal besides the handler of Python, which would print a traceback where an
    # interrupt meets a destructor; without any, SIGTERM kills the launch
    defaults = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    for number, handler in defaults.items():
        if signal.getsignal(number) == handler:
            signal.signal(number, lambda *_: None)
    return list(map(build_node, plan.processes))


def collect_arguments(context: LaunchContext, launch: Launch) -> dict[str, str]:
    """Return the arguments by name; of the launch file that people call, also the misspelt."""
    values = context.launch_configurations
    arguments = {
        each.name: values[each.name] for each in launch.list_arguments() if each.name in values
    }
    # ROS ignores an undeclared argument; of a launch file that includes this one it may be
    path = Path(context.locals.current_launch_file_path)
    if any(Path(word).name == path.name for word in sys.argv):
        arguments |= dict(word.split(':=', 1) for word in context.argv if ':=' in word)
    return arguments


def build_node(process: LaunchProcess) -> Node:
    """Return the action that starts a node."""
    timeout = process.sigterm_timeout
    return Node(
        package=process.package,
        executable=process.executable,
        # launch would name the process after the first word of the prefix
        exec_name=process.executable,
        name=process.name,
        # Relative, so that a launch file that includes this one can push a namespace
        namespace=process.namespace.strip('/'),
        arguments=list(process.words),
        ros_arguments=process.ros_arguments,
        prefix=PROCESS_PREFIX,
        output='screen',
        on_exit=partial(end_run, process=process) if process.on_exit_shutdown else None,
        **({} if timeout is None else {'sigterm_timeout': f'{timeout}'}),
    )


def end_run(
    event: ProcessExited, context: LaunchContext, process: LaunchProcess
) -> list[Action] | None:
    """End the run as a process has ended; raise `BadInput`, for status 1, if unplanned."""
    if context.is_shutdown:
        return None
    status = event.returncode
    if status == 0 and process.planned:
        return [Shutdown(reason=f'{process.name} ended')]
    how = f'ended with status {status}' if status >= 0 else f'was killed by {signal_name(-status)}'
    raise BadInput(f'{process.namespace}/{process.name} {how}, which ends the run.')
