"""
Several faults in one graph: `python test/score/chaos_together.py WAY NUMBER`, and what is wrong.

One after the other, each over before the next: the last one may end the flight. How long it takes
until a fault is named, or motors stand, is what `make chaos` measures, on a machine with nothing
else to do; here they only have to.
"""

from collections.abc import Sequence
from dataclasses import asdict
import json
from pathlib import Path
from random import Random
import sys
from typing import Final

from chaos_graph import Graph
import chaos_strike
from chaos_strike import Strike
from chaos_trial import judged
from outcome import Outcome, tried
from peer import Peer
from waiting import PATIENCE

BEGUN: Final = 1.0  # s of flight
# An error that keeps coming back within ten seconds is only counted: no two that sound alike.
TOGETHER: Final = {
    'lockstep': ('message nan', 'flood', 'parameter', 'killed'),
    'realtime': ('clock', 'message lengths', 'message names', 'exception'),
    'hardware': ('light', 'message future', 'slow disk', 'radio'),
}


def together(way: str, number: int, folder: Path, peer: Peer) -> Outcome:
    """Fly, strike again and again, and look at what is left."""
    wrong: list[tuple[str, bool]] = []
    strikes: list[Strike] = []
    with Graph(way, folder, peer, folder / 'out' / 'bag') as graph:
        graph.fly(BEGUN)
        for kind in TOGETHER[way]:
            strikes.append(Strike(kind, Random(f'{kind} {number}'), graph, peer))
            strikes[-1].run(last=kind == TOGETHER[way][-1])
            wrong += named(strikes[-1])
        wrong += [(what, False) for what in judged(graph, strikes)]
    return Outcome(
        wrong='; '.join(what for what, _ in wrong),
        timing=bool(wrong) and all(timing for _, timing in wrong),
    )


def named(strike: Strike) -> Sequence[tuple[str, bool]]:
    """Return what was wrong after a strike, with what was struck."""
    about = f'{strike.kind.about}, {strike.target}'
    return [(f'{about}: {what}', timing) for what, timing in strike.found]


if __name__ == '__main__':
    way, number = sys.argv[1], int(sys.argv[2])
    for time in ('NAMED', 'HEARD', 'ENDS'):
        setattr(chaos_strike, time, PATIENCE)
    chaos_strike.limit = lambda _: PATIENCE
    outcome = tried(lambda folder, peer: together(way, number, folder, peer), Outcome)
    sys.stdout.write(json.dumps(asdict(outcome)) + '\n')
