"""
Fail or interrupt `lta launch` and `lta fly` at random moments, and count what they print.

At most three lines and no traceback each, whatever the machine is busy with:
`.venv/bin/python test/score/early_ends.py --runs 200`, half an hour; no program may use the graph
meanwhile.
"""

import argparse
from collections import Counter
import os
from pathlib import Path
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = Path(__file__).resolve().parents[2]
LINES = 3  # at most
LATEST = 8.0  # s after the start
PATIENCE = 120.0  # s to end in
# What fails by itself, and what is interrupted
FAILING = (
    ('launch', 'fly', 'bag:=full'),
    ('launch', 'fly', 'source:=replay', 'replay:=/nowhere'),
    ('launch', 'fly', 'live:=true', 'live_port:=BUSY'),
    ('launch', 'fly', 'vehicle:=nothing'),
    ('launch', 'fleet', 'bag:=full'),
    ('launch', 'fly', 'strategy:=./full/kept.py'),
)
RUNNING = (
    ('launch', 'fly', 'time:=realtime'),
    ('launch', 'fly', 'time:=lockstep', 'bag:=own'),
    ('launch', 'fleet'),
    ('fly', '--out', 'own'),
)
SIGNALS = (signal.SIGINT, signal.SIGINT, signal.SIGTERM)


def end_early(words: tuple[str, ...], moment: float, number: int, folder: Path) -> str:
    """Start a command, send it and its children a signal after a moment, return what it said."""
    said = folder / 'said'
    with said.open('w') as file:
        child = subprocess.Popen(
            [ROOT / 'lta', *words], cwd=folder, stdout=file, stderr=file, start_new_session=True
        )
        try:
            child.wait(moment)
        except subprocess.TimeoutExpired:
            # As a terminal does: to the whole group, if it is Ctrl-C
            if number == signal.SIGINT:
                os.killpg(child.pid, number)
            else:
                child.send_signal(number)
        try:
            child.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            return 'did not end'
    return said.read_text(errors='replace')


def find_fault(said: str, folder: Path) -> str:
    """Return what is wrong with an end, or ''."""
    if 'Traceback' in said:
        return 'traceback'
    if len(said.splitlines()) > LINES:
        return f'{len(said.splitlines())} lines'
    if said == 'did not end':
        return said
    # A recording that was begun is whole
    bags = [path for path in folder.rglob('bag') if path.is_dir()]
    return (
        '' if all((bag / 'metadata.yaml').exists() for bag in bags) else 'a bag without metadata'
    )


def main() -> int:
    """Run the campaign and print its counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--runs', type=int, default=200)
    parser.add_argument('--seed', type=int, default=1)
    order = parser.parse_args()
    # A job in the background of a shell ignores Ctrl-C, and so would the commands
    signal.signal(signal.SIGINT, signal.default_int_handler)
    draw, faults, kinds = random.Random(order.seed), [], Counter[str]()
    with socket.socket() as held:
        held.bind(('127.0.0.1', 0))
        held.listen()
        busy = str(held.getsockname()[1])
        for run in range(1, order.runs + 1):
            words = draw.choice(FAILING if run % 4 == 0 else RUNNING)
            moment, number = draw.uniform(0.0, LATEST), draw.choice(SIGNALS)
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                (folder / 'full').mkdir()
                (folder / 'full' / 'kept').touch()
                begun = time.monotonic()
                words = tuple(word.replace('BUSY', busy) for word in words)
                said = end_early(words, moment, number, folder)
                fault = find_fault(said, folder)
            kinds[' '.join(words[:2])] += 1
            if fault:
                faults.append(fault)
                sent = f'after {moment:.2f} s, signal {number:d}'
                sys.stdout.write(f'{" ".join(words)} {sent}: {fault}\n{said}\n')
            if run % 10 == 0 or run == order.runs:
                took = time.monotonic() - begun
                sys.stdout.write(f'{run} runs, {len(faults)} faults; the last took {took:.1f} s\n')
                sys.stdout.flush()
    sys.stdout.write(f'{dict(kinds)}\n')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
