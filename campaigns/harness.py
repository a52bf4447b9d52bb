# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The harness of all campaigns: arguments, seeds, workers, resuming, table, page, commit and date.

A campaign is a list of kinds, a function that tries one case (a kind and a number) and returns a
row, and a function that makes a table of rows. Rows are stored one by one in `runs/NAME`, in a
file named by a hash of the code, so that an interrupted campaign goes on where it was. `wrong` in
a row says what must not be; a campaign with such a row ends with status 1. The table of a whole
campaign goes into its page between two marks, with `--write`.
"""

from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
import ast
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from datetime import date
import hashlib
from importlib import import_module
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
import traceback
from typing import Any, Final, NamedTuple
import uuid

from lta_bag.provenance import read_commit
from rich.progress import track

from campaigns import ROOT

HERE: Final = Path(__file__).resolve().parent
STALLED: Final = 0.25  # s: a sleeper woken so much later; commands are stale after 0.3 s
TRIES: Final = 3  # of a trial in which the machine stood still
MARK: Final = 'LTA_TRIAL'  # variable by which the processes of a trial are found
Row = dict[str, Any]


class Case(NamedTuple):
    """A kind, and a number that decides the rest."""

    kind: str
    number: int


Rows = Mapping[Case, Row]


@dataclass(frozen=True)
class Campaign:
    """
    What a campaign is made of.

    Attributes
    ----------
    list_kinds : callable
        Return the kinds that are tried by default, for the parsed arguments.
    run : callable
        Try a case, and return its row: JSON data.
    list_table : callable
        Yield the lines of the table, of all rows and the arguments.
    each : int
        Cases of each kind by default.
    add_arguments : callable
        Add what this campaign takes beside the common arguments.
    page : str
        Page of docs/ that has the table between two marks; '' for none.
    hidden : tuple of str
        Kinds that are tried only where they are asked for.
    alone : bool
        Whether each case has a process of its own.
    side : int
        Cases side by side by default; 0 for one a core.
    patience : float
        Time after which a case in a process of its own hangs. [s]
    prepare : callable
        Do what all cases need, once.
    smoke : str or None
        Arguments of a run of seconds; None where only the parts can be tested.

    """

    list_kinds: Callable[[Namespace], Sequence[str]]
    run: Callable[[Case, Namespace], Row]
    list_table: Callable[[Rows, Namespace], Iterator[str]]
    each: int = 1
    add_arguments: Callable[[ArgumentParser], object] = lambda parser: None
    page: str = ''
    hidden: tuple[str, ...] = ()
    alone: bool = False
    side: int = 1
    patience: float = 36_000.0
    prepare: Callable[[Namespace], object] = lambda options: None
    smoke: str | None = None


def list_campaigns() -> dict[str, str]:
    """Return the first line of the text of each campaign, by its name."""
    texts = {path.stem: path.read_text(encoding='utf-8') for path in sorted(HERE.glob('*.py'))}
    return {
        name: (ast.get_docstring(ast.parse(text)) or '').splitlines()[0]
        for name, text in texts.items()
        if '\nCAMPAIGN: Final = ' in text
    }


def load_campaign(name: str) -> Campaign:
    """Return a campaign."""
    campaign: Campaign = import_module(f'campaigns.{name}').CAMPAIGN
    return campaign


def build_parser(name: str) -> ArgumentParser:
    """Return the parser of a campaign's arguments."""
    campaign, about = load_campaign(name), sys.modules[f'campaigns.{name}'].__doc__
    parser = ArgumentParser(f'make campaign {name}', description=about,
                            formatter_class=RawDescriptionHelpFormatter)  # fmt: skip
    add = parser.add_argument
    add('--kinds', nargs='*', help='only these kinds')
    add('--each', type=int, default=campaign.each, help='cases of each kind')
    add('--first', type=int, default=0, help='number of the first case of each kind')
    add('--seed', type=int, default=1, help='random seed')
    add('--side', type=int, default=campaign.side or os.cpu_count() or 1, help='side by side')
    add('--out', type=Path, default=ROOT / 'runs' / name, help='folder of the rows')
    add('--again', action='store_true', help='try once more what was not as required')
    add('--write', action='store_true', help='write the page, if all kinds are tried')
    add('--trial', nargs=2, metavar=('KIND', 'NUMBER'), help='try one case, and print its row')
    campaign.add_arguments(parser)
    return parser


