# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A whole graph that a trial has started as a user does: what is heard of it, what it leaves."""

from collections.abc import Iterator
from contextlib import contextmanager, ExitStack
import fcntl
import os
from pathlib import Path
import re
import tempfile
import time
from typing import Any, Final
from unittest.mock import patch

from command import Lta, processes
from command import NODES as FLIGHT_NODES
from diagnostic_msgs.msg import DiagnosticArray
from lta_config.topics import load_topic_table
from lta_emulation.emulated_hardware import EmulatedHardware, serve_hardware
from lta_graph.ros.message_validation import find_message_type
from peer import Peer
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_srvs.srv import SetBool

from campaigns.graph_trial import READY, write_endless_flight

TABLE: Final = load_topic_table()
ROBOT: Final = 'lta1'
ERROR: Final = 2  # the level of a fault
HOOK: Final = Path(__file__).with_name('chaos_hook')
NODES: Final = {
    'lockstep': FLIGHT_NODES,
    'realtime': FLIGHT_NODES,
    'hardware': ('crazyflie_bridge', 'teensy_bridge', *FLIGHT_NODES[1:]),
}
NEWEST: Final = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
PORTS: Final = (7400, 250)  # of DDS: of domain 0, and from one domain to the next
GRACE: Final = 15.0  # s from Ctrl-C to the end


def inputs(way: str) -> list[str]:
    """Return the topics that nodes of a graph read, by the table."""
    roles = {*NODES[way], 'vehicle'}
    nodes = roles - {'simulator', 'crazyflie_bridge', 'teensy_bridge'}
    return [name for name, row in TABLE.topics.items() if nodes & set(row.subscribers)]


