"""
The real Crazyflie firmware under the bridge: `make real-firmware FIRMWARE=/path/to/sources`.

Builds the firmware for Linux (firmware/crazyflie/linux) as it is sold, with arming required and
with our app. Plays every script of `firmware_scenarios.py` and stores the outcomes in
test/golden/crazyflie_firmware.json, with which a test compares the emulator. Runs the suite for
any Crazyflie against each build, flies each fault 20 times on each, and writes
docs/hardware_firmware.md. The faults take hours and resume; `--steps record suite` skips them.
"""

import argparse
from collections.abc import Iterator
import json
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
from typing import Any, Final

import add_paths  # noqa: F401
from campaign import (
    campaign,
    Case,
    codes,
    count_flights,
    describe_lateness,
    list_flown_files,
    read_stored,
    Row,
    store,
    StoredCampaign,
    tried,
    turn_about,
)
from campaign import kept as flown
from campaign import told as printed
from campaign import version as hashed
from fault_kinds import Kind, KINDS, SLACK
from firmware_picture import draw
from firmware_record import DUTIES, record, VOLTAGES
from firmware_scenarios import APP, app_files, ARMING, BUILDS, SCENARIOS, SOLD
from firmware_trial import IMPOSSIBLE
from linux_crazyflie import build, commit_of, Process
from slow_clock import slow_down

HERE: Final = Path(__file__).resolve().parent
ROOT: Final = HERE.parents[1]
RECORD: Final = ROOT / 'test/golden/crazyflie_firmware.json'
FLIGHTS: Final = ROOT / 'test/golden/hardware_firmware.json'
PAGE: Final = ROOT / 'docs/hardware_firmware.md'
PICTURE: Final = ROOT / 'docs/images/firmware_motors.svg'
SUITE: Final = 'test/integration/test_any_crazyflie.py'
STEPS: Final = ('record', 'suite', 'faults', 'page')
EACH: Final = 20  # flights of each fault
FLOWN: Final = '## Faults in flight'
HUNG: Final = 240.0  # s after which a flight hangs
PASSED: Final = re.compile(r'(\d+) (passed|failed|skipped|error)')
WORDS: Final = {SOLD: 'as sold', ARMING: 'arming required', APP: 'with our app'}
POSSIBLE: Final = tuple(name for name in KINDS if name not in IMPOSSIBLE)


def cases(builds: list[str], each: int) -> list[Case]:
    """Return all flights, every kind on every build by turns."""
    return turn_about([f'{name}/{kind}' for kind in POSSIBLE for name in builds], each)


def version(commit: str) -> str:
    """Return a hash of what the outcomes depend on: flying code, app, trial and firmware."""
    code = hashed([
        *list_flown_files(),
        *HERE.glob('fault_*.py'),
        HERE / 'firmware_trial.py',
        HERE / 'linux_crazyflie.py',
        *app_files(),
    ])  # fmt: skip
    return f'{code}-{commit}'


def suite(program: Path) -> dict[str, int]:
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


def fault_rows(outcomes: dict[Case, Row]) -> Iterator[str]:
    """Yield the lines of the table of faults."""
    for name in POSSIBLE:
        cells = []
        for each in BUILDS:
            found = [row for case, row in outcomes.items() if case.kind == f'{each}/{name}']
            times = [row['took'] for row in found if row['took'] is not None]
            stated = KINDS[name].stated[each != APP]
            well = sum(not row['wrong'] for row in found)
            longest = f'{max(times):.2f} s' if times else '-'
            cells.append(f'{stated:.1f} s; {longest}; {well} of {len(found)}')
        yield f'| {KINDS[name].about} | {fate(KINDS[name])} | ' + ' | '.join(cells) + ' |'


def fate(kind: Kind) -> str:
    """Return what becomes of a flight, in words."""
    return 'flies on, and lands on request' if kind.flies_on else kind.ends


