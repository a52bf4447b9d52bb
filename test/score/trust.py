"""
Score the trust checks: `make trust` (some minutes), or `make trust ARGS='--clean 40 --each 4'`.

Clean flights: 300 simulated ones and the real ones of `../shared/data`, where they are. Corrupted
ones: each kind so many times in simulated and in real flights. Every case is drawn from its own
number, kept as it is judged, and not judged again while checks and cases stay the same; the table
counts what was found (right kind, channel and interval) and what else was said. LTA_DATA names
another folder of real flights.
"""

import argparse
from collections import Counter
from collections.abc import Iterator
from functools import cache
import hashlib
import json
from pathlib import Path
import sys
from typing import Any, NamedTuple

import lta_data.data_quality
from lta_data.data_quality.duplicate_runs import find_duplicate_runs
from lta_data.data_quality.recording import ChannelRecording
from lta_data.data_quality.registry import QualityReport, run_checks
from lta_data.data_quality.roles import vector_name
from lta_flight.sweep.statistics import wilson_interval
import numpy as np
from numpy.random import Generator
from rich.progress import track
from trust_case import Corrupted
from trust_corruptions import CORRUPTIONS, twin
import trust_flights as flights

HERE = Path(__file__).resolve().parent
SLACK = 0.5  # seconds by which a found interval may miss the true one
POOL = 60  # simulated flights that corruptions are done to
TRIES = 500
NEVER = 'not applicable'


class Case(NamedTuple):
    """One case: kind ('clean' or a corruption), source ('simulated' or 'real') and number."""

    kind: str
    source: str
    number: int


@cache
def pooled(number: int) -> ChannelRecording:
    """Return a simulated flight that corruptions are done to; none of the clean set."""
    return flights.simulated(10_000 + number)


@cache
def real(number: int) -> ChannelRecording:
    """Return a real flight by number, Crazyflie first."""
    crazy, blimp = flights.crazyflie_files(), flights.rgblimp_files()
    return (
        flights.crazyflie(crazy[number])
        if number < len(crazy)
        else (flights.rgblimp(blimp[number - len(crazy)]))
    )


def drawn(source: str, rng: Generator) -> ChannelRecording:
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


def hits(report: QualityReport, case: Case, wrong: Corrupted) -> bool:
    """Whether a finding has the right kind, channel or vector or topic, and interval."""
    names = {*wrong.names, *map(vector_name, wrong.names)}
    names |= {name.rpartition('/')[0] for name in names if '/' in name}
    return any(
        finding.kind == case.kind
        and ({finding.channel, vector_name(finding.channel)} & names)
        and finding.from_s <= wrong.to_s + SLACK
        and finding.to_s >= wrong.from_s - SLACK
        for finding in report.findings
    )


def told(report: QualityReport) -> list[str]:
    """Return the kinds of what was found, the grave ones as they are, the others in brackets."""
    kinds = {f.kind if f.is_grave else f'({f.kind})' for f in report.findings}
    return sorted(kinds)


def judge(case: Case) -> dict[str, Any]:
    """Return what the checks say of a case."""
    if case.kind == 'clean':
        flight = (
            flights.simulated(case.number) if case.source == 'simulated' else real(case.number)
        )
        report = run_checks(flight)
        texts = [f'{f.kind} {f.channel}: {f.evidence}' for f in report.findings if f.is_grave]
        return {'found': not texts, 'told': told(report), 'how': '; '.join(texts[:3])}
    rng = np.random.default_rng([case.number, *case.kind.encode(), *case.source.encode()])
    if case.kind == 'twin':
        return judge_twin(case.source, rng)
    for _ in range(TRIES):
        wrong = CORRUPTIONS[case.kind](drawn(case.source, rng), rng)
        if wrong is not None:
            report = run_checks(wrong.recording)
            return {'found': hits(report, case, wrong), 'told': told(report), 'how': wrong.how}
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


def same(first: ChannelRecording, second: ChannelRecording) -> bool:
    """Whether two pieces may be of one flight: then a twin is right."""
    shared = [name for name in first.channels if name in second.channels]
    return any(
        np.isin(first.channels[name].values, second.channels[name].values).mean() > 0.2
        for name in shared
        if name.startswith(('ground_truth', 'imu')) and len(first.channels[name].values)
    )