class Graph:
    """
    A graph in flight.

    Parameters
    ----------
    way : str
        Of `NODES`.
    folder : Path
        For the bag and all else.
    peer : Peer
        Hears what is told.
    bag : Path
        Where to record.

    Attributes
    ----------
    told : list of tuple
        When an error was told in /diagnostics [s], and its words.
    facts : dict of str to DiagnosticStatus
        The newest of each task.

    """

    def __init__(self, way: str, folder: Path, peer: Peer, bag: Path) -> None:
        self.way, self.peer, self.bag = way, peer, bag
        self.told: list[tuple[float, str]] = []
        self.facts: dict[str, Any] = {}
        self._newest: dict[str, Any] = {}
        # Of a node that nobody spins: what is not asked for takes nobody's time.
        idle = peer.beside()
        self._ears = {
            name: idle.create_subscription(
                find_message_type(TABLE[name]), name, lambda _: None, NEWEST
            )
            for name in inputs(way)
        }
        self._folder = folder
        self._open = ExitStack()
        self.hardware: EmulatedHardware | None = None
        self.lta = Lta()
        peer.node.create_subscription(DiagnosticArray, '/diagnostics', self._hear, 100)

    def __enter__(self) -> 'Graph':
        """Start."""
        self._bound = bound(int(os.environ['ROS_DOMAIN_ID']))
        self._open.callback(self.lta.kill)
        with patch.dict(os.environ, PYTHONPATH=str(HOOK)):
            self.started = self.lta.start(*self._words())
        return self

    def __exit__(self, *_: object) -> None:
        """Kill what is left."""
        self._open.close()

    def _words(self) -> list[object]:
        if self.way == 'lockstep':
            # On a fast machine one to the lamp would be over before all has happened to it.
            flown = write_endless_flight(self._folder).items()
            what = [word for name, value in flown for word in (f'--{name}', value)]
            return ['fly', '--no-page', '--out', self.bag.parent, *what]
        launch = ['launch', 'fly', f'bag:={self.bag}', 'queue_size:=1.0']
        if self.way == 'realtime':
            return launch
        port = self._folder / 'light_board'
        self.hardware = self._open.enter_context(
            serve_hardware('gtmab', 'lamp_room', 1, light_port=port)
        )
        uri, board = self.hardware.crazyflie.uri, self.hardware.board.port
        return [
            *launch, 'source:=crazyflie', f'uri:={uri}', 'light_board:=true',
            f'light_port:={board}', 'light_patience:=60.0',
        ]  # fmt: skip

    def _hear(self, array: DiagnosticArray) -> None:
        now = time.monotonic()
        for status in array.status:
            if status.hardware_id != ROBOT:
                continue
            self.facts[status.name.rpartition('/')[2]] = status
            if status.level[0] == ERROR:
                self.told.append((now, f'{status.name}: {status.message}'))

    def pattern(self, name: str) -> Any:
        """Return the newest message of a topic, an empty one where nothing has come."""
        kind, handle = find_message_type(TABLE[name]), self._ears[name].handle
        while (taken := handle.take_message(kind, False)) is not None:
            self._newest[name] = taken[0]
        return self._newest.get(name) or kind()

    # How it stands.

    def fly(self, seconds: float) -> None:
        """Wait until it has flown for a while [s of flight]."""
        if self.hardware is None:
            self.peer.until(lambda: self.flown >= seconds or not self.alive)
            return
        self.peer.until(lambda: all(self._said(*each) for each in READY.items()))
        # Again where the drone was not heard for a moment, as a person would.
        self.peer.until(self._armed)
        self.peer.until(self.turning)
        self.rest(seconds)

    def _armed(self) -> bool:
        return bool(self.peer.ask(SetBool, 'crazyflie_bridge/arm', data=True).success)

    def _said(self, task: str, word: str) -> bool:
        return task in self.facts and self.facts[task].message == word

    @property
    def flown(self) -> float:
        """What the simulator says of the time that it has flown [s]."""
        if (fact := self.facts.get('simulator: flight')) is None:
            return -1.0
        return float(next(item.value for item in fact.values if item.key == 'time_s'))

    @property
    def phase(self) -> str:
        """What the navigator is about."""
        fact = self.facts.get('navigator: mission')
        return re.split('[:,]', fact.message)[0] if fact else 'start'

    @property
    def alive(self) -> bool:
        """Whether the command runs."""
        return self.started.popen.poll() is None

    def turning(self) -> bool:
        """Whether a motor of the hardware turns."""
        return self.hardware is not None and any(self.hardware.body.duties)

    def rest(self, seconds: float) -> None:
        """Let time pass."""
        until = time.monotonic() + seconds
        self.peer.until(lambda: time.monotonic() >= until)

    def node(self, name: str) -> int:
        """Return the process id of a node."""
        return self.started.node(name, ROBOT)

    def first_told(self, word: str, since: float) -> float | None:
        """Return when an error with a word was first told in /diagnostics [s]."""
        return next(
            (when for when, text in self.told if when >= since and re.search(word, text)), None
        )

    def first_said(self, word: str, since: float) -> float | None:
        """Return when a line with a word came on the terminal [s]."""
        # A logger writes [lta1.recorder]: where /diagnostics has lta1/recorder:
        lines = [(when, text.replace(']: ', ': ')) for when, text in self.started.lines]
        return next(
            (when for when, text in lines if when >= since and re.search(word, text)), None
        )

    # What is left.

    def end(self) -> int:
        """Press Ctrl-C where it still runs, and return the exit status once it has ended."""
        if self.alive:
            self.started.interrupt()
        until = time.monotonic() + GRACE
        self.peer.until(lambda: not self.alive or time.monotonic() > until)
        return self.started.end()

    def left(self) -> str:
        """Return what is left behind, empty for nothing."""
        if found := self.lta.left():
            return f'{len(found)} processes are left: {found[0][-150:]}'
        domain = os.environ['ROS_DOMAIN_ID']
        folder = Path(os.environ.get('XDG_RUNTIME_DIR') or tempfile.gettempdir())
        lock = folder / f'lta-{os.getuid()}-{domain}.lock'
        if lock.exists():
            with lock.open() as file:
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    return f'{lock} is held'
        strange = sorted(port for port, _ in bound(int(domain)) - self._bound)
        return f'UDP ports {strange} are still bound' if strange else ''


def bound(domain: int) -> set[tuple[int, str]]:
    """Return each bound UDP port of a domain, with its socket's inode."""
    first = PORTS[0] + PORTS[1] * domain
    lines = (line.split() for line in Path('/proc/net/udp').read_text().splitlines()[1:])
    found = {(int(words[1].partition(':')[2], 16), words[9]) for words in lines}
    return {each for each in found if first <= each[0] < first + PORTS[1]}


@contextmanager
def second_graph(graph: Graph) -> Iterator[None]:
    """Fly another graph on the same domain, behind the back of the lock."""
    with tempfile.TemporaryDirectory() as folder:
        with patch.dict(os.environ, XDG_RUNTIME_DIR=folder):
            other = graph.lta.start('launch', 'fly', 'record:=false')
        try:
            yield
        finally:
            if other.popen.poll() is None:
                other.interrupt()
            other.end()


def alive(graph: Graph, nodes: tuple[str, ...]) -> list[str]:
    """Return which of some nodes run."""
    lines = processes(graph.lta.mark).values()
    return [name for name in nodes if any(f'__node:={name} ' in line for line in lines)]
