"""
A campaign: many trials, each in a process of its own, its row kept as it comes.

What was stopped goes on where it was, while what decides the outcomes stays the same (`version`);
each row says of which code it is.
A trial is a script called with a kind and a number that prints its outcome as JSON (`outcome.py`).
"""

import argparse
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import as_completed, ThreadPoolExecutor
from contextlib import suppress
import hashlib
from importlib.util import find_spec
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
from typing import Any, Final, NamedTuple
import uuid

from lta_bridge.provenance import read_commit
from rich.progress import track
from slow_clock import get_factor

STALLED: Final = 0.25  # s: a sleeper woken so much later; commands are stale after 0.3 s
TRIES: Final = 3
HANGS: Final = 'it hung'
MARK: Final = 'LTA_TRIAL'
ROOT: Final = Path(__file__).resolve().parents[2]
FLIES: Final = (
    'lta_config', 'lta_graph', 'lta_model', 'lta_vlc', 'lta_energy', 'lta_sim', 'lta_control',
    'lta_bridge', 'lta_emulation',
)  # fmt: skip
SETTINGS: Final = ('control', 'crazyflies', 'scenarios', 'vehicles')
Row = dict[str, Any]


class Case(NamedTuple):
    """A kind, and a number that decides the rest."""

    kind: str
    number: int


class StoredCampaign(NamedTuple):
    """What the repository keeps of a campaign: facts, such as the firmware's commit, and rows."""

    facts: dict[str, Any]
    rows: dict[Case, Row]


def store(path: Path, stored: StoredCampaign) -> StoredCampaign:
    """Write a campaign, a row in a line and numbers to 4 decimals; return what it then holds."""
    rows = [
        json.dumps({'case': case, **{name: shorten(value) for name, value in row.items()}})
        for case, row in stored.rows.items()
    ]
    text = ',\n'.join(rows)
    path.write_text(f'{{"facts": {json.dumps(stored.facts)}, "rows": [\n{text}\n]}}\n')
    return read_stored(path)


def shorten(value: Any) -> Any:
    """Round a float."""
    return round(value, 4) if isinstance(value, float) else value


def read_stored(path: Path) -> StoredCampaign:
    found = json.loads(path.read_text())
    rows = {Case(*row.pop('case')): row for row in found['rows']}
    return StoredCampaign(found['facts'], rows)


def describe_lateness(rows: Iterable[Row]) -> str:
    """Return how late the machine woke a sleeper, and by how much time was slowed down."""
    whole = [row for row in rows if 'late' in row]  # those that hung have none
    if not whole:
        return ''
    late, slower = max(row['late'] for row in whole), {row['slower'] for row in whole}
    how = f' Time passed {min(slower)} times more slowly' if slower != {1} else ''
    if how and len(slower) > 1:
        how = f' Time passed {min(slower)} to {max(slower)} times more slowly'
    how += ' for all processes (`--slower`).' if how else ''
    return f'The machine had other work; it woke a sleeper {late:.2f} s too late at most.{how}'


def count_flights(rows: dict[Case, Row]) -> str:
    """Return how many flights of how many kinds there are, in words."""
    of_each = Counter(case.kind for case in rows)
    least, most = min(of_each.values()), max(of_each.values())
    each = f'{least} of each' if least == most else f'{least} to {most} of each'
    return f'{len(rows)} flights of {len(of_each)} kinds, {each}'


def list_flown_files() -> list[Path]:
    """Return the code and the settings of every package that flies: they decide the outcomes."""
    return [
        path
        for package in FLIES
        for path in Path(find_spec(package).submodule_search_locations[0]).rglob('*.py')
    ] + [path for folder in SETTINGS for path in (ROOT / 'config' / folder).rglob('*.yaml')]


def version(paths: Iterable[Path]) -> str:
    """Return a hash of the files that decide the outcomes."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def asked(about: str, kinds: Sequence[str], each: int, out: Path) -> argparse.Namespace:
    """Return what the command line asks for; the folder for the rows is there."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument('--each', type=int, default=each, help='trials of each kind')
    parser.add_argument('--side', type=int, default=os.cpu_count() or 1, help='side by side')
    parser.add_argument('--kinds', nargs='*', default=kinds, choices=kinds)
    parser.add_argument('--slower', type=int, default=1, help='let time pass so much more slowly')
    parser.add_argument('--out', type=Path, default=out)
    told = parser.parse_args()
    told.out.mkdir(parents=True, exist_ok=True)
    return told


