"""
Count the hops of one step of each node: a measure of how hard its path is to follow.

A lockstep flight runs over DDS. After some seconds of flight every node records the project's
functions that its next steps call. The table shows the median step: how many files it enters, how
many calls it makes, how often a call is in another file than the call before, and how many of
these changes go back to a file that was already left.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
import json
import os
from pathlib import Path
import sys
import tempfile
from typing import NamedTuple

from hops_hook.sitecustomize import START
from lta_flight.flight import FlightRequest, fly_once

ROOT = Path(__file__).parents[2]
HOOK = Path(__file__).with_name('hops_hook')
BEGIN = 8.0  # s of flight, when the climb is over and every node is busy


class Hops(NamedTuple):
    """The hops of one step."""

    files: int
    calls: int
    changes: int
    returns: int


def count_hops(calls: Sequence[str]) -> Hops:
    """Return the hops of a step from its calls, each `file:function`, in their order."""
    path = [call.rpartition(':')[0] for call in calls]
    changes = [file for before, file in pairwise(path) if file != before]
    left, returns = set(path[:1]), 0
    for file in changes:
        returns += file in left
        left.add(file)
    return Hops(len(left), len(path), len(changes), returns)


class HopsObserver:
    """Start the count in every process of the flight once the drone flies."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._begun = False

    def show_position(self, time: float, distance: float, pace: float) -> None:
        """Start the count after some seconds of flight."""
        if time > BEGIN and not self._begun:
            self._begun = True
            for process in _find_processes(self._folder):
                os.kill(process, START)

    def show_message(self, sentence: str) -> None:
        """Pass a message on."""
        sys.stderr.write(sentence + '\n')


def _find_processes(folder: str) -> Iterator[int]:
    """Yield the other processes that have the folder in their environment."""
    entry = f'LTA_HOPS={folder}'.encode()
    for path in Path('/proc').glob('[0-9]*/environ'):
        process = int(path.parent.name)
        try:
            if process != os.getpid() and entry in path.read_bytes().split(b'\0'):
                yield process
        except OSError:  # another user's, or ended meanwhile
            continue


def measure_hops() -> dict[str, tuple[Hops, list[str]]]:
    """Fly once, and return the hops and the calls of the median step of each node."""
    with tempfile.TemporaryDirectory() as folder:
        source = (str(path.resolve()) for path in (ROOT / 'src', ROOT / 'config'))
        path = f'{HOOK}{os.pathsep}{os.environ.get("PYTHONPATH", "")}'
        os.environ.update(LTA_HOPS=folder, LTA_HOPS_ROOTS=os.pathsep.join(source), PYTHONPATH=path)
        order = FlightRequest('gtmab', 'lamp_room', 'bag', 1, 'lockstep', Path(folder) / 'flight')
        fly_once(order, HopsObserver(folder))
        found = {}
        for file in sorted(Path(folder).glob('*.json')):
            steps = sorted(json.loads(file.read_text()), key=len)
            calls = steps[len(steps) // 2]
            found[file.stem] = count_hops(calls), calls
    return found


def main() -> None:
    """Print the table; with the name of a node, also its calls."""
    found = measure_hops()

    def write(line: str) -> None:
        sys.stdout.write(line + '\n')

    write(f'{"node":16}{"files":>7}{"calls":>7}{"changes":>9}{"returns":>9}')
    for node, (hops, _) in found.items():
        write(f'{node:16}{hops.files:7}{hops.calls:7}{hops.changes:9}{hops.returns:9}')
    for node in sys.argv[1:]:
        write(f'\n{node}')
        for call in found[node][1]:
            write(f'    {call.removeprefix(f"{ROOT}/")}')


if __name__ == '__main__':
    main()