def cases(clean: int, each: int, first: int) -> Iterator[Case]:
    """Yield all cases; drawn ones have numbers from `first` on."""
    count = len(flights.crazyflie_files()) + len(flights.rgblimp_files())
    yield from (Case('clean', 'simulated', number) for number in range(first, first + clean))
    yield from (Case('clean', 'real', number) for number in range(min(count, clean)))
    for kind in (*CORRUPTIONS, 'twin'):
        for source in ('simulated', *(['real'] if count else [])):
            yield from (Case(kind, source, number) for number in range(first, first + each))


def version() -> str:
    """Return a hash of what the score depends on: checks, flights, corruptions."""
    checks = sorted(Path(lta_data.data_quality.__file__).parent.glob('*.py'))
    digest = hashlib.sha256()
    for path in (*checks, *sorted(HERE.glob('trust*.py'))):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def scored(chosen: list[Case], kept: Path) -> dict[Case, dict[str, Any]]:
    """Judge what has not been judged by this version; every row is kept at once."""
    done: dict[Case, dict[str, Any]] = {}
    if kept.exists():
        for line in kept.read_text(encoding='utf-8').splitlines():
            row = json.loads(line)
            done[Case(*row.pop('case'))] = row
    with kept.open('a', encoding='utf-8') as file:
        for case in track(chosen, 'judging', disable=not sys.stderr.isatty()):
            if case not in done:
                done[case] = judge(case)
                file.write(json.dumps({'case': case, **done[case]}) + '\n')
                file.flush()
    return {case: done[case] for case in chosen}


def share(hit: int, count: int) -> str:
    """Return a share in words, with its 95 % interval."""
    found = wilson_interval(hit, count)
    return f'{hit:>4}/{count:<4} {100 * found.low:5.1f}..{100 * found.high:5.1f} %'


def table(rows: dict[Case, dict[str, Any]]) -> list[str]:
    """Return the lines of the table."""
    lines = [f'{"kind":<11} {"source":<10} {"right":<26} also said (cases)']
    groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for case, row in rows.items():
        if row['how'] != NEVER:
            groups.setdefault((case.kind, case.source), []).append(row)
    for (kind, source), found in groups.items():
        also = Counter(word for row in found for word in row['told'] if word.strip('()') != kind)
        words = ', '.join(f'{word} {count}' for word, count in also.most_common(8))
        right = share(sum(row['found'] for row in found), len(found))
        lines.append(f'{kind:<11} {source:<10} {right:<26} {words}')
    wrong = [
        row for case, row in rows.items() if case.kind not in ('clean',) and row['how'] != NEVER
    ]
    clean = [row for case, row in rows.items() if case.kind == 'clean']
    lines.append(f'all kinds found   {share(sum(row["found"] for row in wrong), len(wrong))}')
    lines.append(f'clean, false      {share(sum(not row["found"] for row in clean), len(clean))}')
    return lines


def main() -> None:
    """Print the table, and what was missed."""
    parser = argparse.ArgumentParser(description='Score the trust checks.')
    parser.add_argument('--clean', type=int, default=300, help='simulated clean flights')
    parser.add_argument('--each', type=int, default=30, help='corruptions of each kind and source')
    parser.add_argument(
        '--out', type=Path, default=Path('runs') / 'trust', help='where rows are kept'
    )
    parser.add_argument('--first', type=int, default=1000, help='number of the first case')
    parser.add_argument('--missed', action='store_true', help='say what was missed')
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    kept = asked.out / f'{version()}.jsonl'
    rows = scored(list(cases(asked.clean, asked.each, asked.first)), kept)
    sys.stdout.write('\n'.join(table(rows)) + f'\nrows in {kept}\n')
    if asked.missed:
        for case, row in rows.items():
            if not row['found'] and row['how'] != NEVER:
                sys.stdout.write(f'{case.kind} {case.source} {case.number}: {row["how"]}\n')


if __name__ == '__main__':
    main()
