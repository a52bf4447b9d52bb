"""
Declare a launch in Python: its arguments, and the nodes that they start.

`lta launch` supervises the processes of a launch (`launcher`), and `ros2 launch` starts them where
ROS 2 is installed (`ros.launch_description`). A launch file is a Python file that defines LAUNCH;
`launches` has the shipped ones.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, final, get_args

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file, format_error
from lta_config.python_file import run_python_file
from lta_config.settings import Settings
from lta_graph.launch_plan import LaunchPlan, LaunchProcess
from pydantic import ValidationError

SUFFIX = '.launch.py'


@final
@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """An argument as people see it."""

    name: str
    default: str
    choices: tuple[str, ...]  # empty if any text is allowed
    description: str


@final
@dataclass(frozen=True, slots=True)
class Launch:
    """
    What a launch file starts.

    `name`: how people call it. `arguments`: the model of its arguments; each has a default.
    `list_processes`: returns the processes for a model.
    """

    name: str
    arguments: type[Settings]
    list_processes: Callable[[Any], list[LaunchProcess]]

    def list_arguments(self) -> list[LaunchArgument]:
        """Return the arguments in order."""
        return [
            LaunchArgument(
                name,
                format_value(info.default),
                get_args(info.annotation),
                str(info.description),
            )
            for name, info in self.arguments.model_fields.items()
        ]

    def build_plan(self, values: Mapping[str, str]) -> LaunchPlan:
        """Return the plan for arguments by name; raise `BadInput` if one is not valid."""
        for name in values:
            if name not in self.arguments.model_fields:
                raise unknown_name_error(
                    'launch argument', name, list(self.arguments.model_fields)
                )
        try:
            model = self.arguments.model_validate_strings(dict(values))
        except ValidationError as error:
            raise BadInput(f'The launch argument {format_error(error)}') from None
        words = (self.name, *(f'{name}:={value}' for name, value in values.items()))
        return LaunchPlan(tuple(self.list_processes(model)), words)


def find_launch(name: str) -> Launch:
    """
    Return the launch of a shipped name such as `fly`, or of a launch file.

    Raise `BadInput` if there is no such file, or it cannot be run or defines no launch.
    """
    path = find_file('launch file', name, SUFFIX)
    launch = getattr(run_python_file(path, 'a launch file'), 'LAUNCH', None)
    if not isinstance(launch, Launch):
        raise BadInput(
            f"'{path}' defines no LAUNCH; start it with ros2 launch, or define one as "
            'docs/add.md shows.'
        )
    return replace(launch, name=name)


def parse_arguments(texts: Iterable[str]) -> dict[str, str]:
    """Parse launch arguments of the form NAME:=VALUE."""
    pairs = {}
    for item in texts:
        # The value may contain ':=' itself
        name, mark, value = item.partition(':=')
        if not mark or not name:
            raise BadInput(f"'{item}' is not a launch argument; write NAME:=VALUE.")
        # The last value of a repeated argument counts, as in ros2 launch
        pairs[name] = value
    return pairs


def format_value(value: object) -> str:
    """Return a value as people write it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
