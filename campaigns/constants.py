# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Score discovery and calibration with each of their constants halved and doubled.

The constants are those of `lta_discovery.settings`; the cases those of `make campaign discovery`
and `make campaign calibration`, with short flights. Only a difference from the cases with
unchanged constants says something.
"""

from argparse import Namespace
from collections.abc import Iterator
import os
from pathlib import Path
import re
from typing import Any, Final

from lta_discovery import settings
from lta_report.formatting import format_markdown_table, MISSING
import numpy as np

from campaigns.harness import Campaign, Case, Row, Rows

AS_THEY_ARE: Final = 'as they are'
CONSTANTS: Final = {name: value for name, value in vars(settings).items() if name.isupper()}
FACTORS: Final = (0.5, 2.0)
SECONDS: Final = (25.0, 30.0)  # s; range of the lengths of the flights
# Kinds of the cases of discovery, and one of a calibration
CASES: Final = ('clean', 'mixed', 'calibration')


def list_cases(name: str) -> set[str]:
    """Return the cases that a constant can change: those of the code that imports it."""
    package, out = Path(settings.__file__).parent, set[str]()
    for path in package.rglob('*.py'):
        if re.search(rf'\b{name}\b', path.read_text(encoding='utf-8')) and path.stem != 'settings':
            # A calibration is also the first step of a discovery
            is_own = path.parent.name == 'calibration' and path.stem != 'first_step'
            out |= set(CASES[-1:] if is_own else CASES[:-1])
    return set(CASES) if name == AS_THEY_ARE else out


def scale_constant(value: Any, factor: float, *, is_count: bool = False) -> Any:
    """
    Return a constant times a factor, in the sense that it has.

    A share, a probability or a cosine above a half is scaled by what it lacks of 1, a ratio
    between 1 and 1.2 by what it exceeds 1; numbers of a tuple or a table are scaled all.
    `is_count`: whether it counts something, and is neither.
    """
    if isinstance(value, dict):
        return {key: scale_constant(one, factor) for key, one in value.items()}
    if isinstance(value, tuple):
        return tuple(scale_constant(one, factor) for one in value)
    if isinstance(value, int):
        return max(round(value * factor), 1)
    if not is_count and (0.5 <= value < 1.0 or 1.0 < value < 1.2):
        return 1.0 + (value - 1.0) * factor
    return value * factor


def run(case: Case, options: Namespace) -> Row:
    """Return what is named in a case, or how good its calibration is, with a changed constant."""
    which, way = divmod(case.number, len(FACTORS))
    # Unchanged constants go one way
    if (way and case.kind == AS_THEY_ARE) or CASES[which] not in list_cases(case.kind):
        return {}
    if case.kind != AS_THEY_ARE:
        is_count = case.kind.startswith('EXPECTED')
        scaled = scale_constant(CONSTANTS[case.kind], FACTORS[way], is_count=is_count)
        setattr(settings, case.kind, scaled)
    # Each module takes its constants from the settings when it is imported
    if CASES[which] == 'calibration':
        from campaigns.calibration import run_case

        row = run_case(options.seed, which, SECONDS)
        inside = [one['ci95'][0] <= one['truth'] <= one['ci95'][1] for one in row['values']]
        error = row['scores']['after'][0] / row['oracle']
        return {'inside': inside, 'error': error, 'cpu_s': row['cpu_s']}
    from campaigns.challenge.trial import run_trial

    row = run_trial(options.seed, CASES[which], which, SECONDS)
    kept = ('hidden', 'named', 'missed', 'forces', 'refused', 'errors', 'cpu_s')
    return {key: row[key] for key in kept if key in row} | {'misnamed': row.get('wrong', [])}


def format_score(rows: Rows, constant: str, way: int, cases: int) -> list[str]:
    """Return the cells of a constant that is changed one way."""
    some = [rows.get(Case(constant, len(FACTORS) * k + way)) for k in range(cases)]
    named = [one for one in some if one and 'misnamed' in one]
    plain = [rows.get(Case(AS_THEY_ARE, len(FACTORS) * k)) for k in range(cases)]
    ratios = [
        find_error(one) / find_error(other)
        for one, other in zip(some, plain, strict=True)
        if one and other and find_error(one) and find_error(other)
    ]
    inside = [each for one in some if one for each in one.get('inside', ())]
    exact = sum(not one['missed'] and not one['misnamed'] for one in named)
    return [
        f'{exact} of {len(named)}',
        str(sum(bool(one['misnamed']) for one in named)),
        f'{sum(inside)} of {len(inside)}',
        f'{np.exp(np.mean(np.log(ratios))):.3f}' if ratios else MISSING,
    ]


def find_error(row: Row) -> float:
    """Return the position error 3 s ahead of the best model of a case, or 0."""
    errors = [one for name, one in row.get('errors', {}).items() if name != 'coasting']
    return float(row.get('error') or min(errors, default=0.0))


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield a line for each constant."""
    count = 1 + max((case.number // len(FACTORS) for case in rows), default=0)
    heads = ['exact', 'wrong', 'intervals', 'error']
    table = [[AS_THEY_ARE, '', *format_score(rows, AS_THEY_ARE, 0, count), *([MISSING] * 4)]]
    for name, value in CONSTANTS.items():
        cells = [each for way in range(2) for each in format_score(rows, name, way, count)]
        shown = ', '.join(f'{one:g}' for one in value) if isinstance(value, tuple) else value
        shown = f'{value:.3g}' if isinstance(value, float) else shown
        table.append([name, MISSING if isinstance(value, dict) else str(shown), *cells])
    yield format_markdown_table(
        ['constant', 'value', *(f'{one}, halved' for one in heads),
         *(f'{one}, doubled' for one in heads)],
        table,
    )  # fmt: skip


CAMPAIGN: Final = Campaign(
    lambda options: [AS_THEY_ARE, *CONSTANTS], run, list_table,
    each=len(FACTORS) * len(CASES), page='discovery_constants.md', alone=True,
    side=os.cpu_count() or 1,
)  # fmt: skip
