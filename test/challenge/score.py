#!/usr/bin/env python3
"""
Hide effects in flights of an independent simulator, and score what discovery names.

Finished cases are stored in a file of JSON lines, from which an interrupted run resumes.
"""

import argparse
from collections.abc import Callable, Sequence
from functools import partial
import json
import multiprocessing
import os
from pathlib import Path
import sys
from typing import Any, Final

sys.path.append(str(Path(__file__).resolve().parents[1]))

from lta_report.formatting import format_markdown_table, MISSING
import numpy as np
from scipy.stats import binomtest

from challenge.case import KINDS
from challenge.trial import run_trial

CLEAR: Final = 6.0  # standard deviations from which on an effect should be named
Case = dict[str, Any]
PAGE_HEAD: Final = """# Scores of discovery

Written by `make challenge ARGS='{command} --markdown docs/discovery_scores.md'`.

Each case is a GT-MAB that differs from its file within tolerances (thrust, drag, inertia, mass,
balance, rotors, lag, delay; in each flight its lift and biases), flown three times for one to
three minutes: two flights to learn from, one held out. Hidden is nothing, one or two effects of
the library, something that the library does not have, or both. The simulator of these flights
(`test/challenge/`) shares no equation and no code with the model: its own rigid body in another
formulation, rotors, air, sensors, clocks and noise.

*Sigma* of an effect is its size by its standard deviation in a fit that knows what is hidden.
*Exact*: all that is hidden is named, and nothing else; what such flights cannot distinguish
([classes](discovery_classes.md)) counts as one. Intervals are Wilson's, 95 %.
"""


def list_figures(cases: Sequence[Case]) -> list[tuple[str, list[bool]]]:
    """Return each figure with whether each of its cases is a hit."""
    done = [one for one in cases if not one['refused']]

    def select(kind: str, low: float = 0.0, high: float = np.inf) -> list[Case]:
        return [
            one for one in done
            if one['kind'] == kind and low <= min(one['sigma'].values(), default=0.0) < high
        ]  # fmt: skip

    def is_exact(one: Case) -> bool:
        return not one['missed'] and not one['wrong']

    def is_flagged(one: Case) -> bool:
        return 'unexplained' in one['verdict']

    def count(some: Sequence[Case], test: Callable[[Case], bool]) -> list[bool]:
        return [test(one) for one in some]

    outside = [one for one in done if one['outside']]
    intervals = [each for one in done for each in one['intervals']]
    return [
        ('one effect of 6 sigma or more: exact', count(select('single', CLEAR), is_exact)),
        ('one effect of 3 to 6 sigma: exact', count(select('single', 3.0, CLEAR), is_exact)),
        ('two effects, both of 6 sigma or more: exact', count(select('pair', CLEAR), is_exact)),
        ('nothing hidden: something named',
         count(select('clean'), lambda one: bool(one['named']))),
        ('nothing hidden: a force reported', count(select('clean'), is_flagged)),
        ('effects of the library alone: a wrong name',
         count([one for one in done if one['hidden'] and not one['outside']],
               lambda one: bool(one['wrong']))),
        ('something else: a force reported', count(outside, is_flagged)),
        ('something else: a wrong name', count(outside, lambda one: bool(one['wrong']))),
        ('all cases: a wrong name', count(done, lambda one: bool(one['wrong']))),
        ('95 % intervals that contain the truth',
         [one['ci95'][0] <= one['true'] <= one['ci95'][1] for one in intervals]),
        ('refused', [bool(one['refused']) for one in cases]),
    ]  # fmt: skip


def format_share(hits: Sequence[bool]) -> str:
    """Return a share with its interval."""
    if not hits:
        return MISSING
    ends = binomtest(sum(hits), len(hits)).proportion_ci(method='wilson')
    share = f'{sum(hits)}/{len(hits)} = {100 * sum(hits) / len(hits):.0f} %'
    return f'{share} ({100 * ends.low:.0f} to {100 * ends.high:.0f})'


def format_result(one: Case) -> str:
    """Return what was named in a case, or why it was refused."""
    if one['refused']:
        return str(one['refused'])
    return ', '.join([*one['named'], *(f'force: {name}' for name in one['forces'])]) or MISSING


def format_page(cases: Sequence[Case], command: str) -> str:
    """Return docs/discovery_scores.md."""
    figures = [[name, format_share(hits)] for name, hits in list_figures(cases)]
    seconds = [one['cpu_s'] for one in cases]
    rows = [
        [str(one['number']), one['kind'],
         ', '.join(f'{name} ({one["sigma"][name]:.0f})' if name in one.get('sigma', {}) else name
                   for name in one['hidden']) or MISSING,
         one['outside'] or MISSING, format_result(one)]
        for one in cases
    ]  # fmt: skip
    time = f'Processor time of a study: {np.median(seconds):.0f} s (median), {max(seconds):.0f} s.'
    return '\n'.join([
        PAGE_HEAD.format(command=command),
        f'{len(cases)} cases.\n',
        format_markdown_table(['figure', 'share'], figures),
        f'\n{time}\n\n## All cases\n',
        format_markdown_table(['case', 'kind', 'hidden (sigma)', 'something else', 'named'], rows),
        '',
    ])  # fmt: skip


def main() -> None:
    """Score the cases that are not stored yet, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--n', type=int, default=30, help='number of cases')
    parser.add_argument('--kind', choices=list(KINDS), help='what is hidden; random by default')
    parser.add_argument('--out', type=Path, default=Path('runs/challenge.jsonl'))
    parser.add_argument('--workers', type=int, default=os.cpu_count() or 1)
    parser.add_argument('--markdown', type=Path, help='page to write')
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    lines = options.out.read_text().splitlines() if options.out.exists() else []
    results = {one['number']: one for one in map(json.loads, lines)}
    todo = [number for number in range(options.n) if number not in results]
    trial = partial(run_trial, options.seed, options.kind)
    with multiprocessing.get_context('spawn').Pool(options.workers, maxtasksperchild=8) as pool:
        for one in pool.imap_unordered(trial, todo):
            results[one['number']] = one
            with options.out.open('a') as file:
                file.write(f'{json.dumps(one)}\n')
            sys.stdout.write(f'{len(results)}/{options.n}: case {one["number"]}\n')
    cases = [results[number] for number in range(options.n)]
    for name, hits in list_figures(cases):
        sys.stdout.write(f'{name}: {format_share(hits)}\n')
    if options.markdown:
        command = f'--seed {options.seed} --n {options.n}'
        options.markdown.write_text(format_page(cases, command), encoding='utf-8')


if __name__ == '__main__':
    main()