def ratio_rows(kept: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of the table of duties."""
    for place, duty in enumerate(DUTIES):
        cells = [
            f'{kept["builds"][name]["ratios"][f"{voltage:g}"][place][1]:.3f}'
            for name in (APP, SOLD)
            for voltage in VOLTAGES
        ]
        yield f'| {duty:.2f} | ' + ' | '.join(cells) + ' |'


def scenario_rows(kept: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of the table of outcomes."""
    for name, scenario in SCENARIOS.items():
        cells = []
        for each in BUILDS:
            told = kept['builds'][each]['scenarios'].get(name, ())
            cells.append(
                ', '.join(f'{motors} {word:#04x} at {at:.1f} s' for at, word, motors in told)
            )
        yield f'| {scenario.about} | ' + ' | '.join(cells) + ' |'


def compose_page(kept: dict[str, Any], stored: StoredCampaign) -> str:
    """Return the page, from what was recorded of the firmware and its flights."""
    return compose_record(kept, stored.facts['suites']) + compose_flights(stored.rows)


def compose_record(kept: dict[str, Any], suites: dict[str, dict[str, int]]) -> str:
    """Return the page's part on the suite, the duties and the scripts."""
    suite_cells = ' | '.join(
        ', '.join(f'{count} {word}' for word, count in suites.get(name, {}).items()) or '-'
        for name in BUILDS
    )
    heads = ' | '.join(WORDS[name] for name in BUILDS)
    volts = ' | '.join(f'{voltage:g} V' for voltage in VOLTAGES)
    lines = [
        '# The real Crazyflie firmware',
        '',
        '`make real-firmware FIRMWARE=/path/to/crazyflie-firmware` writes this page. It compiles '
        "the firmware's own files for Linux",
        f'(commit `{kept["builds"][APP]["commit"]}`) in three builds: as sold, which arms itself; '
        'with `CONFIG_MOTORS_REQUIRE_ARMING=y` and nothing else; and with our app and',
        '`firmware/crazyflie/app-config`. Sensors, radio and processor are stubs: a body that '
        'rises and sinks, UDP, and POSIX threads of which one runs at a time.',
        'Nothing here ran on a real drone.',
        '',
        '## Test suite for any Crazyflie',
        '',
        f'`{SUITE}`, through cflib and the bridge:',
        '',
        f'| {heads} |',
        '|---|---|---|',
        f'| {suite_cells} |',
        '',
        'Skipped: a build as sold arms itself, so it is never unarmed and does not stay disarmed; '
        'builds without the app do not accept duties.',
        '',
        '## Duties',
        '',
        'The table shows the PWM ratio that the compiled `motors.c` sets for a commanded duty. '
        'Our build passes the duty on. A build as sold corrects it for the voltage, with the '
        'curve of its propellers.',
        '',
        f'| duty | our app: {volts} | as sold: {volts} |',
        '|---' * (1 + 2 * len(VOLTAGES)) + '|',
        *ratio_rows(kept),
        '',
        '## Behaviour of the supervisor',
        '',
        '![Motors turning, idle and stopped in each script, by build](images/firmware_motors.svg)',
        '',
        'The table shows when the motors changed, and the status word of the supervisor at that '
        'time. A script arms at 0.2 s, flies from 0.4 s on, and in most cases injects its event '
        'at 1.5 s. *turn*: motors turn; *still*: the pins are low; *idle*: all motors at the idle '
        'thrust.',
        '',
        f'| script | {heads} |',
        '|---' * (1 + len(BUILDS)) + '|',
        *scenario_rows(kept),
        '',
        'A test compares the emulator with this table (`test_firmware_contract.py`).',
        '',
    ]
    return '\n'.join(lines) + '\n'


def compose_flights(outcomes: dict[Case, Row]) -> str:
    """Return the page's part on faults in flight."""
    heads = ' | '.join(WORDS[name] for name in BUILDS)
    wrong = [
        f'- {case.kind}, flight {case.number}: {row["wrong"]}.'
        for case, row in outcomes.items()
        if row['wrong']
    ]
    left_out = ', '.join(KINDS[name].about for name in IMPOSSIBLE)
    lines = [
        FLOWN,
        '',
        'These are the faults [of the emulated drone](hardware_faults.md), by duties with our app '
        'and by setpoints on the other builds. Each cell has the stated time until the motors '
        f'stop ({SLACK:.0f} s more counts as stated, as the machine has other work), the longest '
        'measured time, and how many flights were as stated.',
        f'{count_flights(outcomes)} ({codes(outcomes)}). '
        f'{describe_lateness(outcomes.values())} The rows are in '
        '`test/golden/hardware_firmware.json`.',
        'The 0.3 s after a bridge is killed apply only to our app: other builds fly their last '
        'setpoint for 2 s and then lock.',
        f'Left out, because this firmware cannot be forced into it: {left_out}.',
        '',
        f'| fault | outcome of the flight | {heads} |',
        '|---' * (2 + len(BUILDS)) + '|',
        *fault_rows(outcomes),
        *(['', 'Not as stated:', '', *wrong] if wrong else []),
    ]
    return '\n'.join(lines) + '\n'


def parsed() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1] if __doc__ else '')
    parser.add_argument('firmware', type=Path, help='folder of the sources, at tag 2026.08')
    parser.add_argument('--builds', nargs='*', default=list(BUILDS), choices=BUILDS)
    parser.add_argument('--steps', nargs='*', default=list(STEPS), choices=STEPS)
    parser.add_argument('--each', type=int, default=EACH, help='flights of each fault')
    parser.add_argument('--side', type=int, default=os.cpu_count() or 1, help='side by side')
    parser.add_argument('--slower', type=int, default=1, help='let time pass so much more slowly')
    parser.add_argument('--out', type=Path, default=Path('runs/firmware'))
    words = parser.parse_args()
    if not (words.firmware / 'src/modules/src/supervisor.c').is_file():
        parser.error(
            f'{words.firmware} has no firmware sources; clone bitcraze/crazyflie-firmware there '
            'and check out 2026.08.'
        )
    words.firmware, words.out = words.firmware.resolve(), words.out.resolve()
    words.out.mkdir(parents=True, exist_ok=True)
    return words


