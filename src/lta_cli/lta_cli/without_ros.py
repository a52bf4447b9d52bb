"""What the command says where ROS 2 is not installed: most verbs need none."""

from typing import Final

from lta_config.errors import BadInput
import typer

ROS: Final = ('rclpy', 'rcl_interfaces', 'builtin_interfaces', 'std_srvs')
REMEDY: Final = 'build the ROS 2 workspace of the sources (make build) and use its ./lta'
# A verb that cannot be loaded takes whatever follows it, to say why.
ANYTHING: Final = {'allow_extra_args': True, 'ignore_unknown_options': True}


def is_ros_module(module: str | None) -> bool:
    """Tell whether a module that is missing is one of ROS 2."""
    top = (module or '').split('.')[0]
    return top in ROS or top.endswith('_msgs')


def missing_ros_error(missing: ModuleNotFoundError) -> BadInput:
    """Return the sentence on a module of ROS 2 that is not here."""
    return BadInput(f"This needs ROS 2, whose '{missing.name}' is not installed; {REMEDY}.")


def refuse_without_ros(context: typer.Context) -> None:
    """Need ROS 2, which is not installed here."""
    raise BadInput(f"'lta {context.info_name}' needs ROS 2, which is not installed; {REMEDY}.")
