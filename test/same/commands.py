# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The numbers that quick commands print as JSON and draw as tables on their pages.

Texts may change, numbers may not: of JSON all numbers and flags are kept, of pages the numbers in
the cells of tables. Numbers in a list stand in one row.
"""

from collections.abc import Iterator
import hashlib
from html.parser import HTMLParser
import json
from pathlib import Path
import re
import shlex
import subprocess
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
NUMBER = re.compile(r'(?<![\w.])[-\u2212+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)')
SWEEP = Path(__file__).with_name('sweep.yaml')
LONGEST = 200  # letters of a row that are kept as they are
ENTRIES = 20  # of a list, each of which has rows of its own
LIMIT = 600  # s a command may take on a busy machine

# '{out}' is an empty folder of the command's own, '{flight}' a flight that was simulated first.
FLIGHTS = {
    'flight': 'simulate --seed 1 --out {out} --json',
    'other': 'simulate --seed 2 --scenario breeze --out {out} --json',
}
COMMANDS = {
    'vehicle show': 'vehicle show gtmab --json',
    'vehicle page': 'vehicle show gtmab --out {out}',
    'vehicle check': 'vehicle check skye --json',
    'vehicle diff': 'vehicle diff gtmab skye --json',
    'vehicle trim': 'vehicle trim {flight} --json',
    'cells': 'cells --json --out {out}',
    'cfd run': 'cfd run gtmab --fidelity analytic --json --out {out}',
    'light link': 'light link --scenario lamp_room --json --out {out}',
    'light plan': 'light plan warehouse --json --out {out}',
    'energy budget': 'energy budget --seeds 1 --json --out {out}',
    'energy breakeven': 'energy breakeven --json --out {out}',
    'mission': 'mission --schedule "duty cycle, asleep" --json --out {out}',
    'tune': 'tune gtmab --cases 2 --budget 16 --draws 2 --json --out {out}',
    'sweep': 'sweep {sweep} --json --out {out}',
    'bag info': 'bag info {flight}/bag --json',
    'bag check': 'bag check {flight}/bag --json',
    'bag export': 'bag export {flight}/bag --format csv --json --out {out}',
    'report': 'report {flight}/bag --out {out}',
    'compare': 'compare {flight} {other} --json --out {out}',
    'replay': 'replay {flight}/bag --json --out {out}',
}


class Cells(HTMLParser):
    """Collect the text of each table's cells, table by table."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[list[str]] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begin a table or a cell."""
        if tag == 'table':
            self.tables.append([])
        self._inside = tag in {'td', 'th'} or (self._inside and tag not in {'tr', 'table'})

    def handle_endtag(self, tag: str) -> None:
        """End a cell."""
        self._inside = self._inside and tag not in {'td', 'th'}

    def handle_data(self, data: str) -> None:
        """Take the text of a cell."""
        if self._inside and self.tables:
            self.tables[-1].append(data)


def shorten(text: str) -> str:
    """Return a long row of numbers as its first ones and the hash of all."""
    if len(text) <= LONGEST:
        return text
    return f'{text[:LONGEST]} ... {hashlib.sha256(text.encode()).hexdigest()[:16]}'


def list_numbers(value: Any, path: str = '') -> Iterator[tuple[str, str]]:
    """Yield path and value of all numbers in JSON; a list of numbers is one value."""
    if isinstance(value, dict):
        for key, below in value.items():
            yield from list_numbers(below, f'{path}.{key}' if path else key)
    elif isinstance(value, list):
        if value and all(isinstance(one, int | float) for one in value):
            yield path, shorten(' '.join(map(repr, value)))
        elif len(value) > ENTRIES:
            rows = [row for k, below in enumerate(value) for row in list_numbers(below, str(k))]
            yield path, shorten(' '.join(f'{name} {number}' for name, number in rows))
        else:
            for k, below in enumerate(value):
                yield from list_numbers(below, f'{path}.{k}')
    elif isinstance(value, bool | int | float):
        yield path, repr(value)


def read_tables(page: Path) -> Iterator[tuple[str, str]]:
    """Yield name and numbers of each table of a page."""
    cells = Cells()
    cells.feed(page.read_text(encoding='utf-8'))
    for k, table in enumerate(cells.tables):
        numbers = NUMBER.findall(' | '.join(table))
        yield f'{page.name} table {k + 1}', shorten(' '.join(numbers))


def run_command(name: str, line: str, folder: Path) -> dict[str, str]:
    """Run one command and return its numbers; a failure is its status and its last line."""
    words = [word.format(**places(folder, name)) for word in shlex.split(line)]
    out = folder / name.replace(' ', '_')
    done = subprocess.run(
        [ROOT / 'lta', *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=False,
    )
    rows = {f'{name} / status': str(done.returncode)}
    try:
        found = list_numbers(json.loads(done.stdout))
        rows |= {f'{name} / {path}': value for path, value in found}
    except ValueError:
        rows[f'{name} / status'] += ', no JSON'
    for page in sorted(out.rglob('*.html')):
        rows |= {f'{name} / {table}': value for table, value in read_tables(page)}
    return rows


def places(folder: Path, name: str) -> dict[str, Path]:
    """Return what the placeholders of a command stand for."""
    flights = {one: folder / one for one in FLIGHTS}
    return {'out': folder / name.replace(' ', '_'), 'sweep': SWEEP, **flights}