def run_campaign(name: str, words: Sequence[str]) -> int:
    """Run a campaign; return 1 where anything is not as it must be."""
    campaign, parser = load_campaign(name), build_parser(name)
    options = parser.parse_args(words)
    if options.trial:
        kind, number = options.trial
        sys.stdout.write(json.dumps(try_here(campaign, Case(kind, int(number)), options)) + '\n')
        return 0
    every = list(campaign.list_kinds(options))
    kinds = options.kinds or every
    if unknown := set(kinds) - {*every, *campaign.hidden}:
        parser.error(f'no kind {sorted(unknown)[0]!r}; known: {", ".join(every)}')
    options.out.mkdir(parents=True, exist_ok=True)
    campaign.prepare(options)
    cases = take_turns(kinds, options.first, options.each)
    path = options.out / f'{hash_code()}-{options.seed}.jsonl'
    if options.again:
        forget_wrong(path)
    words = [word for word in words if word not in ('--again', '--write')]

    def run(case: Case) -> Row:
        if not campaign.alone:
            return try_here(campaign, case, options)
        return try_patiently(name, case, words, campaign.patience)

    rows = collect_rows(cases, path, options.side, run)
    lines = [*campaign.list_table(rows, options), '', describe_origin(rows)]
    wrong = [f'- {case.kind} {case.number}: {row["wrong"]}'.replace('\n', ' ')
             for case, row in rows.items() if row.get('wrong')]  # fmt: skip
    lines += ['', 'Not as required:', '', *wrong] if wrong else []
    sys.stdout.write('\n'.join(lines) + f'\nRows: {path}\n')
    if options.write and campaign.page and set(kinds) >= set(every) and len(rows) == len(cases):
        write_part(ROOT / 'docs' / campaign.page, name, lines)
    return int(bool(wrong))


def take_turns(kinds: Sequence[str], first: int, each: int) -> list[Case]:
    """Return all cases, so ordered that what has been tried at any time is of every sort."""
    return [
        Case(kind, first + (turn + place) % each)
        for turn in range(each)
        for place, kind in enumerate(kinds)
    ]


def hash_code() -> str:
    """Return a hash of the code and settings that decide the outcomes."""
    digest = hashlib.sha256()
    for path in sorted(
        path
        for folder in ('src', 'config', 'campaigns', 'firmware')
        for pattern in ('*.py', '*.yaml', '*.xml', '*.c', '*.h')
        for path in (ROOT / folder).rglob(pattern)
    ):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def try_here(campaign: Campaign, case: Case, options: Namespace) -> Row:
    """Return the row of a case; one that breaks is wrong."""
    try:
        return campaign.run(case, options)
    except Exception as error:
        traceback.print_exc()
        return {'wrong': f'{type(error).__name__}: {error}'}


def try_patiently(name: str, case: Case, words: Sequence[str], patience: float) -> Row:
    """
    Return the row of a case in a process of its own, with how often it was repeated.

    A time that was missed while the machine stood still for `STALLED` tells nothing of what is
    tried: it is done again, `TRIES` times at most, and the last one counts whatever it is.
    """
    for again in range(TRIES):
        row = {**try_alone(name, case, words, patience), 'again': again}
        if not (row.get('wrong') and row.get('timing') and row.get('late', 0.0) > STALLED):
            break
    return row


