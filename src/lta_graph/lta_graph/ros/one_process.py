# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run the nodes of a launch file in one process."""

from collections.abc import MutableMapping, Sequence
from contextlib import ExitStack
from functools import partial
from importlib import import_module
from importlib.metadata import distribution, PackageNotFoundError
import os
from pathlib import Path
import sys
from tempfile import TemporaryDirectory
from typing import Final

from lta_config.errors import BadInput
from lta_config.files import share_folder
from lta_graph.launch_plan import LaunchProcess, parse_arguments
from lta_graph.launches import find_launch
from lta_graph.reach import PROFILE_VARIABLE
from lta_graph.ros.node import GraphNode
from lta_graph.ros.process import asks_for_help, NodeStart, run_nodes, run_process

DELIVERY: Final = 'intraprocess_delivery'  # element of a profile of Fast DDS
USAGE = """Usage: ros2 run lta_graph one_process FILE [NAME:=VALUE] ...

Run the nodes of a launch file that share a process, such as one_process fly seed:=2. The arguments
are those of the launch file: ros2 launch lta_bringup fly.launch.py --show-args.
"""


def main() -> None:
    """Run the nodes of a launch file that share a process, or say how to."""
    if asks_for_help(sys.argv):
        sys.stdout.write(USAGE)
        sys.exit(0)
    run_process(partial(run_launch_file, sys.argv))


def run_launch_file(words: Sequence[str], teardown: ExitStack) -> int:
    """
    Run the nodes of a launch file as `run_nodes` does.

    `words`: program, launch file and its arguments. `teardown`: as for `run_nodes`. Raise
    `BadInput` if there is no such file, or it starts no node that can share a process.
    """
    program, *arguments = words
    if not arguments:
        raise BadInput('Give a launch file, such as fly, and its arguments as NAME:=VALUE.')
    launch = find_launch(arguments[0])
    plan = launch.build_plan({**parse_arguments(arguments[1:]), 'processes': 'one'})
    shared = [process for process in plan.processes if process.shared]
    if not shared:
        raise BadInput(f'{launch.name} starts no node that can share a process; use lta launch.')
    deliver_in_memory(os.environ, teardown)
    return run_nodes(list(map(describe_start, shared)), [program], teardown)


def describe_start(process: LaunchProcess) -> NodeStart:
    """Return how to create the node that a process of its own would run."""
    words = list(process.arguments)

    def create() -> GraphNode:
        node_class = load_node_class(process)
        return node_class(cli_args=words, use_global_arguments=False)  # type: ignore[call-arg]

    return NodeStart(
        create,
        [process.executable, *words],
        process.name,
        process.on_exit_shutdown,
        process.planned,
    )


def load_node_class(process: LaunchProcess) -> type[GraphNode]:
    """
    Return the class of a node from the package and the executable that would start it.

    Raise `BadInput` if it is not a node of LTA.
    """
    try:
        points = distribution(process.package).entry_points
        (point,) = points.select(group='console_scripts', name=process.executable)
        module = import_module(point.module)
        (node_class,) = [
            item
            for item in vars(module).values()
            if isinstance(item, type)
            and issubclass(item, GraphNode)
            and item.__module__ == module.__name__
        ]
    except (PackageNotFoundError, ValueError):
        raise BadInput(
            f'{process.package}/{process.executable} is not a node of LTA that can share a '
            'process; remove processes:=one.'
        ) from None
    return node_class


def deliver_in_memory(environment: MutableMapping[str, str], teardown: ExitStack) -> None:
    """
    Let Fast DDS hand messages over within this process, which our profiles switch off.

    There, one of several participants of a process may wait for ever for another. All nodes here
    have one participant. A profile of the user's stays as it is. `teardown` removes the file.
    """
    profile = Path(environment.get(PROFILE_VARIABLE, ''))
    if not profile.is_file() or profile.resolve() not in list_own_profiles():
        return
    # Of the same name, by which `describe_reach` knows it
    folder = Path(teardown.enter_context(TemporaryDirectory(prefix='lta-')))
    text = profile.read_text(encoding='utf-8')
    copy = folder / profile.name
    copy.write_text(text.replace(f'<{DELIVERY}>OFF<', f'<{DELIVERY}>FULL<'), encoding='utf-8')
    environment[PROFILE_VARIABLE] = str(copy)


def list_own_profiles() -> list[Path]:
    """Return the files with our settings of Fast DDS."""
    return [path.resolve() for path in (share_folder() / 'fastdds').glob('*.xml')]
