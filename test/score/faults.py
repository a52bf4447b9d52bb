"""
Faults in flight: `make faults` (some hours), or `make faults ARGS='--each 2 --side 4'`.

Each kind of `fault_kinds.py` so many times, at a random moment, side by side, each flight in a
process of its own (`fault_trial.py`). A row is kept as it comes, so that a campaign that was
stopped goes on where it was, while bridge and kinds stay the same. Writes docs/hardware_faults.md.
"""

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed, ThreadPoolExecutor
import hashlib
import json
import os
from pathlib import Path
import subprocess
import sys
from typing import Any, Final, NamedTuple

from fault_kinds import Kind, KINDS, SLACK
import lta_bridge
from rich.progress import track

HERE: Final = Path(__file__).resolve().parent
PAGE: Final = HERE.parents[1] / 'docs/hardware_faults.md'
HUNG: Final = 240.0  # s after which a flight hangs
EACH: Final = 20
HEAD: Final = (
    '# Faults in flight\n\n'
    '`make faults` wrote this page: each fault at random moments of flights, by '
    'turns by duties (GT-MAB) and by setpoints (the multirotor), on an emulated Crazyflie under '
    'the real bridge and recorder, over UDP and DDS in real time.\nA pilot climbs, cruises and '
    'descends by turns and knows of nothing. The time is from the fault, or from the request to '
    'disarm where the flight is to go on, to motors that stand.\nStated first, then the longest '
    'that was seen; {slack:.0f} s more counts as stated, for a machine with other work. In every '
    "flight the bag must open whole and hold the\nbridge's own word of the fault, and every "
    'process must end.\n\n'
    '| fault | what becomes of the flight | by duties | by setpoints | as stated |\n'
    '|---|---|---|---|---|\n'
)


NO_TIME: Final = {False: 'no motor turns', True: 'not flown'}


class Case(NamedTuple):
    """A kind, and a number that decides moment and way to command."""

    kind: str
    number: int


def version() -> str:
    """Return a hash of what decides the outcomes: bridge, emulator and kinds."""
    paths = [*Path(lta_bridge.__file__).parent.rglob('*.py'), *HERE.glob('fault*.py')]
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def flown(case: Case) -> dict[str, Any]:
    """Return the outcome of one flight, in a process of its own."""
    words = [sys.executable, str(HERE / 'fault_trial.py'), case.kind, str(case.number)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=HUNG)
    except subprocess.TimeoutExpired:
        return {'wrong': 'it hung', 'took': None}
    try:
        row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        return {'wrong': f'it broke: {done.stderr[-300:]}', 'took': None}
    return row


def kept(path: Path) -> dict[Case, dict[str, Any]]:
    """Return what has been flown already."""
    found: dict[Case, dict[str, Any]] = {}
    for line in path.read_text(encoding='utf-8').splitlines() if path.exists() else ():
        row = json.loads(line)
        found[Case(*row.pop('case'))] = row
    return found


def campaign(cases: Sequence[Case], path: Path, side: int) -> dict[Case, dict[str, Any]]:
    """Fly what has not been flown, so many side by side."""
    done = kept(path)
    with path.open('a', encoding='utf-8') as file, ThreadPoolExecutor(side) as pool:
        flying = {pool.submit(flown, case): case for case in cases if case not in done}
        watched = track(as_completed(flying), 'flying', len(flying), disable=not _seen())
        try:
            for future in watched:
                case = flying[future]
                done[case] = future.result()
                file.write(json.dumps({'case': case, **done[case]}) + '\n')
                file.flush()
        except KeyboardInterrupt:  # the rest another time
            pool.shutdown(wait=False, cancel_futures=True)
    return {case: done[case] for case in cases if case in done}


def _seen() -> bool:
    return sys.stderr.isatty()


def rows(outcomes: dict[Case, dict[str, Any]]) -> Iterator[str]:
    """Yield the lines of the table."""
    for name, kind in KINDS.items():
        found = {case: row for case, row in outcomes.items() if case.kind == name}
        if not found:
            continue
        times = [
            [
                row['took']
                for case, row in found.items()
                if case.number % 2 == way and row['took'] is not None
            ]
            for way in range(2)
        ]
        told = [
            f'{stated:.1f} s; {max(seen):.1f} s' if stated and seen else NO_TIME[bool(stated)]
            for stated, seen in zip(kind.stated, times, strict=True)
        ]
        well = sum(not row['wrong'] for row in found.values())
        yield f'| {kind.about} | {fate(kind)} | {told[0]} | {told[1]} | {well} of {len(found)} |'


def paged(outcomes: dict[Case, dict[str, Any]]) -> str:
    """Return the page: the table, and each flight that was not as stated."""
    wrong = [
        f'- {KINDS[case.kind].about}, flight {case.number}: {row["wrong"]}.\n'
        for case, row in outcomes.items()
        if row['wrong']
    ]
    told = '\nNot as stated:\n\n' + ''.join(wrong) if wrong else ''
    return HEAD.format(slack=SLACK) + '\n'.join(rows(outcomes)) + '\n' + told


def fate(kind: Kind) -> str:
    """Return what becomes of a flight, in words."""
    if not any(kind.stated):
        return 'it is never armed'
    return 'flies on, and lands when asked to' if kind.flies_on else kind.ends


def main() -> int:
    """Print the table and write the page; 1 where anything was not as stated."""
    parser = argparse.ArgumentParser(description='Faults in flight.')
    parser.add_argument('--each', type=int, default=EACH, help='flights of each kind')
    parser.add_argument('--side', type=int, default=os.cpu_count() or 1, help='side by side')
    parser.add_argument('--kinds', nargs='*', default=list(KINDS), choices=list(KINDS))
    parser.add_argument('--out', type=Path, default=Path('runs') / 'faults')
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    path = asked.out / f'{version()}.jsonl'
    cases = [  # turn about, so that what has been flown at any time is of both ways to command
        Case(kind, (turn + place) % asked.each)
        for turn in range(asked.each)
        for place, kind in enumerate(asked.kinds)
    ]
    outcomes = campaign(cases, path, asked.side)
    lines = list(rows(outcomes))
    sys.stdout.write('\n'.join(lines) + f'\nrows in {path}\n')
    wrong = {case: row['wrong'] for case, row in outcomes.items() if row['wrong']}
    for case, why in wrong.items():
        sys.stdout.write(f'{case.kind} {case.number}: {why}\n')
    if set(asked.kinds) == set(KINDS):
        PAGE.write_text(paged(outcomes), encoding='utf-8')
    return int(bool(wrong))


if __name__ == '__main__':
    sys.exit(main())
