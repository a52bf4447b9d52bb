"""
Several faults in one graph: `python test/score/chaos_together.py WAY KIND...`, and what is wrong.

One after the other, each over before the next, so only those that a flight survives.
"""

import json
from pathlib import Path
from random import Random
import sys

from chaos_graph import Graph
from chaos_strike import Strike
from chaos_trial import judged
from outcome import Outcome, tried
from peer import Peer

BEGUN = 1.0  # s of flight


def together(way: str, kinds: list[str], folder: Path, peer: Peer) -> Outcome:
    """Fly, strike again and again, and look at what is left."""
    wrong: list[str] = []
    strikes: list[Strike] = []
    with Graph(way, folder, peer, folder / 'out' / 'bag') as graph:
        graph.fly(BEGUN)
        for kind in kinds:
            strikes.append(Strike(kind, Random(f'{kind} together'), graph, peer))
            strikes[-1].run()
            wrong += [f'{kind}, {strikes[-1].target}: {what}' for what, _ in strikes[-1].found]
        wrong += judged(graph, strikes)
    return Outcome(wrong='; '.join(wrong))


if __name__ == '__main__':
    way, *kinds = sys.argv[1:]
    outcome = tried(lambda folder, peer: together(way, kinds, folder, peer), Outcome)
    sys.stdout.write(json.dumps({'wrong': outcome.wrong, 'late': outcome.late}) + '\n')
