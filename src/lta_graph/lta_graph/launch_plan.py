# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Launches in Python: their arguments, the nodes that these start, and the processes that result.

`lta launch` supervises the processes of a launch (`launcher`), and `ros2 launch` starts them where
ROS 2 is installed (`ros.launch_description`). A launch file is a Python file that defines LAUNCH;
`launches` has the shipped ones.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
import json
import math
from pathlib import Path
from typing import Any, final, get_args

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import format_error
from lta_config.settings import Settings
from lta_config.topics import is_name
from pydantic import ValidationError

Parameter = bool | int | float | str | list[bool] | list[int] | list[float] | list[str]
ONE_PROCESS = ('lta_graph', 'one_process')  # package and executable that runs several nodes


@final
@dataclass(frozen=True, slots=True)
class LaunchProcess:
    """One node of a launch; its process, unless it shares one."""

    # As in `ros2 run PACKAGE EXECUTABLE`
    package: str
    executable: str
    name: str  # the node's
    namespace: str = '/'  # absolute
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    parameter_file: str = ''  # path; `parameters` come after it
    last_file: str = ''  # path of a file of parameters that wins over all
    words: tuple[str, ...] = ()  # of the command line, before those for ROS
    on_exit_shutdown: bool = True  # whether the exit of this process ends the run
    planned: bool = False  # whether its exit with status 0 is a planned end of the run
    # Time to exit after SIGINT; None for the launcher's own [s]
    sigterm_timeout: float | None = None
    shared: bool = False  # whether the node runs in one process with the others
    takes_ros_arguments: bool = True

    def __post_init__(self) -> None:
        """Reject a name or a namespace that ROS would reject."""
        if not is_name(self.name):
            raise BadInput(f"'{self.name}' is not a valid node name; use letters, digits and _.")
        if self.namespace != '/' and not all(map(is_name, self.namespace.split('/')[1:])):
            raise BadInput(
                f"'{self.namespace}' is not a valid namespace; use letters, digits, _ and /."
            )

    @property
    def ros_arguments(self) -> list[str]:
        """Return the parameters as `--ros-args`, after which ROS reads them."""
        # ROS lets the file win over parameters that stand before it
        words = ['--params-file', self.parameter_file] if self.parameter_file else []
        for name, value in self.parameters.items():
            words += ['-p', f'{name}:={format_ros_yaml(value)}']
        return [*words, '--params-file', self.last_file] if self.last_file else words

    @property
    def arguments(self) -> tuple[str, ...]:
        """Return the command line after the executable."""
        if not self.takes_ros_arguments:
            return self.words
        # `__node` and `__ns` are the special remapping rules of rcl
        names = ['-r', f'__node:={self.name}']
        if self.namespace != '/':
            names += ['-r', f'__ns:={self.namespace}']
        return (*self.words, '--ros-args', *names, *self.ros_arguments)


@final
@dataclass(frozen=True, slots=True)
class LaunchPlan:
    """The processes that a launch starts; those that are `shared` are nodes of one."""

    processes: tuple[LaunchProcess, ...]
    # The launch file and its arguments, as words of a command line
    words: tuple[str, ...] = ()

    @property
    def namespaces(self) -> list[str]:
        """Return the namespaces of the nodes, without leading slash, in order of appearance."""
        return list(dict.fromkeys(item.namespace.strip('/') for item in self.processes))

    def label(self, process: LaunchProcess) -> str:
        """Return the label of a process: `estimator`, or `lta2/estimator` with several robots."""
        several = len(self.namespaces) > 1
        return f'{process.namespace}/{process.name}'.strip('/') if several else process.name

    @property
    def started(self) -> list[LaunchProcess]:
        """Return the processes to start: one that nodes share, one for each of the others."""
        shared = [process for process in self.processes if process.shared]
        if not shared:
            return list(self.processes)
        common = LaunchProcess(
            *ONE_PROCESS,
            name=ONE_PROCESS[1],
            words=self.words,
            takes_ros_arguments=False,
            on_exit_shutdown=any(process.on_exit_shutdown for process in shared),
            # Which of its nodes may end is its own business
            planned=True,
            sigterm_timeout=max(
                (each.sigterm_timeout for each in shared if each.sigterm_timeout), default=None
            ),
        )
        return [common, *(process for process in self.processes if not process.shared)]

    def list_nodes(self, process: LaunchProcess) -> list[str]:
        """Return the labels of the nodes that run in one of the started processes."""
        if (process.package, process.executable) != ONE_PROCESS:
            return [self.label(process)]
        return [self.label(node) for node in self.processes if node.shared]


def format_ros_yaml(value: Parameter) -> str:
    """
    Format a value as YAML that ROS's parser reads back with the same type.

    Text is always quoted: ROS reads a bare `y` as true and a bare `nan` as a number.
    """
    if isinstance(value, list):
        return f'[{", ".join(format_ros_yaml(item) for item in value)}]'
    # Before the numbers, since repr(True) would be 'True'
    if isinstance(value, bool):
        return 'true' if value else 'false'
    if isinstance(value, float) and not math.isfinite(value):
        return '.nan' if math.isnan(value) else f'{"-" if value < 0 else ""}.inf'
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


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
        processes = tuple(self.list_processes(model))
        if file := getattr(model, 'params_file', ''):
            if not Path(file).is_file():
                raise BadInput(f'There is no parameter file {file}; check the path.')
            processes = tuple(replace(each, last_file=file) for each in processes)
        return LaunchPlan(processes, words)


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
