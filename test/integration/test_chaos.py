"""Twelve faults in whole graphs: what `make chaos` does with every kind, many times."""

import json
from pathlib import Path
import subprocess
import sys

SCORE = Path(__file__).resolve().parents[1] / 'score'
SURVIVED = (
    'stopped', 'clock', 'message nan', 'message lengths', 'message stale', 'flood', 'parameter',
    'slow disk',
)  # fmt: skip
FATAL = (('killed', 0), ('exception', 3), ('memory', 0), ('radio', 0))
PATIENCE = 240.0  # s; half a minute where nobody else works


def outcomes(*commands: tuple[str, ...]) -> list[str]:
    """Run scripts side by side, and return what each calls wrong."""
    running = [
        subprocess.Popen(
            [sys.executable, SCORE / script, *words], stdout=subprocess.PIPE, text=True
        )
        for script, *words in commands
    ]
    try:
        told = [each.communicate(timeout=PATIENCE)[0] for each in running]
    finally:
        for each in running:
            each.kill()
            each.wait()
            each.stdout.close()
    return [json.loads(lines.splitlines()[-1])['wrong'] for lines in told]


def test_what_a_flight_survives_is_named_and_recorded_and_it_goes_on():
    """Eight faults in one graph in real time, one after the other."""
    assert outcomes(('chaos_together.py', 'realtime', *SURVIVED)) == ['']


def test_what_ends_a_flight_is_named_and_leaves_a_bag_and_nothing_else():
    """Four graphs side by side, one of them behind emulated hardware."""
    commands = [('chaos_trial.py', kind, str(number)) for kind, number in FATAL]
    assert outcomes(*commands) == [''] * len(FATAL)