def main() -> int:
    """Do the steps; 1 where anything was not as stated."""
    words, status = parsed(), 0
    commit = commit_of(words.firmware)
    programs = {name: build(words.firmware, name, words.out) for name in words.builds}
    kept = json.loads(RECORD.read_text()) if RECORD.exists() else {'builds': {}}
    suites_file = words.out / 'suites.json'
    # Without a run of the suite in this folder, those of the page stand
    suites = read_stored(FLIGHTS).facts['suites'] if FLIGHTS.exists() else {}
    if suites_file.exists():
        suites = json.loads(suites_file.read_text())
    if 'record' in words.steps:
        kept['builds'] |= {
            name: {'commit': commit, 'ours': hashed(app_files()), **record(program)}
            for name, program in programs.items()
        }
        RECORD.write_text(json.dumps(kept, indent=1) + '\n')
    if 'suite' in words.steps:
        suites |= {name: suite(program) for name, program in programs.items()}
        suites_file.write_text(json.dumps(suites))
        status |= any(
            {'failed', 'error'} & counts.keys() or not counts.get('passed')
            for counts in suites.values()
        )
    os.environ['LTA_FIRMWARE_BUILDS'] = str(words.out)
    path = words.out / f'{version(commit)}.jsonl'
    if 'faults' in words.steps:
        slow_down(words.slower, words.out)
        campaign(
            cases(words.builds, words.each),
            path,
            words.side,
            lambda case: tried(case, HERE / 'firmware_trial.py', HUNG),
        )
    outcomes = flown(path)
    status |= printed(list(fault_rows(outcomes)), path, outcomes)
    if 'page' in words.steps:
        PICTURE.write_text(draw(kept['builds']))
        if outcomes:
            stored = store(FLIGHTS, StoredCampaign({'suites': suites}, outcomes))
            PAGE.write_text(compose_page(kept, stored))
        else:  # those on the page are of an earlier campaign
            page = PAGE.read_text()
            PAGE.write_text(compose_record(kept, suites) + page[page.index(FLOWN) :])
    return status


if __name__ == '__main__':
    sys.exit(main())