def turn_about(kinds: Sequence[str], each: int) -> list[Case]:
    """Return all cases, so ordered that what has been tried at any time is of every sort."""
    return [
        Case(kind, (turn + place) % each)
        for turn in range(each)
        for place, kind in enumerate(kinds)
    ]


def tried(case: Case, script: Path, patience: float) -> Row:
    """
    Return the outcome of one trial, with how often the machine had it done again.

    A time that was missed, or another word that was said, while the machine stood still for
    `STALLED` tells nothing of what is tried: it is done again, `TRIES` times at most, and the last
    one counts whatever it is. Whatever else is wrong is never done again.
    """
    for again in range(TRIES):
        row = tried_once(case, script, patience)
        row['again'] = again
        if not (row['wrong'] and row.get('timing') and row['late'] > STALLED):
            break
    return row


def tried_once(case: Case, script: Path, patience: float) -> Row:
    """Return the outcome of one trial, in a process of its own."""
    words = [sys.executable, str(script), case.kind, str(case.number)]
    mark = f'{MARK}={uuid.uuid4().hex}'
    name, _, value = mark.partition('=')
    variables = os.environ | {name: value}
    try:
        done = subprocess.run(
            words,
            capture_output=True,
            text=True,
            timeout=patience * get_factor(),
            env=variables,
        )
    except subprocess.TimeoutExpired:
        return {'wrong': HANGS, 'took': None, 'timing': False}
    finally:
        put_away(mark)
    try:
        row: Row = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        return {'wrong': f'it broke: {done.stderr[-300:]}', 'took': None}
    return row


def put_away(mark: str) -> None:
    """Kill what a trial has left: whatever carries its mark in the environment."""
    for folder in Path('/proc').glob('[0-9]*'):
        with suppress(OSError):
            if mark.encode() in (folder / 'environ').read_bytes().split(b'\0'):
                os.kill(int(folder.name), signal.SIGKILL)


def kept(path: Path) -> dict[Case, Row]:
    """Return what has been tried already."""
    found: dict[Case, Row] = {}
    for line in path.read_text(encoding='utf-8').splitlines() if path.exists() else ():
        row = json.loads(line)
        found[Case(*row.pop('case'))] = row
    return found


def campaign(
    cases: Sequence[Case], path: Path, side: int, trial: Callable[[Case], Row]
) -> dict[Case, Row]:
    """Try what has not been tried, so many side by side; return what there is, in order."""
    done, commit = kept(path), read_commit()
    with path.open('a', encoding='utf-8') as file, ThreadPoolExecutor(side) as pool:
        flying = {pool.submit(trial, case): case for case in cases if case not in done}
        seen = sys.stderr.isatty()
        watched = track(as_completed(flying), 'flying', len(flying), disable=not seen)
        try:
            for future in watched:
                case = flying[future]
                done[case] = {
                    **future.result(),
                    'slower': get_factor(),
                    'code': path.stem,
                    'commit': commit,
                }
                file.write(json.dumps({'case': case, **done[case]}) + '\n')
                file.flush()
        except KeyboardInterrupt:  # the rest another time
            pool.shutdown(wait=False, cancel_futures=True)
    return {case: done[case] for case in cases if case in done}


def codes(outcomes: dict[Case, Row]) -> str:
    """Return which code each trial was of, and how many hung; rows of another may be beside."""
    counted = Counter(
        f'code {row["code"]}'
        # A branch may be rebased: the hash of the code then still says what flew
        + (f' at commit {shorten_commit(row["commit"])}' if 'commit' in row else '')
        for row in outcomes.values()
    )
    parts = [f'{count} of {code}' for code, count in counted.items()]
    hung = sum(row['wrong'] == HANGS for row in outcomes.values())
    return ', '.join(parts + [f'{hung} hung'] * bool(hung))


def shorten_commit(commit: str) -> str:
    """Return the first digits of a commit, and whether code had changed since."""
    return commit[:12] + ' with changes' * commit.endswith('-dirty')


def told(lines: Sequence[str], path: Path, outcomes: dict[Case, Row]) -> int:
    """Print a table and what is wrong; return 1 where anything is."""
    sys.stdout.write('\n'.join(lines) + f'\nrows in {path}\n')
    wrong = {case: row['wrong'] for case, row in outcomes.items() if row['wrong']}
    for case, why in wrong.items():
        sys.stdout.write(f'{case.kind} {case.number}: {why}\n')
    return int(bool(wrong))
