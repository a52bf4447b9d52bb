"""
The measurements: `make bench` prints a table and writes `runs/bench.json`.

A benchmark is a file here, or in `peers/`, with a function `figures`; what it cannot measure on
this machine it refuses with `BadInput`, and is listed as skipped. All figures are sampled turn
about over the whole run and the best sample of each counts, so that other work on the machine
spoils neither them nor their ratio. `make bench ARGS='kernel mujoco'` takes only these files, and
`--once` one sample of each figure, to see that all can be measured; it writes no file.

The file has the date, the number of cores, the load of the machine at the beginning and the end,
and `rows` of {name, value, unit, peer, ratio}. `ratio` is always LTA's figure over the peer's: in
LTA's own row over its best peer's, in a peer's row over this peer's.
"""

from argparse import ArgumentParser
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import date
from importlib import import_module
import json
import math
import os
from pathlib import Path
import sys
import time

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from rich.console import Console
from rich.table import Table

HERE = Path(__file__).resolve().parent
RESULTS = HERE.parents[1] / 'runs' / 'bench.json'
# `make flights` and the peers of laws take minutes and have tables of their own.
NO_BENCHMARKS = (
    'bench', 'compare', 'flights', 'gtmab', 'law_peers', 'rotor_advance', 'speed_table'
)  # fmt: skip
Choice = Callable[[Iterable[float]], float]


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of a benchmark, and the function that measures it."""

    name: str  # `group.quantity`
    unit: str  # of its value
    measure: Callable[[], float]  # returns one sample; the first may be slow, as it may compile
    rounds: int = 10  # samples to take
    # Takes the figure from the samples, and the best of peers: `max` for what should be high,
    # `min` for what should be low
    choose: Choice = max
    of: str = ''  # LTA's figure that this one is the peer's of; '' for LTA's own
    peer: str = ''  # program and version of a peer


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table and of the file."""

    name: str
    value: float
    unit: str
    peer: str | None = None
    ratio: float | None = None


@dataclass(frozen=True, slots=True)
class Absent:
    """What has no row, and why."""

    name: str
    why: str
    failed: bool = False


def benchmarks() -> dict[str, str]:
    """Return the module of each benchmark by the name of its file."""
    own = {path.stem: path.stem for path in sorted(HERE.glob('[!_]*.py'))}
    peers = {path.stem: f'peers.{path.stem}' for path in sorted(HERE.glob('peers/[!_]*.py'))}
    return {
        name: module
        for name, module in (own | peers).items()
        if name not in NO_BENCHMARKS and not name.startswith('test_')
    }


def gather(modules: Iterable[tuple[str, str]]) -> tuple[list[Figure], list[Absent]]:
    """Return what can be measured here, and what cannot."""
    figures: list[Figure] = []
    absent: list[Absent] = []
    for name, module in modules:
        try:
            figures += import_module(module).figures()
        except BadInput as refusal:
            absent.append(Absent(name, str(refusal)))
        except ModuleNotFoundError as error:
            lacking = str(error.name)
            file = 'requirements-bench.txt' if module.startswith('peers.') else 'requirements.txt'
            remedy = f'.venv/bin/pip install -c constraints.txt -r {file}'
            own = lacking.startswith('lta_')
            absent.append(Absent(name, f'{lacking} is not installed; {remedy}', failed=own))
        except Exception as error:
            absent.append(Absent(name, f'{type(error).__name__}: {error}', failed=True))
    return figures, absent


def pace(count: float, begin: float) -> float:
    """Return a rate on all cores by the processor time since `begin`. [1/s]"""
    return count * count_cores() / (time.process_time() - begin)


def groups(figures: Sequence[Figure]) -> list[list[Figure]]:
    """Return the figures, each of LTA's with its peers behind it."""
    found: dict[str, list[Figure]] = {figure.name: [] for figure in figures if not figure.of}
    for figure in figures:
        found.setdefault(figure.of or figure.name, []).append(figure)
    return [sorted(group, key=lambda figure: figure.of) for group in found.values()]


def sample(
    figures: Sequence[Figure], tell: Callable[[str], None] = lambda name: None
) -> tuple[dict[Figure, float], list[Absent]]:
    """Return the value of each figure, all measured turn about."""
    samples: dict[Figure, list[float]] = {figure: [] for figure in figures}
    absent: list[Absent] = []
    for turn in range(max((figure.rounds for figure in figures), default=0)):
        for figure in [figure for figure in samples if turn < figure.rounds]:
            tell(f'{figure.name}, {turn + 1} of {figure.rounds}')
            try:
                samples[figure].append(check_finite(figure.measure()))
            except Exception as error:
                why = f'{type(error).__name__}: {error}'
                absent.append(Absent(figure.name, why, failed=True))
                del samples[figure]
    return {figure: figure.choose(taken) for figure, taken in samples.items()}, absent


