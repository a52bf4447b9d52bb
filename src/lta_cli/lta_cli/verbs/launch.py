# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta launch: run a launch file like `ros2 launch`."""

from collections.abc import Mapping
import os
from pathlib import Path
import shutil
import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_bag.reader import read_bag
from lta_config.atomic_file import reserve_folder
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import list_robots
from lta_flight.flight import describe_line, is_refusal, parse_status
from lta_flight.flight_run import EXIT_STATUSES
from lta_flight.graph import list_bags, run_graph
from lta_flight.preflight import check_plan
from lta_flight.report.page import write_page
from lta_graph.launch_plan import Launch, LaunchPlan, parse_arguments
from lta_graph.launches import find_launch, LAUNCH_SUFFIX, LAUNCHES
from lta_report.results_folder import format_page_line
from rich.table import Table
import typer

WHEELS = 'wheels'  # tools/workspace.sh: the underlay is pip wheels, without a ros2 command


def launch(
    file: Annotated[
        str,
        typer.Argument(
            help='Launch file (./*.launch.py), or the name fly, fleet or emulated for a '
            'shipped one.'
        ),
    ],
    arguments: Annotated[
        list[str] | None, typer.Argument(metavar='[NAME:=VALUE]...', help='Launch arguments.')
    ] = None,
    show_args: Annotated[
        bool, typer.Option('--show-args', help='List the arguments of the launch file and exit.')
    ] = False,
) -> None:
    """
    Start a graph from a launch file and monitor it.

    Reports nodes that exit or hang. If an essential node exits unexpectedly, all others are
    stopped. With an installed ROS 2 (ros2 run lta_cli lta launch ...) this runs the real
    "ros2 launch", which has its own exit status; ./lta never does. Without bag:=FOLDER, the bag is
    runs/bag, or runs/bag-2, runs/bag-3 ... where there is one.

    Exit status 0: every simulated drone reached its goal, or nothing was simulated. 1: an
    essential node died. 2: bad input. 3: a drone ran out of time. 4: a drone left the room.
    130: Ctrl-C.

    Example: lta launch fly seed:=2 time:=lockstep bag:=/tmp/flight
    """
    chosen = find_launch(file)
    if show_args:
        print_arguments(chosen)
        return
    pairs = parse_arguments(arguments or [])
    # Validate the arguments first, also for the real ros2 launch
    plan = chosen.build_plan(pairs)
    if bag := reserve_bag(chosen, pairs, plan):
        pairs |= bag
        plan = chosen.build_plan(pairs)
    check_plan(plan)
    # Another environment may have a ros2 command that does not belong to the wheels
    # `ros2 launch` gives every node a process of its own
    alone = not any(process.shared for process in plan.processes)
    if alone and os.environ.get('LTA_UNDERLAY') != WHEELS and shutil.which('ros2'):
        # Replaces this process, so signals and the exit status are those of ros2 launch
        words = [f'{name}:={value}' for name, value in pairs.items()]
        where = ['lta_bringup', f'{file}{LAUNCH_SUFFIX}'] if file in LAUNCHES else [file]
        os.execvp('ros2', ['ros2', 'launch', *where, *words])
    outcomes: list[str] = []  # of the simulated flights

    def on_line(node: str, line: str) -> None:
        print_node_line(node, line)
        if (status := parse_status(line)) is not None:
            outcomes.append(status['outcome'])

    outcome = run_graph(plan, on_line, print_event)
    # The last line of the node states what was wrong with its input
    if is_refusal(outcome):
        raise BadInput(outcome.lines[-1])
    print_recordings(plan)
    if not outcome.success:
        raise typer.Exit(1)
    # Players report an outcome of their own, which is no flight's
    if status := max((EXIT_STATUSES.get(each, 0) for each in outcomes), default=0):
        raise typer.Exit(status)


def reserve_bag(chosen: Launch, pairs: Mapping[str, str], plan: LaunchPlan) -> dict[str, str]:
    """Return the argument `bag` with a new folder where the plan records into the default one."""
    default = next((each.default for each in chosen.list_arguments() if each.name == 'bag'), None)
    if 'bag' in pairs or default is None or Path(default) not in list_bags(plan):
        return {}
    return {'bag': str(reserve_folder(Path(default)))}


def print_recordings(plan: LaunchPlan) -> None:
    """Print the bags of a graph, and write a page for each robot of several."""
    for bag in filter(Path.is_dir, list_bags(plan)):
        place = relative_path(bag)
        lines = [f'Bag  {bag}  (its messages: {format_lta_command("bag", "info", place)})']
        try:
            robots = list_robots(read_bag(bag))
            if len(robots) == 1:
                lines.append(f'Page: {format_lta_command("report", place)}')
            # Each of several robots needs --robot, which is easily forgotten
            for robot in robots if len(robots) > 1 else ():
                page = bag.absolute().parent / f'report-{robot}.html'
                write_page(bag, page, robot)
                lines.append(format_page_line(page))
        except BadInput as error:  # such as a flight of a moment, which has nothing to draw
            lines.append(str(error))
        plain_console().print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)


def print_event(sentence: str) -> None:
    """Print an event of the graph to stderr."""
    sys.stderr.write(f'{sentence}\n')


def print_node_line(node: str, line: str) -> None:
    """Print one output line of a node, prefixed with its name."""
    # Programs that read a pipe get the line as it is
    text = describe_line(line) if sys.stdout.isatty() else line
    sys.stdout.write(f'[{node}] {text}\n')


def print_arguments(chosen: Launch) -> None:
    """Print the arguments of a launch as a table."""
    table = Table('argument', 'default', 'choices', 'meaning', title=chosen.name)
    for item in chosen.list_arguments():
        table.add_row(item.name, item.default, ' '.join(item.choices), item.description)
    plain_console().print(table)
