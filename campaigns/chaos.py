# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Inject faults into whole graphs.

A graph is started as a user starts it: in lockstep, in real time, or in real time with emulated
hardware. In a random phase of its flight comes one fault of `chaos_kinds.py`, in a random node,
topic or parameter. The kinds `together ...` have several faults one after another, as the test
does.
"""

from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from random import Random
import re
import subprocess
from typing import Any, Final

from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from peer import Peer
from waiting import PATIENCE

from campaigns import chaos_strike
from campaigns.chaos_graph import Graph
from campaigns.chaos_kinds import KINDS, mount_small_disk
from campaigns.chaos_strike import Strike
from campaigns.graph_trial import Outcome, try_flight
from campaigns.harness import Campaign, Case, count_right, Row, Rows

LATEST: Final = {'lockstep': 8.0, 'realtime': 12.0, 'hardware': 10.0}  # s of flight
BEGUN: Final = 1.0  # s of flight before the first of several faults
# An error that keeps coming back within ten seconds is only counted: no two that sound alike.
TOGETHER: Final = {
    'lockstep': ('message nan', 'flood', 'parameter', 'killed'),
    'realtime': ('clock', 'message lengths', 'message names', 'exception'),
    'hardware': ('light', 'message future', 'slow disk', 'radio'),
}
WAYS: Final = {
    'lockstep': 'lockstep', 'realtime': 'real time', 'hardware': 'emulated hardware',
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class GraphOutcome(Outcome):
    """What became of a graph."""

    # How it was started, and what was struck
    way: str = ''
    target: str = ''
    # Until it was named in /diagnostics and on the terminal [s]
    told: float | None = None
    said: float | None = None


def fly_one(name: str, number: int, folder: Path, peer: Peer) -> GraphOutcome:
    """Fly, strike once, watch, and look at what is left."""
    kind, random = KINDS[name], Random(f'{name} {number}')
    way = kind.ways[number % len(kind.ways)]
    with ExitStack() as stack:
        if name == 'full disk':
            folder = folder / 'disk'
            assert mount_small_disk(folder), 'a small disk needs root'
            stack.callback(subprocess.run, ['umount', '-l', folder])
        graph = stack.enter_context(Graph(way, folder, peer, folder / 'out' / 'bag'))
        graph.fly(random.uniform(0.5, min(LATEST[way], kind.latest)))
        strike = Strike(name, random, graph, peer)
        strike.run()
        wrong = [*strike.found, *((what, False) for what in judge_end(graph, [strike]))]
        return GraphOutcome(
            strike.took, not strike.may_end, strike.phase, '; '.join(what for what, _ in wrong),
            bool(wrong) and all(timing for _, timing in wrong),
            way, strike.target, strike.told, strike.said,
        )  # fmt: skip


def fly_several(way: str, number: int, folder: Path, peer: Peer) -> GraphOutcome:
    """
    Fly, strike again and again, and look at what is left.

    Each fault is over before the next; the last one may end the flight. How long it takes until a
    fault is named, or motors stand, is measured one by one, on a machine with nothing else to do.
    """
    for limit in ('NAMED', 'HEARD', 'ENDS'):
        setattr(chaos_strike, limit, PATIENCE)
    chaos_strike.limit = lambda _: PATIENCE
    wrong: list[tuple[str, bool]] = []
    strikes: list[Strike] = []
    with Graph(way, folder, peer, folder / 'out' / 'bag') as graph:
        graph.fly(BEGUN)
        for kind in TOGETHER[way]:
            strike = Strike(kind, Random(f'{kind} {number}'), graph, peer)
            strikes.append(strike)
            strike.run(last=kind == TOGETHER[way][-1])
            about = f'{strike.kind.about}, {strike.target}'
            wrong += [(f'{about}: {what}', timing) for what, timing in strike.found]
        wrong += [(what, False) for what in judge_end(graph, strikes)]
    timing = bool(wrong) and all(timing for _, timing in wrong)
    return GraphOutcome(wrong='; '.join(what for what, _ in wrong), timing=timing, way=way)


def judge_end(graph: Graph, strikes: list[Strike]) -> list[str]:
    """End a graph, and return what is wrong with its end, what it leaves and its bag."""
    status, wrong = graph.end(), []
    ends = any(strike.kind.ends for strike in strikes)
    if ends and status not in (1, 2):
        wrong.append(f'the status is {status}')
    text = graph.started.text
    if 'Traceback' in text and not ends:
        wrong.append(f'a traceback: {text[text.index("Traceback") :][:2000]}')
    if left := graph.left():
        wrong.append(left)
    try:
        bag = read_bag(graph.bag)
    except BadInput as error:
        return [*wrong, f'the bag does not open: {error}']
    if ends and any(strike.target == 'recorder' for strike in strikes):
        return wrong  # and the bag is torn
    if not bag.is_complete:
        wrong.append('the bag is not whole')
    errors = list_errors(bag)
    words = [strike.word for strike in strikes if strike.word]
    missing = [word for word in words if not any(re.search(word, text) for text in errors)]
    wrong += [f"the bag says nowhere '{word}'" for word in missing]
    if not any(strike.target in ('motors', 'second graph') for strike in strikes):
        wrong += list_impossible_duties(bag)[:1]
    return wrong


def list_impossible_duties(bag: Any) -> list[str]:
    """Return the commands that no motor must get."""
    commands = (
        bag.decode(topic, data) for topic, _, data in bag.iterate_messages(['/lta1/motors'])
    )
    return [
        f'duties {list(command.duty)} were commanded'
        for command in commands
        if not all(-1.0 <= duty <= 1.0 for duty in command.duty)
    ]


def list_errors(bag: Any) -> set[str]:
    """Return all errors that a bag holds."""
    arrays = (bag.decode(topic, data) for topic, _, data in bag.iterate_messages(['/diagnostics']))
    return {
        f'{status.name}: {status.message}'
        for array in arrays
        for status in array.status
        if status.level in (2, b'\x02')
    }


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a trial."""
    kind, _, way = case.kind.partition('together ')
    if way:
        return try_flight(lambda folder, peer: fly_several(way, case.number, folder, peer))
    return try_flight(lambda folder, peer: fly_one(kind, case.number, folder, peer))


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the table: the longest times of each kind, and how many were as stated."""
    yield (
        '| fault | trials | the flight then | in /diagnostics after | on the terminal after | '
        f'motors turned for | as stated: {" | ".join(WAYS.values())} |'
    )
    yield '|---' * (6 + len(WAYS)) + '|'
    for name, kind in KINDS.items():
        some = [row for case, row in rows.items() if case.kind == name]
        if some:
            then = 'shuts down in order' if kind.ends else 'continues'
            times = (format_longest(some, column) for column in ('told', 'said', 'took'))
            by_way = (count_right([row for row in some if row.get('way') == way]) for way in WAYS)
            cells = (kind.about, str(len(some)), then, *times, *by_way)
            yield f'| {" | ".join(cells)} |'


def format_longest(rows: Sequence[Row], name: str) -> str:
    """Return the longest of some times, in words."""
    times = [row[name] for row in rows if row.get(name) is not None]
    return f'{max(times):.2f} s' if times else ''


CAMPAIGN: Final = Campaign(
    lambda options: list(KINDS), run, list_table, each=12, page='reliability.md', alone=True,
    side=0, patience=240.0, hidden=tuple(f'together {way}' for way in TOGETHER),
)  # fmt: skip
