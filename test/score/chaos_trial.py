"""
One fault in one whole graph: `python test/score/chaos_trial.py KIND NUMBER` prints its outcome.

The number decides how the graph is started, the moment, and whom it strikes. In the built
workspace (tools/workspace.sh).
"""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import asdict, dataclass
import json
import math
from pathlib import Path
from random import Random
import re
import subprocess
import sys
import time
from typing import Any, Final

from chaos_graph import alive, Graph, NODES, TABLE
from chaos_kinds import inputs, KINDS, limit, mounted
from fault_kinds import LANDS, SLACK
from lta_analysis.bag.reader import read_bag
from lta_config.errors import BadInput
from lta_graph.ros.node import message_type
from lta_graph.ros.qos import profile
from outcome import Outcome, tried
from peer import Peer
from std_srvs.srv import SetBool

NAMED: Final = 1.0  # s of wall time until a fault is named
HEARD: Final = 4.0  # s after which it never will be
LATEST: Final = {'lockstep': 12.0, 'realtime': 12.0, 'hardware': 10.0}  # s of flight
STANDS: Final = 1.0  # s without a motor turning after which they stand
GOES_ON: Final = 1.0  # s that a flight must go on after its cure
ENDS: Final = 15.0  # s from what ends a flight to its end


@dataclass(frozen=True, slots=True)
class Struck(Outcome):
    """
    What became of a graph.

    Attributes
    ----------
    way, target : str
        How it was started, and what was struck.
    told, said : float
        Until it was named in /diagnostics and on the terminal. [s]

    """

    way: str = ''
    target: str = ''
    told: float | None = None
    said: float | None = None


