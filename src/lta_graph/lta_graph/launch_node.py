"""Convert a `node` action of a launch file to the command line of a process."""

from collections.abc import Iterator
from dataclasses import dataclass
import json
import math
from pathlib import Path
from typing import final

from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_config.topics import is_name
from lta_graph.launch_actions import NodeAction, Param, Scalar
from lta_graph.launch_substitutions import (
    expand_substitutions,
    has_substitution,
    LaunchContext,
    split_command_line,
)


@final
@dataclass(frozen=True, slots=True)
class LaunchProcess:
    """One process of a launch plan."""

    # As in `ros2 run PACKAGE EXECUTABLE`
    package: str
    executable: str
    name: str  # the node's name; the executable by default
    namespace: str  # absolute; `/` by default
    arguments: tuple[str, ...]  # command line after the executable
    on_exit_shutdown: bool  # whether the exit of this process ends the run
    planned: bool = True  # whether its exit with status 0 is a planned end of the run
    # Time to exit after SIGINT; None for the launcher's own [s]
    sigterm_timeout: float | None = None
    shared: bool = False  # whether the node runs in one process with the others


def build_node_process(node: NodeAction, context: LaunchContext, namespace: str) -> LaunchProcess:
    """
    Return the process that a `node` action starts.

    `namespace` is that of the scope, absolute or empty.
    """
    name = expand_substitutions(node.name, context)
    if not is_name(name):
        raise BadInput(f"'{name}' is not a valid node name; use letters, digits and _.")
    # `__node` and `__ns` are the special remapping rules of rcl
    ros = ['--ros-args', '-r', f'__node:={name}']
    if namespace:
        ros += ['-r', f'__ns:={namespace}']
    for param in node.param or []:
        ros += format_parameter_arguments(param, context)
    return LaunchProcess(
        package=expand_substitutions(node.pkg, context),
        executable=expand_substitutions(node.exec, context),
        name=name,
        namespace=namespace or '/',
        arguments=(*split_command_line(node.args, context), *ros),
        on_exit_shutdown=node.on_exit == 'shutdown',
        sigterm_timeout=node.sigterm_timeout,
    )


def join_namespaces(base: str, name: str) -> str:
    """
    Return `name` below `base` as an absolute namespace; an absolute name is kept.

    Raises `BadInput` if the result is not a valid namespace.
    """
    joined = name if name.startswith('/') else f'{base}/{name}'
    # The root namespace is written as an empty string here
    joined = '/' + joined.strip('/') if joined.strip('/') else ''
    if not all(is_name(token) for token in joined.split('/')[1:]):
        raise BadInput(f"'{joined}' is not a valid namespace; use letters, digits, _ and /.")
    return joined


def format_parameter_arguments(param: Param, context: LaunchContext) -> list[str]:
    """Convert a `param` entry to `--ros-args` arguments."""
    if param.from_ is not None:
        path = Path(expand_substitutions(param.from_, context))
        if not path.is_file():
            raise BadInput(f'There is no parameter file {path}; check the path.')
        return ['--params-file', str(path)]
    pairs = (
        ['-p', f'{name}:={format_ros_yaml(value)}']
        for name, value in iterate_parameters(param, context)
    )
    return [word for pair in pairs for word in pair]


def iterate_parameters(
    param: Param, context: LaunchContext, prefix: str = ''
) -> Iterator[tuple[str, Scalar]]:
    """Yield the dotted name and the value of every parameter of an entry."""
    name = prefix + expand_substitutions(param.name or '', context)
    for nested in param.param or []:
        yield from iterate_parameters(nested, context, f'{name}.')
    if param.value is not None:
        yield name, convert_to_ros_type(name, param.value, param.type, context)


def convert_to_ros_type(
    name: str, scalar: Scalar, kind: str | None, context: LaunchContext
) -> Scalar:
    """
    Return a parameter's value with the type that ROS gives it.

    Literal values keep their type. The result of a substitution is parsed as YAML, so that
    `$(var speed)` can be a number, unless `type` is given.
    """
    value: object = scalar
    if isinstance(scalar, str):
        value = expand_substitutions(scalar, context)
        if kind == 'float':
            value = _parse_float(value)
        elif kind is None and has_substitution(scalar):
            value = _parse_yaml_value(value)
    expected = {None: (bool, int, float, str), 'str': (str,), 'float': (float,)}[kind]
    # An exact type, because isinstance would accept a bool as an int
    if type(value) not in expected:
        needed = 'a number, true, false or text' if kind is None else f'of type {kind}'
        raise BadInput(f'The parameter {name} is {value!r}, but must be {needed}.')
    return value  # type: ignore[return-value]


def _parse_float(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return text


def _parse_yaml_value(text: str) -> object:
    try:
        return parse_yaml(text, 'The value')
    # Text that is not valid YAML, such as 'a: b: c', stays text as in ROS
    except BadInput:
        return text


def format_ros_yaml(value: Scalar | list[Scalar]) -> str:
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
