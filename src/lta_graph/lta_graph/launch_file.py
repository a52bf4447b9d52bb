"""
Read ROS 2 YAML launch files into a plan of processes, without the `launch` package.

This is the subset that the launch files of LTA use. The same files run under `ros2 launch`, with
the same meaning: names, types, scopes and substitutions are those of ROS 2 Jazzy (see
`launch_actions`, `launch_substitutions`), except for the action `supervise`, which
`lta_graph.ros.launch_extension` adds there. Arguments must be declared by the file that receives
them.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import load_yaml
from lta_config.validation_errors import format_error, locate_problem
from lta_graph.launch_actions import (
    Action,
    ACTIONS,
    Arg,
    ConditionalAction,
    GroupAction,
    Include,
    Let,
    NodeAction,
    PushRosNamespace,
    Supervise,
)
from lta_graph.launch_node import build_node_process, join_namespaces, LaunchProcess
from lta_graph.launch_substitutions import expand_substitutions, LaunchContext
from pydantic import ValidationError

NAMESPACE = 'ros_namespace'  # launch variable that ROS also uses for the pushed namespace
ONE = 'one'  # value of `processes` with which nodes share a process
ONE_PROCESS = ('lta_graph', 'one_process')  # package and executable that runs them


@final
@dataclass(frozen=True, slots=True)
class LaunchPlan:
    """The processes that a launch file starts; those that are `shared` are nodes of one."""

    processes: tuple[LaunchProcess, ...]
    # The launch file and its arguments, as words of a command line
    words: tuple[str, ...] = ()

    @property
    def namespaces(self) -> list[str]:
        """The namespaces of the nodes, without leading slash, in order of appearance."""
        return list(dict.fromkeys(item.namespace.strip('/') for item in self.processes))

    def label(self, process: LaunchProcess) -> str:
        """Return the label of a process: `estimator`, or `lta2/estimator` with several robots."""
        several = len(self.namespaces) > 1
        return f'{process.namespace}/{process.name}'.strip('/') if several else process.name

    @property
    def started(self) -> list[LaunchProcess]:
        """The processes to start: one for all nodes that share it, and one for each other."""
        shared = [process for process in self.processes if process.shared]
        if not shared:
            return list(self.processes)
        common = LaunchProcess(
            *ONE_PROCESS,
            name=ONE_PROCESS[1],
            namespace='/',
            arguments=self.words,
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


def list_arguments(path: Path) -> list[Arg]:
    """
    Return the arguments that a launch file declares, in order.

    Raises `BadInput` if the file is not a launch file.
    """
    return [action for action in _read_actions(path) if isinstance(action, Arg)]


def load_plan(path: Path, arguments: Mapping[str, str]) -> LaunchPlan:
    """
    Return the plan of a `*.launch.yaml` file with arguments by name.

    Raises `BadInput` with place and remedy if the file or an argument is invalid.
    """
    walk = _PlanBuilder()
    walk.include_file(Path(path), arguments)
    planned, apart = walk.planned, walk.apart
    return LaunchPlan(
        tuple(
            replace(
                item,
                planned=planned is None or item.name in planned,
                shared=walk.shares_process and item.name not in apart,
            )
            for item in walk.processes
        ),
        (str(path), *(f'{name}:={value}' for name, value in arguments.items())),
    )


def _read_actions(path: Path) -> list[Action]:
    """Parse the actions of a launch file."""
    if not path.is_file():
        raise BadInput(f'There is no launch file {path}; check the path.')
    if not path.name.endswith(('.launch.yaml', '.launch.yml')):
        raise BadInput(
            f'{path} is not a .launch.yaml file; lta runs only YAML launch files, so use "ros2 '
            'launch" for it.'
        )
    content = load_yaml(path)
    if not isinstance(content, dict) or list(content) != ['launch']:
        raise BadInput(f"{path} is not a launch file; its only key must be 'launch:'.")
    return _parse_actions(content['launch'], path)


def _parse_actions(entries: Any, path: Path) -> list[Action]:  # noqa: ANN401 - what the file held
    if not isinstance(entries, list):
        raise BadInput(f"{path}: the actions must be a list; begin each with '- '.")
    return [_parse_action(entry, path) for entry in entries]


def _parse_action(entry: Any, path: Path) -> Action:  # noqa: ANN401 - what the file held
    if not isinstance(entry, dict) or len(entry) != 1:
        raise BadInput(
            f'{path}: the action {entry!r} must have exactly one name, as in "- node: ...".'
        )
    ((name, content),) = entry.items()
    if name not in ACTIONS:
        raise BadInput(
            f"{path}: The action '{name}' is unknown to lta launch, which supports only "
            f'{", ".join(ACTIONS)}; correct the name, or start the file with "ros2 launch".'
        )
    if name == 'group':
        content = {'children': content}
    try:
        action = ACTIONS[name].model_validate(content)
    except ValidationError as error:
        raise BadInput(f'{path}: {name}: {_format_action_error(error)}') from None
    if isinstance(action, GroupAction):
        children = _parse_actions(action.children, path)
        if any(isinstance(child, Arg) for child in children):
            raise BadInput(f"{path}: an 'arg' is in a group; move it to the top of the file.")
        return action.model_copy(update={'children': children})
    return action


def _format_action_error(error: ValidationError) -> str:
    first = error.errors()[0]
    if first['type'] != 'extra_forbidden':
        return format_error(error)
    return (
        f"The key '{locate_problem(first)}' is unknown to lta launch; correct its spelling, or "
        'start the file with "ros2 launch" if ROS 2 has it.'
    )


class _LocatedError(BadInput):
    """Bad input whose message already names the file."""


@final
class _PlanBuilder:
    """Walk a launch file and collect its processes, with the variables in scope."""

    def __init__(self) -> None:
        self.processes: list[LaunchProcess] = []
        self.planned: set[str] | None = None
        self.shares_process = False
        self.apart: set[str] = set()
        self._variables: dict[str, str] = {}
        self._open: list[Path] = []

    def include_file(self, path: Path, arguments: Mapping[str, str]) -> None:
        """Run a file's actions; as in ROS, its variables persist unless the include is grouped."""
        # Without this check an include cycle would recurse without end
        if path.resolve() in self._open:
            raise BadInput(f'{path} includes itself; remove the include.')
        actions = _read_actions(path)
        declared = [action.name for action in actions if isinstance(action, Arg)]
        for name in arguments:
            if name not in declared:
                raise BadInput(f'{path}: {unknown_name_error("launch argument", name, declared)}')
        # Before the actions run, so that an `arg` finds its value and does not take the default
        self._variables.update(arguments)
        self._open.append(path.resolve())
        self._run_actions(actions)
        self._open.pop()

    def _run_actions(self, actions: Sequence[Action]) -> None:
        path = self._open[-1]
        for action in actions:
            try:
                self._run_action(action)
            # An included file has already added its path
            except _LocatedError:
                raise
            except BadInput as error:
                raise _LocatedError(f'{path}: {error}') from None

    def _substitute(self, text: str) -> str:
        return expand_substitutions(text, self._build_context())

    def _build_context(self) -> LaunchContext:
        return LaunchContext(self._open[-1].parent, self._variables)

    def _run_action(self, action: Action) -> None:
        if isinstance(action, ConditionalAction) and not self._is_enabled(action):
            return
        match action:
            case Arg():
                self._declare_argument(action)
            case Let():
                self._variables[self._substitute(action.name)] = self._substitute(action.value)
            case PushRosNamespace():
                pushed = join_namespaces(
                    self._variables.get(NAMESPACE, ''), self._substitute(action.namespace)
                )
                self._variables[NAMESPACE] = pushed
            case GroupAction():
                # A scope ends by restoring all variables, the pushed namespace among them
                before = dict(self._variables)
                self._run_actions(action.children)
                self._variables = before
            case Include():
                arguments = {item.name: self._substitute(item.value) for item in action.arg or []}
                self.include_file(Path(self._substitute(action.file)), arguments)
            case Supervise():
                names = self._substitute(action.planned).split()
                self.planned = (self.planned or set()) | set(names)
                self.shares_process |= self._substitute(action.processes) == ONE
                self.apart |= set(self._substitute(action.apart).split())
            case NodeAction():
                pushed = self._variables.get(NAMESPACE, '')
                self.processes.append(build_node_process(action, self._build_context(), pushed))

    def _is_enabled(self, action: ConditionalAction) -> bool:
        text = action.if_ if action.if_ is not None else action.unless
        if text is None:
            return True
        # The same four words as ROS 2 accepts
        value = self._substitute(text).strip().lower()
        if value not in ('true', '1', 'false', '0'):
            raise BadInput(f"The condition '{text}' is '{value}', but must be true or false.")
        return (value in ('true', '1')) == (action.if_ is not None)

    def _declare_argument(self, arg: Arg) -> None:
        choices = arg.choices
        if arg.name not in self._variables:
            if arg.default is None:
                about = f' ({arg.description.rstrip(".")})' if arg.description else ''
                raise BadInput(
                    f"The launch argument '{arg.name}'{about} is missing; "
                    f'give {arg.name}:={choices[0] if choices else "VALUE"}.'
                )
            self._variables[arg.name] = self._substitute(arg.default)
        value = self._variables[arg.name]
        # Also for a default, which a substitution may have set
        if choices and value not in choices:
            raise BadInput(
                f"The launch argument '{arg.name}' is '{value}', but must be one of "
                f'{", ".join(choices)}.'
            )
