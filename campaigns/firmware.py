# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run the bridge against the real Crazyflie firmware.

Builds the firmware of `--firmware` (a checkout of bitcraze/crazyflie-firmware, 2026.08) for Linux
(firmware/crazyflie/linux) as it is sold, with arming required and with our app. With `--record`,
plays every script of `firmware_scenarios.py` to each build, runs the suite for any Crazyflie
against it, and stores the outcomes in test/golden/crazyflie_firmware.json, with which a test
compares the emulator. Kinds are faults in flight, each on each build: `app/silent`.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
import hashlib
import json
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
from typing import Any, Final

from firmware_scenarios import APP, app_files, ARMING, BUILDS, SOLD

from campaigns import ROOT
from campaigns.fault_kinds import KINDS
from campaigns.faults import format_times
from campaigns.firmware_record import DUTIES, record, VOLTAGES
from campaigns.firmware_trial import fly, IMPOSSIBLE
from campaigns.harness import Campaign, Case, count_right, Row, Rows
from campaigns.linux_crazyflie import build, commit_of, Process

RECORD: Final = ROOT / 'test/golden/crazyflie_firmware.json'
SUITE: Final = 'test/integration/test_any_crazyflie.py'
PASSED: Final = re.compile(r'(\d+) (passed|failed|skipped|error)')
WORDS: Final = {SOLD: 'as sold', ARMING: 'arming required', APP: 'with our app'}
POSSIBLE: Final = tuple(name for name in KINDS if name not in IMPOSSIBLE)


def add_arguments(parser: ArgumentParser) -> None:
    """Add the sources, and what is done with them beside the faults."""
    parser.add_argument('--firmware', type=Path, help='folder of the sources, at tag 2026.08')
    parser.add_argument('--record', action='store_true', help='play the scripts and the suite')


def check_sources(options: Namespace) -> Path:
    """Return the folder of the sources; exit where there are none."""
    if not options.firmware or not (options.firmware / 'src/modules/src/supervisor.c').is_file():
        sys.exit(
            'Give the sources with --firmware; clone bitcraze/crazyflie-firmware and check out '
            '2026.08.'
        )
    folder: Path = options.firmware.resolve()
    return folder


def find_programs(options: Namespace) -> dict[str, Path]:
    """Return the program of each build."""
    return {name: options.out.resolve() / name / 'crazyflie' for name in BUILDS}


def prepare(options: Namespace) -> None:
    """Build the programs, and record what they do where that is asked for."""
    sources = check_sources(options)
    for name in BUILDS:
        build(sources, name, options.out.resolve())
    if not options.record:
        return
    facts = {'commit': commit_of(sources), 'ours': hash_files(app_files())}
    builds = {
        name: {**facts, **record(program), 'suite': run_suite(program)}
        for name, program in find_programs(options).items()
    }
    RECORD.write_text(json.dumps({'builds': builds}, indent=1) + '\n')


def hash_files(paths: list[Path]) -> str:
    """Return a hash of files."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def run_suite(program: Path) -> dict[str, int]:
    """Run the suite for any Crazyflie against a build; return how many tests did what."""
    with Process(program) as process:
        environment = os.environ | {
            'LTA_CF_URI': process.uri,
            'LTA_CF_RESTART': f'kill -{signal.SIGUSR1} {process.pid}; sleep 0.5',
        }
        words = [sys.executable, '-m', 'pytest', '-q', SUITE, '-k', 'app']
        done = subprocess.run(
            words, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
        )
    if done.returncode:
        sys.stderr.write(f'The suite failed against {program}.\n')
    lines = done.stdout.splitlines()
    sys.stdout.write('\n'.join(line for line in lines if 'one build' not in line) + '\n')
    return {word: int(count) for count, word in PASSED.findall(lines[-1])}


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a flight."""
    name, _, kind = case.kind.partition('/')
    return fly(find_programs(options)[name], kind, case.number)


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield what was recorded of the builds, and the faults in flight."""
    yield from list_record(json.loads(RECORD.read_text()))
    yield ''
    yield f'| fault | {" | ".join(WORDS[name] for name in BUILDS)} |'
    yield '|---' * (1 + len(BUILDS)) + '|'
    for name in POSSIBLE:
        cells = []
        for each in BUILDS:
            some = [row for case, row in rows.items() if case.kind == f'{each}/{name}']
            cells.append(format_flights(some))
        yield f'| {KINDS[name].about} | {" | ".join(cells)} |'


def format_flights(rows: Sequence[Row]) -> str:
    """Return the longest time until the motors stopped, and how many were right if not all."""
    longest = format_times(0.0, rows)
    return longest if all(not row['wrong'] for row in rows) else f'{longest}; {count_right(rows)}'


def list_record(kept: dict[str, Any]) -> Iterator[str]:
    """Yield the tables of the suite and of duties."""
    suites = [kept['builds'][name].get('suite', {}) for name in BUILDS]
    heads = ' | '.join(WORDS[name] for name in BUILDS)
    yield f'| test suite | {heads} |'
    yield '|---' * (1 + len(BUILDS)) + '|'
    counts = (', '.join(f'{count} {word}' for word, count in one.items()) for one in suites)
    yield f'| `{SUITE}` | {" | ".join(counts)} |'
    yield ''
    volts = ' | '.join(f'{voltage:g} V' for voltage in VOLTAGES)
    yield f'| duty | our app: {volts} | as sold: {volts} |'
    yield '|---' * (1 + 2 * len(VOLTAGES)) + '|'
    yield from list_ratios(kept)


def list_ratios(kept: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of the table of duties."""
    for place, duty in enumerate(DUTIES):
        cells = [
            f'{kept["builds"][name]["ratios"][f"{voltage:g}"][place][1]:.3f}'
            for name in (APP, SOLD)
            for voltage in VOLTAGES
        ]
        yield f'| {duty:.2f} | ' + ' | '.join(cells) + ' |'


CAMPAIGN: Final = Campaign(
    lambda options: [f'{name}/{kind}' for kind in POSSIBLE for name in BUILDS],
    run, list_table, each=20, add_arguments=add_arguments, page='hardware_firmware.md',
    alone=True, side=0, patience=240.0, prepare=prepare,
)  # fmt: skip
