# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Show that a change of structure changed no result: `make same`.

Three tables in test/same/frozen hold hashes of simulated flights, numbers of quick commands and
what discovery finds in 20 cases. `make same` computes them anew and lists what differs.

    make same                                 compare with the tables: minutes
    make same ARGS='--only simulations'       one table
    make same ARGS=--freeze                   write the tables, where a change is on purpose
    make same ARGS='--against COMMIT'         compare with a commit, computed here as well

The last bits of a result depend on processor and libraries, so the tables hold on a machine like
the one that wrote them; on any other, --against says whether something changed.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
import csv
from functools import partial
import os
from pathlib import Path
import subprocess
import sys
from tempfile import TemporaryDirectory
from typing import Any

from commands import COMMANDS, FLIGHTS, ROOT, run_command
from fingerprint import describe_machine
from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.workers import ItemFailure, LocalWorkers
from rich.progress import track
from simulations import list_flights, simulate_flight
from studies import CASES, study

FROZEN = Path(__file__).with_name('frozen')
MACHINE = 'machine.txt'
SHOWN = 20  # differences of a table that are listed
# Of this environment; the last one chooses the routines of the linear algebra, and with them the
# last bits
INHERITED = {'PATH', 'HOME', 'USER', 'OPENBLAS_CORETYPE'}

Table = dict[str, str]


def merge(parts: Iterator[Table], count: int, title: str) -> Table:
    """Return all parts of a table as one, behind a progress bar."""
    rows: Table = {}
    for part in track(parts, title, count):
        rows |= part
    return rows


def run_in_workers(
    function: Callable[..., Table], each: Sequence[tuple[Any, ...]], jobs: int
) -> Iterator[Table]:
    """Yield the parts of a table, as they finish."""
    with LocalWorkers(partial(call, function), jobs) as workers:
        for _, part in workers.run(each):
            if isinstance(part, ItemFailure):
                raise BadInput(part.reason)
            yield part


def call(function: Callable[..., Table], arguments: tuple[Any, ...]) -> Table:
    return function(*arguments)


def compute_simulations(jobs: int, _again: bool) -> Table:
    """Return the hash of each flight."""
    flights = list(list_flights())
    return merge(run_in_workers(simulate_flight, flights, jobs), len(flights), 'simulations')


def compute_commands(jobs: int, again: bool) -> Table:
    """Return the numbers of each command; with `again` only those that two runs agree on."""
    first = run_commands(jobs, 'commands')
    if not again:
        return first
    second = run_commands(jobs, 'commands, again')
    return {name: value for name, value in first.items() if second.get(name) == value}


def run_commands(jobs: int, title: str) -> Table:
    """Run all commands, in a folder that goes afterwards."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        rows: Table = {}
        for one, line in FLIGHTS.items():
            rows |= run_command(one, line, folder)
        each = [(one, line, folder) for one, line in COMMANDS.items()]
        return rows | merge(run_in_workers(run_command, each, jobs), len(each), title)


def compute_studies(jobs: int, again: bool) -> Table:
    """Return what discovery finds in each case."""
    del again
    cases = [(number,) for number in CASES]
    return merge(run_in_workers(study, cases, jobs), len(cases), 'studies')


TABLES = {
    'simulations': compute_simulations,
    'commands': compute_commands,
    'studies': compute_studies,
}


def write_table(path: Path, rows: Table) -> None:
    """Write a table, sorted by name."""
    with path.open('w', encoding='utf-8', newline='') as file:
        csv.writer(file, lineterminator='\n').writerows(sorted(rows.items()))


def read_table(path: Path) -> Table:
    csv.field_size_limit(sys.maxsize)
    with path.open(encoding='utf-8', newline='') as file:
        return dict(csv.reader(file))


def list_differences(frozen: Table, rows: Table) -> list[str]:
    """Return one line for each row that differs; rows that are new are none of them."""
    return [
        f'{name}: {value[:60]} -> {rows.get(name, "nothing")[:60]}'
        for name, value in frozen.items()
        if rows.get(name) != value
    ]


def freeze(folder: Path, tables: list[str], jobs: int) -> None:
    """Compute and write the tables."""
    folder.mkdir(exist_ok=True)
    kept = folder / MACHINE
    if len(tables) < len(TABLES) and kept.exists() and kept.read_text() != describe_machine():
        raise BadInput(f'{kept} is of another machine: freeze all tables, without --only.')
    for name in tables:
        rows = TABLES[name](jobs, True)
        write_table(folder / f'{name}.csv', rows)
        sys.stdout.write(f'{name}: {len(rows)} rows written.\n')
    kept.write_text(describe_machine(), encoding='utf-8')


def compare(folder: Path, tables: list[str], jobs: int) -> int:
    """Compute the tables and print what differs; return the exit status."""
    different = 0
    for name in tables:
        frozen, rows = read_table(folder / f'{name}.csv'), TABLES[name](jobs, False)
        lines = list_differences(frozen, rows)
        different += len(lines)
        words = [f'{name}: {len(frozen) - len(lines)} of {len(frozen)} rows are the same.']
        words += [f'  {line}' for line in lines[:SHOWN]]
        words += [f'  and {len(lines) - SHOWN} more.'] if len(lines) > SHOWN else []
        sys.stdout.write('\n'.join(words) + '\n')
    return 1 if different else 0


def freeze_commit(commit: str, folder: Path, options: list[str]) -> None:
    """Compute the tables of a commit, in a work tree of its own."""
    tree = folder / 'tree'
    git = ['git', '-C', str(ROOT), 'worktree']
    subprocess.run([*git, 'add', '--detach', '--quiet', str(tree), commit], check=True)
    try:
        bare = {key: value for key, value in os.environ.items() if key in INHERITED}
        arguments = ' '.join(['--freeze', '--out', str(folder / 'frozen'), *options])
        make = ['make', '-C', str(tree), 'same', f'ARGS={arguments}']
        subprocess.run(make, env=bare, check=True)
    finally:
        subprocess.run([*git, 'remove', '--force', str(tree)], check=True)


def main() -> int:
    """Freeze or compare; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--freeze', action='store_true', help='write the tables')
    parser.add_argument('--against', metavar='COMMIT', help='compare with a commit')
    parser.add_argument('--only', choices=TABLES, action='append', help='one table; repeatable')
    parser.add_argument('--jobs', type=int, default=count_cores())
    parser.add_argument('--out', type=Path, default=FROZEN, help='folder of the tables')
    order = parser.parse_args()
    tables = order.only or list(TABLES)
    if order.freeze:
        try:
            freeze(order.out, tables, order.jobs)
        except BadInput as refusal:
            sys.stderr.write(f'{refusal}\n')
            return 2
        return 0
    if order.against:
        with TemporaryDirectory() as folder:
            options = [f'--only {name}' for name in tables]
            freeze_commit(order.against, Path(folder), options)
            return compare(Path(folder) / 'frozen', tables, order.jobs)
    if (FROZEN / MACHINE).read_text(encoding='utf-8') != describe_machine():
        sys.stderr.write(
            'The tables were frozen on another processor or with other libraries '
            f"({FROZEN / MACHINE}); give make same ARGS='--against COMMIT'.\n"
        )
        return 2
    return compare(FROZEN, tables, order.jobs)


if __name__ == '__main__':
    sys.exit(main())