def try_alone(name: str, case: Case, words: Sequence[str], patience: float) -> Row:
    """Return the row of a case in a process of its own, of which nothing is left."""
    command = [sys.executable, '-m', 'campaigns', name, *words, '--trial', case.kind]
    mark = uuid.uuid4().hex
    # Under pytest, the packages are on the path of this process alone
    places = {'PYTHONPATH': os.pathsep.join(sys.path)}
    try:
        done = subprocess.run(
            [*command, str(case.number)], cwd=ROOT, capture_output=True, text=True,
            timeout=patience, env=os.environ | places | {MARK: mark},
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return {'wrong': 'it hung'}
    finally:
        kill_marked(f'{MARK}={mark}')
    try:
        row: Row = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        return {'wrong': f'it broke: {done.stderr[-300:]}'}
    return row


def kill_marked(mark: str) -> None:
    """Kill each process that carries a mark in its environment."""
    for folder in Path('/proc').glob('[0-9]*'):
        with suppress(OSError):
            if mark.encode() in (folder / 'environ').read_bytes().split(b'\0'):
                os.kill(int(folder.name), signal.SIGKILL)


def read_rows(path: Path) -> dict[Case, Row]:
    """Return the rows of a file."""
    lines = path.read_text(encoding='utf-8').splitlines() if path.exists() else ()
    return {Case(*row.pop('case')): row for row in map(json.loads, lines)}


def forget_wrong(path: Path) -> None:
    """Take what was not as required out of what has been tried."""
    lines = [json.dumps({'case': case, **row}) + '\n'
             for case, row in read_rows(path).items() if not row.get('wrong')]  # fmt: skip
    path.write_text(''.join(lines), encoding='utf-8')


def collect_rows(
    cases: Sequence[Case], path: Path, side: int, run: Callable[[Case], Row]
) -> dict[Case, Row]:
    """Try what has not been tried, so many side by side; return what there is, in order."""
    rows, origin = read_rows(path), {'commit': read_commit(), 'date': date.today().isoformat()}
    with path.open('a', encoding='utf-8') as file, ThreadPoolExecutor(side) as pool:
        futures = {pool.submit(run, case): case for case in cases if case not in rows}
        silent = not sys.stderr.isatty()
        try:
            for future in track(as_completed(futures), path.parent.name, len(futures),
                                disable=silent):  # fmt: skip
                case = futures[future]
                rows[case] = future.result() | origin
                file.write(json.dumps({'case': case, **rows[case]}) + '\n')
                file.flush()
                if silent:
                    words = rows[case].get('wrong') or 'done'
                    sys.stderr.write(f'{case.kind} {case.number}: {words}\n')
        except KeyboardInterrupt:  # the rest another time
            pool.shutdown(wait=False, cancel_futures=True)
    return {case: rows[case] for case in cases if case in rows}


def describe_origin(rows: Rows) -> str:
    """Return how many cases of which code and date there are, and how busy the machine was."""
    counts = Counter(
        f'commit {row["commit"][:12]}{" with changes" * row["commit"].endswith("-dirty")}, '
        f'{row["date"]}'
        for row in rows.values()
    )
    text = 'Cases: ' + '; '.join(f'{count} of {words}' for words, count in counts.items()) + '.'
    lateness = [row['late'] for row in rows.values() if 'late' in row]
    if lateness:
        text += f' The machine woke a sleeper {max(lateness):.2f} s too late at most.'
    if again := sum(row.get('again', 0) for row in rows.values()):
        text += f' Repeated, as the machine had stood still: {again}.'
    return text


def count_right(rows: Sequence[Row]) -> str:
    """Return how many of some cases ended as required: '3 of 4'; '' of none."""
    return f'{sum(not row["wrong"] for row in rows)} of {len(rows)}' if rows else ''


def write_part(page: Path, name: str, lines: Sequence[str]) -> None:
    """
    Replace what a page has between the marks of a campaign.

    Raises
    ------
    ValueError
        If the page does not have the marks.

    """
    mark = f'<!-- written by make campaign {name} -->'
    before, _, after = page.read_text(encoding='utf-8').split(mark)
    text = '\n'.join(lines).strip('\n')
    page.write_text(f'{before}{mark}\n\n{text}\n\n{mark}{after}', encoding='utf-8')
