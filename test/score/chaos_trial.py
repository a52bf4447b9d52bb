"""
One fault in one whole graph: `python test/score/chaos_trial.py KIND NUMBER` prints its outcome.

The number decides how the graph is started, the moment, and whom it strikes. In the built
workspace (tools/workspace.sh).
"""

from contextlib import ExitStack
from dataclasses import asdict, dataclass
import json
from pathlib import Path
from random import Random
import re
import subprocess
import sys
from typing import Any, Final

from chaos_graph import Graph
from chaos_kinds import KINDS, limit, mounted
from chaos_strike import Strike
from lta_config.errors import BadInput
from lta_data.bag.reader import read_bag
from outcome import Outcome, tried
from peer import Peer

LATEST: Final = {'lockstep': 8.0, 'realtime': 12.0, 'hardware': 10.0}  # s of flight


@dataclass(frozen=True, slots=True)
class Struck(Outcome):
    """What became of a graph."""

    # How it was started, and what was struck
    way: str = ''
    target: str = ''
    # Until it was named in /diagnostics and on the terminal [s]
    told: float | None = None
    said: float | None = None


def trial(name: str, number: int, folder: Path, peer: Peer) -> Struck:
    """Fly, strike, watch, and look at what is left."""
    kind, random = KINDS[name], Random(f'{name} {number}')
    way = kind.ways[number % len(kind.ways)]
    with ExitStack() as stack:
        if name == 'full disk':
            folder = folder / 'disk'
            assert mounted(folder), 'a small disk needs root'
            stack.callback(subprocess.run, ['umount', '-l', folder])
        graph = stack.enter_context(Graph(way, folder, peer, folder / 'out' / 'bag'))
        graph.fly(random.uniform(0.5, min(LATEST[way], kind.latest)))
        strike = Strike(name, random, graph, peer)
        strike.run()
        wrong = [*strike.found, *((what, False) for what in judged(graph, [strike]))]
        return Struck(
            strike.took, limit(strike) if strike.took is not None else None, not strike.may_end,
            strike.phase, '; '.join(what for what, _ in wrong),
            bool(wrong) and all(timing for _, timing in wrong),
            0.0, way, strike.target, strike.told, strike.said,
        )  # fmt: skip


def judged(graph: Graph, strikes: list[Strike]) -> list[str]:
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
    torn = ends and any(strike.target == 'recorder' for strike in strikes)
    if torn:
        return wrong
    if not bag.is_complete:
        wrong.append('the bag is not whole')
    said = evidence(bag)
    words = [strike.word for strike in strikes if strike.word]
    missing = [word for word in words if not any(re.search(word, text) for text in said)]
    wrong += [f"the bag says nowhere '{word}'" for word in missing]
    if not any(strike.target in ('motors', 'second graph') for strike in strikes):
        wrong += impossible(bag)
    return wrong


def impossible(bag: Any) -> list[str]:
    """Return the first command that no motor must get."""
    for topic, _, data in bag.iterate_messages(['/lta1/motors']):
        command = bag.decode(topic, data)
        duties = command.duty
        if not all(-1.0 <= duty <= 1.0 for duty in duties):
            return [f'duties {list(duties)} were commanded']
    return []


def evidence(bag: Any) -> set[str]:
    """Return all errors that a bag holds."""
    arrays = (bag.decode(topic, data) for topic, _, data in bag.iterate_messages(['/diagnostics']))
    return {
        f'{status.name}: {status.message}'
        for array in arrays
        for status in array.status
        if status.level in (2, b'\x02')
    }


if __name__ == '__main__':
    kind, number = sys.argv[1], int(sys.argv[2])
    outcome = tried(lambda folder, peer: trial(kind, number, folder, peer), Struck)
    sys.stdout.write(json.dumps(asdict(outcome)) + '\n')
