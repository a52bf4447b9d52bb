"""
Measure speeds, beside other programs where they are installed.

All figures are sampled turn about over the whole run and the best sample of each counts (its
median where a figure says so), so that other work on the machine spoils neither them nor their
ratio. Rates of kernels, loop and commands are by processor time, those of the graph by the wall
clock. What cannot be measured on this machine is listed with the reason.
"""

from argparse import Namespace
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module
import math
from typing import Final

from lta_config.errors import BadInput
from lta_config.machine import count_cores

from campaigns.harness import Campaign, Case, Row, Rows


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure, and the function that measures it."""

    name: str  # `kind.quantity`
    unit: str  # of its value
    measure: Callable[[], float]  # returns one sample; the first may be slow, as it may compile
    about: str = ''  # what it is, for the table
    # Takes the figure from the samples, and the best of peers: `max` for what should be high,
    # `min` for what should be low
    choose: Callable[[Iterable[float]], float] = max
    of: str = ''  # LTA's figure that this one is the peer's of; '' for LTA's own
    peer: str = ''  # program and version of a peer


# Where the figures of each kind are: a function of the kind's name
KINDS: Final = {
    'kernel': 'bench_kernel', 'loop': 'bench_loop', 'vlc': 'bench_loop',
    'graph': 'bench_graph', 'recorder': 'bench_graph', 'command': 'bench_graph',
    'reading': 'bench_reading', 'tables': 'bench_reading',
    'mujoco': 'bench_simulators',
}  # fmt: skip


@cache
def list_figures(kind: str) -> tuple[Figure, ...]:
    """
    Return what is measured of a kind.

    Raises
    ------
    BadInput, ModuleNotFoundError
        Where it cannot be measured on this machine.

    """
    return tuple(getattr(import_module(f'campaigns.{KINDS[kind]}'), f'list_{kind}')())


def run(case: Case, options: Namespace) -> Row:
    """Return a sample of each figure of a kind, or why there is none."""
    try:
        values = {figure.name: figure.measure() for figure in list_figures(case.kind)}
    except (BadInput, ModuleNotFoundError) as error:
        return {'values': {}, 'skipped': str(error)}
    bad = [name for name, value in values.items() if not math.isfinite(value)]
    return {'values': values, 'wrong': f'{bad[0]} is no number' if bad else ''}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield LTA's figures, each with its ratio to the best peer, and what was skipped."""
    samples = defaultdict[str, list[float]](list)
    for row in rows.values():
        for name, value in row.get('values', {}).items():
            samples[name].append(value)
    kinds = dict.fromkeys(case.kind for case in rows if rows[case].get('values'))
    figures = [figure for kind in kinds for figure in list_figures(kind)]
    values = {figure: figure.choose(samples[figure.name]) for figure in figures}
    yield f'On {count_cores()} cores.'
    yield ''
    yield '| | measured | LTA / best peer | what |'
    yield '|---|---|---|---|'
    for figure in figures:
        if not figure.of:
            peers = {one: value for one, value in values.items() if one.of == figure.name}
            ratio = ''
            if peers:
                best = figure.choose(peers.values())
                name = next(one.peer for one, value in peers.items() if value == best)
                ratio = f'{values[figure] / best:.3g} ({name})'
            measured = f'{format_value(values[figure])} {figure.unit}'
            yield f'| `{figure.name}` | {measured} | {ratio} | {figure.about} |'
    skipped = {case.kind: row['skipped'] for case, row in rows.items() if 'skipped' in row}
    yield from (f'\n{kind} is skipped: {reason}' for kind, reason in skipped.items())


def format_value(value: float) -> str:
    """Return a value with three digits, millions in words."""
    if abs(value) >= 1e6:
        return f'{value / 1e6:.3g} million'
    return f'{float(f"{value:.3g}"):,.0f}' if abs(value) >= 100.0 else f'{value:.3g}'


CAMPAIGN: Final = Campaign(
    lambda options: list(KINDS), run, list_table, each=5, page='validation.md',
    smoke='--kinds vlc --each 1',
)  # fmt: skip
