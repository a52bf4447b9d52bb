"""lta launch: a launch file, as `ros2 launch` would."""

import os
from pathlib import Path
import shutil
import sys
from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_flight.flight import is_refusal
from lta_flight.graph import run_graph
from lta_flight.preflight import check_plan
from lta_graph.launch_file import list_arguments, load_plan
from rich.table import Table
import typer

SUFFIX = '.launch.yaml'
WHEELS = 'wheels'  # what tools/workspace.sh calls an underlay that has no ros2 of its own


def launch(
    file: Annotated[str, typer.Argument(help='A shipped name (fly) or a *.launch.yaml.')],
    given: Annotated[
        list[str] | None, typer.Argument(metavar='[NAME:=VALUE]...', help='Launch arguments.')
    ] = None,
    show_args: Annotated[
        bool, typer.Option('--show-args', help='List the arguments and leave.')
    ] = False,
) -> None:
    """
    Start a graph from a ROS 2 YAML launch file and watch it.

    The end of a node is named, and so is one that hangs; if an end was not the planned one, all
    others are stopped and the exit status is 1, or 2 if the node refused its input. Called over
    an installed ROS 2 (ros2 run lta_cli lta launch ...), it hands over to the genuine
    "ros2 launch"; ./lta never does.

    Example: lta launch fly seed:=2 time:=lockstep bag:=/tmp/flight
    """
    path = find_file('launch file', file, SUFFIX)
    if show_args:
        print_arguments(path)
        return
    pairs = parse_arguments(given or [])
    plan = load_plan(path, pairs)
    if os.environ.get('LTA_UNDERLAY') != WHEELS and shutil.which('ros2'):
        os.execvp('ros2', ['ros2', 'launch', str(path), *(given or [])])
    check_plan(plan)
    outcome = run_graph(plan, print_node_line, print_event)
    if is_refusal(outcome):
        raise BadInput(outcome.lines[-1])
    if not outcome.success:
        raise typer.Exit(1)


def print_event(sentence: str) -> None:
    """Print what happened to the graph."""
    sys.stderr.write(f'{sentence}\n')


def print_node_line(node: str, line: str) -> None:
    """Print one line of a node under its name."""
    sys.stdout.write(f'[{node}] {line}\n')


def parse_arguments(texts: list[str]) -> dict[str, str]:
    """Return launch arguments by name; each is written NAME:=VALUE."""
    pairs = {}
    for item in texts:
        name, mark, value = item.partition(':=')
        if not mark or not name:
            raise BadInput(f"'{item}' is no launch argument; write NAME:=VALUE.")
        pairs[name] = value
    return pairs


def print_arguments(path: Path) -> None:
    """Print the arguments of a launch file as a table."""
    table = Table('argument', 'default', 'choices', 'meaning', title=path.name)
    for item in list_arguments(path):
        default = 'required' if item.default is None else item.default
        table.add_row(item.name, default, ' '.join(item.choices), item.description)
    plain_console().print(table)
