# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One fault in a graph that flies: done, named, watched until it is over."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
import math
from pathlib import Path
from random import Random
import re
from threading import Event
import time
from typing import Any, Final

from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
from peer import Peer
from std_srvs.srv import SetBool

from campaigns.chaos_graph import alive, Graph, inputs, NODES, TABLE
from campaigns.chaos_kinds import KINDS, limit
from campaigns.fault_kinds import LANDS
from campaigns.graph_trial import SLACK

NAMED: Final = 1.0  # s of wall time until a fault is named
HEARD: Final = 4.0  # s after which it never will be
STANDS: Final = 1.0  # s without a motor turning after which they stand
GOES_ON: Final = 1.0  # s that a flight must go on after its cure
ENDS: Final = 15.0  # s from what ends a flight to its end


class Strike:
    """
    One fault.

    Parameters
    ----------
    name : str
        Of `KINDS`.
    random : Random
        Decides whom it strikes.
    graph : Graph
        What it strikes, in flight.
    peer : Peer
        A node beside it.

    Attributes
    ----------
    target, struck, since, lasts, cure, may_end, stated
        What a kind may set: what it struck, when [s], since when words count where that is sooner
        [s], for how long it lasts [s], how it is taken away, whether the flight may end by it, and
        when motors must stand [s].
    word, phase, told, said, took, found
        What came of it: the words that it must be named by, the phase in which it struck, until it
        was named in /diagnostics and on the terminal [s], for how long motors turned [s], and
        what must not be, each with whether that is a matter of time.

    """

    def __init__(self, name: str, random: Random, graph: Graph, peer: Peer) -> None:
        self.kind = KINDS[name]
        self.random, self.graph, self.peer = random, graph, peer
        self.target, self.lasts, self.stated = '', 0.0, 0.0
        self.may_end, self.struck, self.since = self.kind.ends, 0.0, 0.0
        self.cure: Callable[[], object] = lambda: None
        self.stack = ExitStack()
        self.word, self.phase = '', graph.phase
        self.told: float | None = None
        self.said: float | None = None
        self.took: float | None = None
        self.found: list[tuple[str, bool]] = []
        self._turned = -math.inf

    @property
    def disk(self) -> Path:
        """Where the results of the flight are."""
        return self.graph.bag.parents[1]

    # What a kind may do.

    def pick(self) -> str:
        """Choose a node."""
        self.target = self.random.choice(NODES[self.graph.way])
        return self.target

    def pick_topic(self) -> str:
        """Choose an input that somebody of the graph publishes."""
        known = self.peer.node.count_publishers
        spoken = [name for name in inputs(self.graph.way) if known(name)]
        self.target = self.random.choice(spoken)
        return self.target

    def wrong(self, what: str, timing: bool = False) -> None:
        """Take down what must not be."""
        self.found.append((what, timing))

    def publish(self, name: str, message: Any, seconds: float, every: float = 0.05) -> None:
        """Publish a message again and again, as soon as somebody has found us."""
        row = TABLE[name]
        quality = select_profile(row, self.graph.way == 'lockstep')
        publisher = self.peer.node.create_publisher(find_message_type(row), name, quality)
        self.stack.callback(self.peer.node.destroy_publisher, publisher)
        self.peer.until(publisher.get_subscription_count)
        self.struck, over = time.monotonic(), Event()

        def speak() -> None:  # in a thread: what is told meanwhile must be heard when it comes
            while not over.wait(every):
                publisher.publish(message)

        with ThreadPoolExecutor(1) as aside:
            aside.submit(speak)
            try:
                self._for(seconds)
            finally:
                over.set()

    # What becomes of it.

    def run(self, last: bool = True) -> None:
        """Strike, and watch until it is over; after the last one, motors are asked to stand."""
        with self.stack:
            self.struck = time.monotonic()
            self.word = self.kind.strike(self)
            self._watch_motors()
            if self.word:
                self._wait_for_names()
            self.took = self._watched(last)

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

    def _wait_for_names(self) -> None:
        """Take down how long it takes to be named in /diagnostics and on the terminal."""
        until = self.struck + HEARD
        named = lambda first: first(self.word, self.since or self.struck)  # noqa: E731
        found = self.graph.first_told, self.graph.first_said
        self._until(lambda: time.monotonic() > until or all(map(named, found)))
        self.told, self.said = map(self._after, map(named, found))
        for where, took in (('in /diagnostics', self.told), ('on the terminal', self.said)):
            if took is None:
                self.wrong(f"'{self.word}' was not named {where}", timing=True)
            elif took > NAMED:
                self.wrong(f'named {where} after {took:.2f} s', timing=True)

    def _after(self, when: float | None) -> float | None:
        return None if when is None else max(0.0, when - self.struck)

    def _watched(self, last: bool) -> float | None:
        """Wait for the end or for the cure; return how long motors turned, where they may not."""
        graph = self.graph
        self._until(lambda: not graph.alive or time.monotonic() > self.struck + self.lasts)
        self.cure()
        if self.kind.ends or (self.may_end and not graph.alive):
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
        if not last or not graph.hardware or not graph.alive:
            return None
        asked = time.monotonic()
        self.stated = LANDS[0]
        self.peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)
        return self._stood(asked)

    def _goes_on(self) -> None:
        """Take down which nodes are gone, and whether flight time stands still."""
        graph, expected = self.graph, NODES[self.graph.way]
        gone = lambda: sorted(set(expected) - set(alive(graph, expected)))  # noqa: E731
        if gone():  # its flight is over, or a node has died: whoever started it is about to say
            until = time.monotonic() + HEARD
            self._until(lambda: not graph.alive or time.monotonic() > until)
        if not graph.alive:
            if died := re.search('.* (was killed by|ended with status) .*', graph.started.text):
                self.wrong(died.group())
            elif graph.way == 'lockstep':  # which has no end of its own
                self.wrong('the flight ended')
            return
        if gone():
            self.wrong(f'{", ".join(gone())} ended')
        elif graph.way != 'hardware':
            before, until = graph.flown, time.monotonic() + HEARD
            self._until(lambda: graph.flown > before or time.monotonic() > until)
            if graph.flown <= before and graph.alive:
                self.wrong('the flight stands still', timing=True)

    def _stood(self, since: float) -> float:
        """Wait until motors stand, and return for how long they turned [s]."""
        self._turned = max(self._turned, since)
        self._until(lambda: time.monotonic() > self._turned + STANDS)
        took, stated = self._turned - since, limit(self)
        if took > stated:
            self.wrong(
                f'motors turned for {took:.2f} s, stated {stated - SLACK:.1f} s', timing=True
            )
        return took
