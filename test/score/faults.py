"""
Faults in flight: `make faults ARGS='--side 4'`, about an hour on two idle cores.

Each kind of `fault_kinds.py` and `light_kinds.py` so many times, at a random moment, side by side,
each flight in a process of its own (`fault_trial.py`, `light_trial.py`). A row is kept as it
comes, so that a campaign that was stopped goes on where it was, while bridge and kinds stay the
same. Writes docs/hardware_faults.md.
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
from light_kinds import AGAIN, LIGHT_KINDS, TOLD
import lta_bridge
from rich.progress import track

HERE: Final = Path(__file__).resolve().parent
PAGE: Final = HERE.parents[1] / 'docs/hardware_faults.md'
HUNG: Final = 240.0  # s after which a flight hangs
EACH: Final = 20
STALLED: Final = 0.25  # s: a sleeper woken so much later; commands are stale after 0.3 s
TRIES: Final = 3
HEAD: Final = (
    '# Faults in flight\n\n'
    '`make faults` wrote this page: each fault at random moments of flights, by '
    'turns by duties (GT-MAB) and by setpoints (the multirotor), on an emulated Crazyflie under '
    'the real bridge and recorder, over UDP and DDS in real time.\nA pilot climbs, cruises and '
    'descends by turns and knows of nothing. The time is from the fault, or from the request to '
    'disarm where the flight is to go on, to motors that stand.\nStated first, then the longest '
    'that was seen; {slack:.0f} s more counts as stated, for a machine with other work. In every '
    "flight the bag must open whole and hold the\nbridge's own word of the fault, and every "
    'process must end.\n\nA time that was missed, or another word that was said, while the '
    'machine woke a sleeper {stalled:.2f} s or more too late says nothing of the bridge: that '
    'flight was flown again,\n{tries} times at most, and the last one counts, whatever became of '
    'it. Nothing else that is wrong is ever flown again. {count} flights of code {code}, of '
    '{wanted} that make {each} of each;\n{again} flown again; in {stalls} of those that count the '
    'machine stood still for so long.\n\n'
    '| fault | what becomes of the flight | by duties | by setpoints | as stated |\n'
    '|---|---|---|---|---|\n'
)
LIGHT_HEAD: Final = (
    '\n## On the link of the light board\n\n'
    'Nothing there turns a motor; a drone without light is brought down by whoever commands it. '
    'No wrong light may be published, the loss must be told within {told:.1f} s and light must '
    'come {again:.0f} s\nafter the cure ({slack:.0f} s more counts as stated), stamps must be '
    "true, and the bridge's own counts of wrong and unknown frames must be those that were sent."
    '\n\n'
    '| fault | what becomes of the light | longest until told | as stated |\n|---|---|---|---|'
)
ALL: Final = (*KINDS, *LIGHT_KINDS)
NO_TIME: Final = {False: 'no motor turns', True: 'not flown'}


class Case(NamedTuple):
    """A kind, and a number that decides moment and way to command."""

    kind: str
    number: int


def version() -> str:
    """Return a hash of what decides the outcomes: bridge, emulator and kinds."""
    paths = [
        *Path(lta_bridge.__file__).parent.rglob('*.py'),
        *HERE.glob('fault_*.py'),
        *HERE.glob('light_*.py'),
    ]
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def flown(case: Case) -> dict[str, Any]:
    """
    Return the outcome of one flight, with how often the machine had it flown again.

    A time that was missed, or another word that was said, while the machine stood still for
    `STALLED` tells nothing of the bridge: the flight is flown again, `TRIES` flights at most, and
    the last one counts whatever it is. Whatever else is wrong is never flown again.
    """
    for again in range(TRIES):
        row = _flown(case)
        row['again'] = again
        if not (row['wrong'] and row.get('timing') and row['late'] > STALLED):
            break
    return row


def _flown(case: Case) -> dict[str, Any]:
    """Return the outcome of one flight, in a process of its own."""
    trial = 'light_trial.py' if case.kind in LIGHT_KINDS else 'fault_trial.py'
    words = [sys.executable, str(HERE / trial), case.kind, str(case.number)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=HUNG)
    except subprocess.TimeoutExpired:
        return {'wrong': 'it hung', 'took': None, 'timing': False}
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


def light_rows(outcomes: dict[Case, dict[str, Any]]) -> Iterator[str]:
    """Yield the lines of the table of the light link."""
    for name, kind in LIGHT_KINDS.items():
        found = [row for case, row in outcomes.items() if case.kind == name]
        if not found:
            continue
        times = [row['took'] for row in found if row['took'] is not None]
        longest = f'{max(times):.1f} s' if times and kind.word else ''
        becomes = 'told, and back once cured' if kind.word else 'goes on'
        well = sum(not row['wrong'] for row in found)
        yield f'| {kind.about} | {becomes} | {longest} | {well} of {len(found)} |'


def about(name: str) -> str:
    """Return a kind in words."""
    return (KINDS[name] if name in KINDS else LIGHT_KINDS[name]).about


def paged(outcomes: dict[Case, dict[str, Any]]) -> str:
    """Return the page: the table, and each flight that was not as stated."""
    wrong = [
        f'- {about(case.kind)}, flight {case.number}: {row["wrong"]}.\n'
        for case, row in outcomes.items()
        if row['wrong']
    ]
    told = '\nNot as stated:\n\n' + ''.join(wrong) if wrong else ''
    head = HEAD.format(
        slack=SLACK,
        stalled=STALLED,
        tries=TRIES - 1,
        count=len(outcomes),
        code=version(),
        wanted=EACH * len(ALL),
        each=EACH,
        again=sum(row['again'] for row in outcomes.values()),
        stalls=sum(row.get('late', 0.0) > STALLED for row in outcomes.values()),
    )
    light = LIGHT_HEAD.format(told=TOLD, again=AGAIN, slack=SLACK)
    lines = [*rows(outcomes), light, *light_rows(outcomes), told]
    return head + '\n'.join(lines).rstrip('\n') + '\n'


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
    parser.add_argument('--kinds', nargs='*', default=ALL, choices=ALL)
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
    lines = [*rows(outcomes), *light_rows(outcomes)]
    sys.stdout.write('\n'.join(lines) + f'\nrows in {path}\n')
    wrong = {case: row['wrong'] for case, row in outcomes.items() if row['wrong']}
    for case, why in wrong.items():
        sys.stdout.write(f'{case.kind} {case.number}: {why}\n')
    if set(asked.kinds) == set(ALL):
        PAGE.write_text(paged(outcomes), encoding='utf-8')
    return int(bool(wrong))


if __name__ == '__main__':
    sys.exit(main())