def check_finite(value: float) -> float:
    """Return a sample; raise `ArithmeticError` if it is not a number, as without any message."""
    if not math.isfinite(value):
        raise ArithmeticError(f'a sample is {value}')
    return value


def rows_of(values: dict[Figure, float]) -> list[Row]:
    """Return the rows of a group: LTA's against its best peer, then each peer."""
    own = next((value for figure, value in values.items() if not figure.of), None)
    peers = {figure: value for figure, value in values.items() if figure.of}
    rows = []
    for figure, value in values.items():
        row = Row(figure.name, value, figure.unit, figure.peer or None)
        if figure.of and own is not None:
            row = replace(row, ratio=own / value)
        elif peers and not figure.of:
            best = figure.choose(peers.values())
            named = next((peer for peer, reached in peers.items() if reached == best), None)
            row = replace(row, peer=named.peer if named else None, ratio=own / best)
        rows.append(row)
    return rows


def show(console: Console, rows: Sequence[Row], absent: Sequence[Absent]) -> None:
    """Print the table, then what is not in it."""
    table = Table(box=None, pad_edge=False)
    for heading in ('name', 'value', 'unit', 'peer', 'LTA / peer'):
        right = heading in ('value', 'LTA / peer')
        table.add_column(heading, justify='right' if right else 'left', no_wrap=True)
    for row in rows:
        ratio = '' if row.ratio is None else f'{row.ratio:,.4g}'
        table.add_row(row.name, number(row.value), row.unit, row.peer or '', ratio)
    console.print(table)
    for each in absent:
        # Brackets in a sentence are no style.
        state = 'failed' if each.failed else 'skipped'
        console.print(f'{each.name} {state}: {each.why}', markup=False, highlight=False)


def number(value: float) -> str:
    """Return a value with four digits that mean something."""
    return f'{value:,.0f}' if abs(value) >= 10_000 else f'{value:.4g}'


def write(rows: Sequence[Row], path: Path, load: Sequence[float]) -> None:
    """Write the file as a whole: an interrupted run leaves the one before."""
    path.parent.mkdir(exist_ok=True)
    content = {
        'date': date.today().isoformat(),
        'cores': count_cores(),
        'load': [round(value, 1) for value in load],
        'rows': [asdict(row) for row in rows],
    }
    temporary = path.with_suffix(f'.{os.getpid()}')
    temporary.write_text(json.dumps(content, indent=1) + '\n')
    temporary.replace(path)


def main(chosen: Sequence[str] = (), *, once: bool = False) -> int:
    """Measure, print and write unless `once`; return the exit status."""
    known = benchmarks()
    if unknown := [name for name in chosen if name not in known]:
        sys.stderr.write(f'There is no benchmark {unknown[0]!r}; known: {", ".join(known)}.\n')
        return 2
    # All imports first: rclpy's starts the interpreter anew.
    modules = [(name, module) for name, module in known.items() if not chosen or name in chosen]
    figures, absent = gather(modules)
    if once:
        figures = [replace(figure, rounds=1) for figure in figures]
    ordered, load = groups(figures), os.getloadavg()[0]
    with Console(stderr=True).status('') as status:
        values, broken = sample([figure for group in ordered for figure in group], status.update)
    rows = [
        row
        for group in ordered
        for row in rows_of({figure: values[figure] for figure in group if figure in values})
    ]
    absent += broken
    show(Console(width=None if sys.stdout.isatty() else 120), rows, absent)
    if not once:
        write(rows, RESULTS, (load, os.getloadavg()[0]))
        sys.stdout.write(f'{RESULTS}\n')
    return int(any(each.failed for each in absent))


if __name__ == '__main__':
    parser = ArgumentParser(description='Measure, print a table and write runs/bench.json.')
    parser.add_argument('names', nargs='*', help=f'some of: {", ".join(benchmarks())}')
    parser.add_argument('--once', action='store_true', help='one sample each; write no file')
    given = parser.parse_args()
    # The benchmarks import this file by its name: it must not be there twice.
    sys.exit(import_module('bench').main(given.names, once=given.once))
