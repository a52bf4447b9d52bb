"""Six faults in flight, side by side: what `make faults` does with every kind, many times."""

import json
from pathlib import Path
import subprocess
import sys

import pytest

TRIAL = Path(__file__).resolve().parents[1] / 'score/fault_trial.py'
CASES = [
    ('silent', 0),
    ('dumb', 1),
    ('killed', 1),
    ('ended', 0),
    ('hung', 0),
    ('rises', 0),
]  # even by duties, odd by setpoints
PATIENCE = 240.0  # s; half a minute where nobody else works


@pytest.mark.long
def test_the_motors_stand_and_the_bag_tells_why():
    flights = [
        subprocess.Popen(
            [sys.executable, TRIAL, kind, str(number)], stdout=subprocess.PIPE, text=True
        )
        for kind, number in CASES
    ]
    try:
        told = [flight.communicate(timeout=PATIENCE)[0] for flight in flights]
    finally:
        for flight in flights:
            flight.kill()
            flight.wait()
            flight.stdout.close()
    outcomes = [json.loads(lines.splitlines()[-1]) for lines in told]
    assert [outcome['wrong'] for outcome in outcomes] == [''] * len(CASES), outcomes
