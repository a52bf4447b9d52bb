"""Measure the graph, the recorder in it, and what a person waits for: whole commands."""

from contextlib import suppress
from functools import partial
from operator import itemgetter
import os
from pathlib import Path
import resource
import statistics
import subprocess
import tempfile
import time
from typing import Any

from lta_flight.flight import fly_once

from campaigns import ROOT
from campaigns.bench import Figure

COMMANDS = {
    'help': (('--help',), '`lta --help`'),
    'simulate': (('simulate',), '`lta simulate`, a flight of 21 s with bag and page'),
    'fly_one': (('fly', '--processes', 'one'), '`lta fly --processes one`, the same flight'),
    'fly': (('fly',), '`lta fly`, the same in seven processes'),
}
START = 6.0  # s of a flight in which nodes start


class ProcessorObserver:
    """
    Watches what the nodes of a flight spend, once a second.

    Parameters
    ----------
    node : str
        Whose processes count; '' for all of them.

    Attributes
    ----------
    samples : list of tuple
        Wall time and processor time. [s]

    """

    def __init__(self, node: str = '') -> None:
        self._node = f'__node:={node}' if node else ''
        self.samples: list[tuple[float, float]] = []

    def show_position(self, time_s: float, distance: float, pace: float) -> None:
        """Take a sample."""
        now = time.monotonic()
        if not self.samples or now - self.samples[-1][0] > 1.0:
            self.samples.append((now, measure_children(self._node)))

    def show_message(self, sentence: str) -> None:
        """Do nothing."""

    def wait_for(self, what: str) -> None:
        """Do nothing."""

    @property
    def share(self) -> float:
        """Processor time a wall second, once the nodes have started. [s/s]"""
        begun = self.samples[0][0] + START
        after = [sample for sample in self.samples if sample[0] > begun]
        # Nodes that have ended are no children any more
        first, last = after[0], max(after, key=itemgetter(1))
        return (last[1] - first[1]) / (last[0] - first[0])


def measure_children(word: str) -> float:
    """Return the processor time of our running children with a word in their command. [s]"""
    ticks = 0
    for file in Path('/proc').glob('[0-9]*/stat'):
        with suppress(OSError):  # it has ended
            fields = file.read_text().rpartition(') ')[2].split()
            line = (file.parent / 'cmdline').read_bytes()
            if int(fields[1]) == os.getpid() and word.encode() in line:
                ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf('SC_CLK_TCK')


def fly(processes: Any, clock: Any = 'lockstep', node: str = '') -> tuple[float, float]:
    """Return the pace of a flight, and the processor time of its nodes a wall second. [s/s]"""
    watcher = ProcessorObserver(node)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / 'flight'
        scene = ('gtmab', 'lamp_room', 'bag', 1)
        pace = fly_once(*scene, watcher, time=clock, processes=processes, out=out).pace
    return pace, watcher.share if clock == 'realtime' else 0.0


def list_graph() -> list[Figure]:
    """Return the figures of the graph."""
    median = statistics.median
    return [
        Figure('graph.realtime', 's/s', lambda: fly('many')[0],
               'a whole flight of the graph in lockstep, seven processes', median),
        Figure('graph.one_process', 's/s', lambda: fly('one')[0],
               'the same flight with `processes:=one`', median),
        Figure('graph.share', 's/s', lambda: fly('one', 'realtime')[1],
               'processor time of this process in real time: all nodes, simulator and recorder',
               min),
    ]  # fmt: skip


def list_recorder() -> list[Figure]:
    """Return the figure of the recorder."""
    return [
        Figure('recorder.realtime', '% of a core',
               lambda: 100.0 * fly('many', 'realtime', 'recorder')[1],
               'the recorder in a real-time flight, all topics', min),
    ]  # fmt: skip


def run_command(words: tuple[str, ...], cache: str = '') -> float:
    """Run a command in an empty folder; return the processor time of all its processes. [s]"""
    environment = os.environ | ({'XDG_CACHE_HOME': cache} if cache else {})
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([ROOT / 'lta', *words], cwd=folder, env=environment, check=True,
                       capture_output=True)  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_cold() -> float:
    """Return the processor time of a flight with an empty cache. [s]"""
    with tempfile.TemporaryDirectory() as cache:
        return run_command(COMMANDS['simulate'][0], cache)


def list_command() -> list[Figure]:
    """Return the figures of commands, by processor time."""
    return [
        *(Figure(f'command.{name}', 's', partial(run_command, words), about, min)
          for name, (words, about) in COMMANDS.items()),
        Figure('command.simulate_cold', 's', run_cold, '`lta simulate` with an empty cache', min),
    ]  # fmt: skip
