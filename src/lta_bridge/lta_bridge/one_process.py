"""
Run the nodes of a launch file in one process.

`one_process FILE NAME:=VALUE ...`: as `lta launch FILE processes:=one NAME:=VALUE ...`, without
supervision, for a drone's own computer.
"""

from contextlib import ExitStack
import sys

from lta_bridge.cdr import encode_cdr
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_graph.launch_file import load_plan, parse_arguments
from lta_graph.ros.process import run_process
from lta_graph.ros.shared_process import run_nodes

PROCESSES = 'processes'


def main() -> None:
    """Run the nodes that share a process until one of them or a signal ends the run."""
    run_process(lambda teardown: run_launch_file(sys.argv, teardown))


def run_launch_file(words: list[str], teardown: ExitStack) -> int:
    """
    Run the nodes of a launch file that share a process, and return the exit status.

    Raises
    ------
    BadInput
        If there is no such file, or it starts no node that can share a process.

    """
    program, *given = words
    if not given:
        raise BadInput('Give a launch file, such as fly, and its arguments as NAME:=VALUE.')
    path = find_file('launch file', given[0], '.launch.yaml')
    plan = load_plan(path, {**parse_arguments(given[1:]), PROCESSES: 'one'})
    shared = [process for process in plan.processes if process.shared]
    if not shared:
        raise BadInput(f'{path} starts no node that can share a process; use lta launch.')
    return run_nodes(shared, encode_cdr, program, teardown)
