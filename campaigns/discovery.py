# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Hide effects in flights of an independent simulator, and score what discovery names.

Each case is a GT-MAB that differs from its file within tolerances, flown three times: two flights
to learn from, one held out (`challenge/`). Hidden is nothing, one or two effects of the library,
something that the library does not have, or both; a kind decides what, `any` by chance. `wrench`
and `rough` hide one effect each: from a log of the pose and a commanded wrench, and from a tracker
that loses and misplaces the vehicle.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

from lta_report.formatting import format_markdown_table, MISSING
import numpy as np
from scipy.stats import binomtest

from campaigns.challenge.case_generator import KINDS, SECONDS
from campaigns.challenge.trial import run_trial
from campaigns.harness import Campaign, Case, Row, Rows

CLEAR: Final = 6.0  # standard deviations from which on an effect should be named
Score = dict[str, Any]


def list_figures(cases: Sequence[Score]) -> list[tuple[str, list[bool]]]:
    """Return each figure with whether each of its cases is a hit."""
    done = [one for one in cases if not one['refused']]

    def select(kind: str, low: float = 0.0, high: float = np.inf) -> list[Score]:
        return [
            one for one in done
            if one['kind'] == kind and low <= min(one['sigma'].values(), default=0.0) < high
        ]  # fmt: skip

    def is_exact(one: Score) -> bool:
        return not one['missed'] and not one['misnamed']

    def is_flagged(one: Score) -> bool:
        return 'unexplained' in one['verdict']

    def count(some: Sequence[Score], test: Callable[[Score], bool]) -> list[bool]:
        return [test(one) for one in some]

    outside = [one for one in done if one['outside']]
    intervals = [each for one in done for each in one['intervals']]
    return [
        ('one effect of 6 sigma or more: exact', count(select('single', CLEAR), is_exact)),
        ('one effect of 3 to 6 sigma: exact', count(select('single', 3.0, CLEAR), is_exact)),
        ('two effects, both of 6 sigma or more: exact', count(select('pair', CLEAR), is_exact)),
        ('a commanded wrench, 6 sigma or more: exact', count(select('wrench', CLEAR), is_exact)),
        ('a rough tracker, 6 sigma or more: exact', count(select('rough', CLEAR), is_exact)),
        ('nothing hidden: something named',
         count(select('clean'), lambda one: bool(one['named']))),
        ('nothing hidden: a force reported', count(select('clean'), is_flagged)),
        ('effects of the library alone: a wrong name',
         count([one for one in done if one['hidden'] and not one['outside']],
               lambda one: bool(one['misnamed']))),
        ('something else: a force reported', count(outside, is_flagged)),
        ('something else: a wrong name', count(outside, lambda one: bool(one['misnamed']))),
        ('all cases: a wrong name', count(done, lambda one: bool(one['misnamed']))),
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


def format_result(one: Score) -> str:
    """Return what was named in a case, or why it was refused."""
    if one['refused']:
        return str(one['refused'])
    return ', '.join([*one['named'], *(f'force: {name}' for name in one['forces'])]) or MISSING


def run(case: Case, options: Namespace) -> Row:
    """Return what discovery names in a case, and what was hidden."""
    kind = None if case.kind == 'any' else case.kind
    row = run_trial(options.seed, kind, case.number, tuple(options.seconds))
    # `wrong` is what must not be in a campaign; a wrong name is what this one counts
    return {**row, 'misnamed': row.pop('wrong', [])}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the shares, and a line for each case."""
    cases = [row for row in rows.values() if 'kind' in row]
    yield f'{len(cases)} cases, seed {options.seed}.'
    yield ''
    figures = [[name, format_share(hits)] for name, hits in list_figures(cases)]
    yield format_markdown_table(['figure', 'share'], figures)
    if not cases:
        return
    seconds = [one['cpu_s'] for one in cases]
    yield ''
    yield f'Processor time of a study: {np.median(seconds):.0f} s (median), {max(seconds):.0f} s.'
    yield ''
    lines = [
        [str(one['number']), one['kind'],
         ', '.join(f'{name} ({one["sigma"][name]:.0f})' if name in one.get('sigma', {}) else name
                   for name in one['hidden']) or MISSING,
         one['outside'] or MISSING, format_result(one)]
        for one in cases
    ]  # fmt: skip
    heads = ['case', 'kind', 'hidden (sigma)', 'something else', 'named']
    yield format_markdown_table(heads, lines)


def add_arguments(parser: ArgumentParser) -> None:
    """Add the lengths of the flights."""
    parser.add_argument('--seconds', nargs=2, type=float, default=SECONDS, help='least and most')


CAMPAIGN: Final = Campaign(
    lambda options: ['any'], run, list_table, each=30, add_arguments=add_arguments,
    page='discovery_scores.md', alone=True, side=0, hidden=tuple(KINDS),
    smoke='--kinds clean --each 1 --seconds 20 21',
)  # fmt: skip
