"""
Define strict models of the supported actions of ROS 2 YAML launch files.

They are the subset that the launch files of LTA use; names and types follow ROS 2 Jazzy's parser,
so a file that is valid here also runs under `ros2 launch`. As there, most values must be text, so
numbers need quotes.
"""

from typing import Annotated, Any, Literal

from lta_config.files import StrictModel
from pydantic import BeforeValidator, Field, model_validator


def _check_quoted(value: Any) -> Any:  # noqa: ANN401 - whatever the file held
    # YAML turns an unquoted 0.5 into a number, which ROS rejects
    if isinstance(value, bool | int | float):
        raise ValueError(f"is {value} without quotes, but ROS needs text here; write '{value}'")
    return value


Text = Annotated[str, BeforeValidator(_check_quoted)]
Scalar = bool | int | float | str


class ConditionalAction(StrictModel):
    """Base of the actions that may depend on a condition."""

    if_: Annotated[Text | None, Field(alias='if')] = None
    unless: Text | None = None

    @model_validator(mode='after')
    def _check_one_condition(self) -> 'ConditionalAction':
        if self.if_ is not None and self.unless is not None:
            raise ValueError('has both "if" and "unless"; remove one')
        return self


class ArgumentChoice(StrictModel):
    """One allowed value of a launch argument."""

    value: Text


class Arg(StrictModel):
    """Declare a launch argument; without a default it must be given."""

    name: Text
    default: Text | None = None
    description: Text = ''
    choice: Annotated[list[ArgumentChoice], Field(min_length=1)] | None = None

    @property
    def choices(self) -> tuple[str, ...]:
        """The allowed values; empty if any text is allowed."""
        return tuple(choice.value for choice in self.choice or [])


class NamedSubstitution(StrictModel):
    """A name and the text it stands for."""

    name: Text
    value: Text


class Let(ConditionalAction):
    """Set a launch variable in the present scope."""

    name: Text
    value: Text


class Include(StrictModel):
    """Run another launch file with arguments."""

    file: Text
    arg: Annotated[list[NamedSubstitution], Field(min_length=1)] | None = None


class GroupAction(StrictModel):
    """Run actions in their own scope; in the file this is a list."""

    children: list[Any]


class PushRosNamespace(StrictModel):
    """Put the following nodes of the scope into a namespace."""

    namespace: Text


class Supervise(StrictModel):
    """
    Check the arguments before anything starts, and fail the run if a node dies.

    `planned` are the names of the nodes, separated by spaces, whose end with status 0 is the
    planned end of the run. With `processes` one, all nodes share a process, except those that are
    named `apart`. `lta_graph.ros.launch_extension` is the same action for `ros2 launch`.
    """

    planned: Text
    processes: Text = ''
    apart: Text = ''


class Param(StrictModel):
    """A parameter with its value, a prefix with nested parameters, or a parameter file."""

    name: Text | None = None
    value: Scalar | None = None
    type: Literal['str', 'float'] | None = None
    param: Annotated[list['Param'], Field(min_length=1)] | None = None
    from_: Annotated[Text | None, Field(alias='from')] = None

    @model_validator(mode='after')
    def _check_exclusive_fields(self) -> 'Param':
        present = [item is not None for item in (self.value, self.param, self.from_)]
        # A file (`from`) has no name; a value or a nested parameter needs one
        if sum(present) != 1 or (self.name is None) != (self.from_ is not None):
            raise ValueError(
                'needs either "from" (a parameter file), or "name" with "value" or "param"'
            )
        if self.type is not None and self.value is None:
            raise ValueError('has a "type" but no "value"; remove the type')
        if any(nested.from_ is not None for nested in self.param or []):
            raise ValueError('has "from" in a nested parameter; move it to "param" of the node')
        return self


class NodeAction(ConditionalAction):
    """Start a ROS node in its own process."""

    pkg: Text
    exec: Text
    name: Text
    param: Annotated[list[Param], Field(min_length=1)] | None = None
    args: Text = ''
    # For `ros2 launch`; our launcher prints the output of all nodes, after their names
    exec_name: Text = ''
    output: Literal['screen'] = 'screen'
    on_exit: Literal['shutdown'] | None = None
    sigterm_timeout: Annotated[float, Field(ge=0.0)] | None = None


Action = Arg | Let | Include | GroupAction | PushRosNamespace | Supervise | NodeAction

ACTIONS: dict[str, type[Action]] = {
    'arg': Arg,
    'let': Let,
    'include': Include,
    'group': GroupAction,
    'push_ros_namespace': PushRosNamespace,
    'supervise': Supervise,
    'node': NodeAction,
}
