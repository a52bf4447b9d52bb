# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Report a missing ROS 2 installation; most verbs do not need ROS 2."""

from importlib import metadata
from importlib.util import find_spec
from typing import Final

from lta_config.errors import BadInput
import typer

ROS: Final = ('rclpy', 'rcl_interfaces', 'builtin_interfaces', 'std_srvs')
ROS_REMEDY: Final = 'get the LTA sources, run "make build" there, and use ./lta'
# The last lines of `lta --help` where only the wheel is installed
WITHOUT_GRAPH: Final = f'fly, replay, launch and call need ROS 2: {ROS_REMEDY}.'
# A verb that cannot run accepts all arguments, so that its own message is shown.
ANYTHING: Final = {'allow_extra_args': True, 'ignore_unknown_options': True}


def is_graph_installed() -> bool:
    """Return whether nodes can run here."""
    return find_spec('rclpy') is not None


def is_wheel_without_graph() -> bool:
    """Return whether LTA was installed by pip, beside no ROS 2."""
    try:
        metadata.distribution('lta')
    except metadata.PackageNotFoundError:
        return False
    return not is_graph_installed()


def is_ros_module(module: str | None) -> bool:
    """Return whether a missing module belongs to ROS 2."""
    top = (module or '').split('.')[0]
    # Message packages end in _msgs by convention
    return top in ROS or top.endswith('_msgs')


def missing_ros_error(missing: ModuleNotFoundError) -> BadInput:
    """Return the error for a missing ROS 2 module."""
    return BadInput(
        f"This command needs ROS 2, but its package '{missing.name}' is not installed; "
        f'{ROS_REMEDY}.'
    )


def refuse_without_ros(context: typer.Context) -> None:
    """Not available: needs ROS 2, which is not installed."""
    raise BadInput(f"'lta {context.info_name}' needs ROS 2, which is not installed; {ROS_REMEDY}.")
