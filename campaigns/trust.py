# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Score the data quality checks on clean and on corrupted flights.

Clean flights are simulated, or real ones in LTA_DATA. Each kind of corruption is done to pieces of
both, drawn by the number of the case. The table counts what was found (right kind, channel and
interval), and what else was said. Kinds are `clean/simulated`, `frozen/real` and so on.
"""

from argparse import Namespace
from collections import Counter
from collections.abc import Iterator
from functools import cache
from typing import Any, Final

from lta_data.data_quality.duplicate_runs import find_duplicate_runs
from lta_data.data_quality.registry import QualityReport, run_checks
from lta_data.data_quality.roles import vector_name
from lta_data.flight import Flight
from lta_flight.sweep.statistics import wilson_interval
import numpy as np
from numpy.random import Generator

from campaigns import trust_flights as flights
from campaigns.harness import Campaign, Case, Row, Rows
from campaigns.trust_case import Corrupted
from campaigns.trust_corruptions import CORRUPTIONS, twin

SLACK = 0.5  # seconds by which a found interval may miss the true one
POOL = 60  # simulated flights that corruptions are done to
TRIES = 500
NEVER = 'not applicable'


@cache
def pooled(number: int) -> Flight:
    """Return a simulated flight that corruptions are done to; none of the clean set."""
    return flights.simulated(10_000 + number)


@cache
def real(number: int) -> Flight:
    """Return a real flight by number, Crazyflie first."""
    crazy, blimp = flights.crazyflie_files(), flights.rgblimp_files()
    return (
        flights.crazyflie(crazy[number])
        if number < len(crazy)
        else (flights.rgblimp(blimp[number - len(crazy)]))
    )


def drawn(source: str, rng: Generator) -> Flight:
    """Draw a flight to be corrupted: a piece of 15 to 30 s of a real one, of both sets alike."""
    if source == 'simulated':
        return pooled(int(rng.integers(POOL)))
    crazy, blimp = len(flights.crazyflie_files()), len(flights.rgblimp_files())
    number = int(rng.integers(crazy)) if rng.random() < 0.5 else crazy + int(rng.integers(blimp))
    whole = real(number)
    total = flights.length(whole)
    size = min(total, float(rng.uniform(15.0, 30.0)))
    begin = float(rng.uniform(0.0, total - size))
    return flights.piece(whole, begin, begin + size)


def hits(report: QualityReport, kind: str, wrong: Corrupted) -> bool:
    """Whether a finding has the right kind, channel or vector or topic, and interval."""
    names = {*wrong.names, *map(vector_name, wrong.names)}
    names |= {name.rpartition('/')[0] for name in names if '/' in name}
    return any(
        finding.kind == kind
        and ({finding.channel, vector_name(finding.channel)} & names)
        and finding.from_s <= wrong.to_s + SLACK
        and finding.to_s >= wrong.from_s - SLACK
        for finding in report.findings
    )


def told(report: QualityReport) -> list[str]:
    """Return the kinds of what was found, the grave ones as they are, the others in brackets."""
    kinds = {f.kind if f.is_grave else f'({f.kind})' for f in report.findings}
    return sorted(kinds)


def run(case: Case, options: Namespace) -> Row:
    """Return what the checks say of a case."""
    (kind, source), number = case.kind.split('/'), case.number
    if kind == 'clean':
        count = len(flights.crazyflie_files()) + len(flights.rgblimp_files())
        flight = (
            flights.simulated(1000 + number) if source == 'simulated' else real(number % count)
        )
        report = run_checks(flight)
        texts = [f'{f.kind} {f.channel}: {f.evidence}' for f in report.findings if f.is_grave]
        return {'found': not texts, 'told': told(report), 'how': '; '.join(texts[:3])}
    rng = np.random.default_rng([options.seed, number, *kind.encode(), *source.encode()])
    if kind == 'twin':
        return judge_twin(source, rng)
    for _ in range(TRIES):
        wrong = CORRUPTIONS[kind](drawn(source, rng), rng)
        if wrong is not None:
            report = run_checks(wrong.recording)
            return {'found': hits(report, kind, wrong), 'told': told(report), 'how': wrong.how}
    return {'found': False, 'told': [], 'how': NEVER}


def judge_twin(source: str, rng: Generator) -> dict[str, Any]:
    """Return whether a copy is found beside two other flights, and it alone."""
    for _ in range(TRIES):
        flight = drawn(source, rng)
        copy = twin(flight, rng)
        if copy is None:
            continue
        others = [('other 1', drawn(source, rng)), ('other 2', drawn(source, rng))]
        others = [pair for pair in others if pair[1].channels.keys() and not same(pair[1], flight)]
        found = find_duplicate_runs([('one', flight), *others, ('copy', copy.recording)])
        at_copy = [f for f in found.get('copy', []) if "'one'" in f.evidence]
        extra = sum(map(len, found.values())) - len(at_copy)
        return {'found': bool(at_copy), 'told': ['twin'] * bool(at_copy) + ['wrong pair'] * extra,
                'how': copy.how}  # fmt: skip
    return {'found': False, 'told': [], 'how': NEVER}


def same(first: Flight, second: Flight) -> bool:
    """Whether two pieces may be of one flight: then a twin is right."""
    shared = [name for name in first.channels if name in second.channels]
    return any(
        np.isin(first.channels[name].values, second.channels[name].values).mean() > 0.2
        for name in shared
        if name.startswith(('ground_truth', 'imu')) and len(first.channels[name].values)
    )


def list_kinds(options: Namespace) -> list[str]:
    """Return each kind with each source of flights that is there."""
    sources = ['simulated', *(['real'] if flights.rgblimp_files() else [])]
    return [f'{kind}/{source}' for kind in ('clean', *CORRUPTIONS, 'twin') for source in sources]


def share(hit: int, count: int) -> str:
    """Return a share in words, with its 95 % interval."""
    found = wilson_interval(hit, count)
    return f'{hit:>4}/{count:<4} {100 * found.low:5.1f}..{100 * found.high:5.1f} %'


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the shares of each kind and source, and of all."""
    yield '| kind | right, of, 95 % | also said (cases) |'
    yield '|---|---|---|'
    judged = {case: row for case, row in rows.items() if row.get('how', NEVER) != NEVER}
    for kind in dict.fromkeys(case.kind for case in judged):
        some = [row for case, row in judged.items() if case.kind == kind]
        also = Counter(
            word for row in some for word in row['told'] if word.strip('()') != kind.split('/')[0]
        )
        words = ', '.join(f'{word} {count}' for word, count in also.most_common(8))
        yield f'| {kind} | {share(sum(row["found"] for row in some), len(some))} | {words} |'
    for words, is_clean in (('all corruptions', False), ('clean, nothing said', True)):
        some = [row for case, row in judged.items() if case.kind.startswith('clean') is is_clean]
        if some:
            yield f'| {words} | {share(sum(row["found"] for row in some), len(some))} | |'
    if options.kinds:
        missed = {case: row for case, row in judged.items() if not row['found']}
        yield from (f'Missed: {case.kind} {case.number}: {row["how"]}'
                    for case, row in missed.items())  # fmt: skip


CAMPAIGN: Final = Campaign(
    list_kinds, run, list_table, each=30,
    smoke='--kinds clean/simulated frozen/simulated --each 1',
)  # fmt: skip