class Trial:
    """
    A graph and what strikes it.

    Attributes
    ----------
    target, struck, lasts, cure, may_end, stated
        What a strike may set: what it struck, when [s], for how long [s], how it is taken away,
        whether the flight may end by it, and when motors must stand [s].

    """

    def __init__(self, name: str, number: int, folder: Path, peer: Peer) -> None:
        self._kind = KINDS[name]
        self.random, self.peer = Random(f'{name} {number}'), peer
        self._way = self._kind.ways[number % len(self._kind.ways)]
        self.target, self.lasts, self.stated = '', 0.0, 0.0
        self.may_end, self.struck = self._kind.ends, 0.0
        self.cure: Callable[[], object] = lambda: None
        self._wrong: list[tuple[str, bool]] = []
        self.stack = ExitStack()
        self.disk = folder / 'disk'
        bag = (self.disk if name == 'full disk' else folder) / 'out' / 'bag'
        if name == 'full disk':
            assert mounted(self.disk), 'a small disk needs root'
            self.stack.callback(subprocess.run, ['umount', '-l', self.disk])
        self.graph = Graph(self._way, folder, peer, bag)
        self._turned = -math.inf

    # What a strike may do.

    def pick(self) -> str:
        """Choose a node."""
        self.target = self.random.choice(NODES[self._way])
        return self.target

    def pick_topic(self) -> str:
        """Choose an input."""
        self.target = self.random.choice(inputs(self._way))
        return self.target

    def wrong(self, what: str, timing: bool = False) -> None:
        """Take down what must not be."""
        self._wrong.append((what, timing))

    def publish(self, name: str, message: Any, seconds: float, every: float = 0.05) -> None:
        """Publish a message again and again, as soon as somebody has found us."""
        row = TABLE[name]
        quality = profile(row, self._way == 'lockstep')
        publisher = self.peer.node.create_publisher(message_type(row), name, quality)
        self.stack.callback(self.peer.node.destroy_publisher, publisher)
        self.peer.until(publisher.get_subscription_count)
        self.struck = began = time.monotonic()
        while time.monotonic() < began + seconds:
            publisher.publish(message)
            self._for(every)

    # The trial.

    def run(self) -> Struck:
        """Fly, strike, watch, and look at what is left."""
        with self.stack, self.graph as graph:
            graph.listen([name for name in inputs(self._way) if TABLE[name].qos != 'sensor'])
            graph.fly(self.random.uniform(0.5, LATEST[self._way]))
            phase = graph.phase
            self.struck = time.monotonic()
            word = self._kind.strike(self)
            self._watch_motors()
            told, said = self._named(word) if word else (None, None)
            took = self._watched()
            status = graph.end()
            self._judge(word, status)
            wrong = '; '.join(what for what, _ in self._wrong)
            timing = bool(wrong) and all(timing for _, timing in self._wrong)
            return Struck(
                took, limit(self) if took is not None else None, not self.may_end, phase,
                wrong, timing, 0.0, self._way, self.target, told, said,
            )  # fmt: skip

    def _for(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        self._until(lambda: time.monotonic() >= until)

    def _until(self, condition: Callable[[], object]) -> None:
        """Watch the motors until something holds."""

        def done() -> object:
            self._watch_motors()
            return condition()

        self.peer.until(done)

    def _watch_motors(self) -> None:
        if self.graph.turning():
            self._turned = time.monotonic()

    def _named(self, word: str) -> tuple[float | None, float | None]:
        """Return how long it took to be named in /diagnostics and on the terminal."""
        found = self.graph.first_told, self.graph.first_said
        until = self.struck + HEARD
        self._until(lambda: time.monotonic() > until or all(f(word, self.struck) for f in found))
        told, said = (None if (when := f(word, self.struck)) is None else when - self.struck
                      for f in found)  # fmt: skip
        for where, took in (('in /diagnostics', told), ('on the terminal', said)):
            if took is None:
                self.wrong(f"'{word}' was not named {where}", timing=True)
            elif took > NAMED:
                self.wrong(f'named {where} after {took:.2f} s', timing=True)
        return told, said

    def _watched(self) -> float | None:
        """Wait for the end or for the cure; return how long motors turned, where there are any."""
        graph = self.graph
        self._until(lambda: not graph.alive or time.monotonic() > self.struck + self.lasts)
        self.cure()
        if self._kind.ends or (self.may_end and not graph.alive):
            until = self.struck + self.lasts + ENDS
            self._until(lambda: not graph.alive or time.monotonic() > until)
            if graph.alive:
                self.wrong('the flight did not end', timing=True)
            return self._stood(self.struck) if graph.hardware else None
        if self.stated:
            return self._stood(self.struck)
        self._for(GOES_ON)
        if not self.may_end:
            self._goes_on()
        if not graph.hardware or not graph.alive:
            return None
        asked = time.monotonic()
        self.stated = LANDS[0]
        self.peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)
        return self._stood(asked)

    def _goes_on(self) -> None:
        """Take down which nodes are gone, and whether flight time stands still."""
        expected = NODES[self._way]
        running = alive(self.graph, expected)
        over = self._way != 'hardware' and not self.graph.alive
        if over and self.graph.started.popen.returncode == 0:
            return
        if gone := sorted(set(expected) - set(running)):
            self.wrong(f'{", ".join(gone)} ended')
        elif self._way != 'hardware':
            before = self.graph.flown
            until = time.monotonic() + HEARD
            self._until(lambda: self.graph.flown > before or time.monotonic() > until)
            if self.graph.flown <= before and self.graph.alive:
                self.wrong('the flight stands still', timing=True)

    def _stood(self, since: float) -> float:
        """Wait until motors stand, and return for how long they turned. [s]"""
        self._turned = max(self._turned, since)
        self._until(lambda: time.monotonic() > self._turned + STANDS)
        took, stated = self._turned - since, limit(self)
        if took > stated:
            self.wrong(
                f'motors turned for {took:.2f} s, stated {stated - SLACK:.1f} s', timing=True
            )
        return took

    def _judge(self, word: str, status: int) -> None:
        """Look at the end, at what is left and into the bag."""
        if self._kind.ends and status not in (1, 2):
            self.wrong(f'the status is {status}')
        text = self.graph.started.text
        if 'Traceback' in text and not self._kind.ends:
            self.wrong(f'a traceback: {text[text.index("Traceback") :][:400]}')
        if left := self.graph.left():
            self.wrong(left)
        try:
            bag = read_bag(self.graph.bag)
        except BadInput as error:
            self.wrong(f'the bag does not open: {error}')
            return
        torn = self.target == 'recorder' and self._kind.ends
        if not (bag.complete or torn):
            self.wrong('the bag is not whole')
        if word and not torn and self._kind.about != 'a full disk':
            said = evidence(bag)
            if not any(re.search(word, text) for text in said):
                self.wrong(f"the bag says nowhere '{word}'")
        self._judge_motors(bag)

    def _judge_motors(self, bag: Any) -> None:
        """Look for commands that no motor must get."""
        if self.target in ('motors', 'second graph'):
            return
        for topic, _, data in bag.messages(['/lta1/motors']):
            effort = bag.decode(topic, data).effort
            if not all(-1.0 <= duty <= 1.0 for duty in effort):
                self.wrong(f'duties {list(effort)} were commanded')
                return


def evidence(bag: Any) -> set[str]:
    """Return all errors that a bag holds."""
    arrays = (bag.decode(topic, data) for topic, _, data in bag.messages(['/diagnostics']))
    return {
        f'{status.name}: {status.message}'
        for array in arrays
        for status in array.status
        if status.level in (2, b'\x02')
    }


if __name__ == '__main__':
    kind, number = sys.argv[1], int(sys.argv[2])
    outcome = tried(lambda folder, peer: Trial(kind, number, folder, peer).run(), Struck)
    sys.stdout.write(json.dumps(asdict(outcome)) + '\n')
