# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Calibrate a vehicle from the logs of a laboratory, say which tests are missing, and report."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, final

from lta_config.errors import format_count
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.result import Calibration
from lta_discovery.calibration.run import report_calibration
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.flights.usable_flights import (
    CALIBRATION_TIME,
    select_usable_flights,
    SHORTEST_TRAINING,
    UsableFlights,
)
from lta_discovery.formatting import join_words
from lta_discovery.lab_tests.design import LabTest
from lta_discovery.lab_tests.log_folder import open_lab_folder
from lta_discovery.lab_tests.plan import is_thrust_law, LabPlan, plan_lab_tests, PlannedTest
from lta_discovery.lab_tests.recognition import recognise_tests, RecognisedTest
from lta_discovery.lab_tests.words import format_instruction, name_parameters
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import Report, TextSection, TextTable

Tell = Callable[[str, float | None], None]

MOST_NAMES: Final = 4  # parameters that a sentence names at most
SAME_STEP_SHARE: Final = 0.75  # of the largest step of an axis; a smaller one has another size
PAIR: Final = 2  # free flights of an afternoon


@final
@dataclass(frozen=True, slots=True)
class LabReading:
    """What the logs of a folder show."""

    vehicle: Vehicle
    calibration: Calibration
    tests: Mapping[str, tuple[RecognisedTest, ...]]  # of each flight
    seconds: Mapping[str, float]  # usable time of each flight [s]
    missing: tuple[str, ...]  # what would teach more, one sentence each
    drafts: Mapping[str, str]  # drafted mappings by file name


def read_lab_tests(
    name: str,
    folder: Path,
    mapping: str | None,
    answers: Mapping[str, str],
    robot: str | None,
    tell: Tell,
) -> LabReading:
    """
    Calibrate a vehicle from the logs in a folder.

    The last of several free flights confirms the calibration.

    `mapping`: of the logs that are no bags; drafted by default. `answers`: decisions for drafts,
    by key. Raise `BadInput` if the logs cannot be read, or are too poor to analyse.
    """
    vehicle = load_vehicle(name)
    with TemporaryDirectory(prefix='lta-tests-') as scratch:
        logs = open_lab_folder(
            folder, mapping, answers, name, Path(scratch), lambda what: tell(what, None)
        )
        recordings = read_bags(
            {'train': logs.bags}, robot, lambda bag: tell(f'reading {bag}', None)
        )
    tell('checking data quality', None)
    usable = select_usable_flights(recordings, vehicle, CALIBRATION_TIME)
    tests = {title: recognise_tests(flight, vehicle) for title, _, flight in usable.flights}
    calibration = calibrate_flights(vehicle, name, _hold_back_flight(usable, tests).flights, tell)
    calibration = replace(calibration, warnings=(*logs.notes, *usable.warnings))
    wrench = any(flight.wrench is not None for _, _, flight in usable.flights)
    plan = plan_lab_tests(vehicle, name, 'wrench' if wrench else 'rotors')
    seconds = {
        title: GRID_PERIOD * float(flight.usable.sum()) for title, _, flight in usable.flights
    }
    missing = tuple(list_missing_tests(plan, tests, calibration, vehicle.rotor_names))
    return LabReading(vehicle, calibration, tests, seconds, missing, logs.drafts)


def _is_free(tests: Sequence[RecognisedTest]) -> bool:
    """Return whether a log is a free flight."""
    return any(one.kind == 'free_flight' for one in tests)


def _hold_back_flight(
    usable: UsableFlights, tests: Mapping[str, Sequence[RecognisedTest]]
) -> UsableFlights:
    """Return the flights with the last free one as confirmation, if the others suffice."""
    free = [title for title, _, _ in usable.flights if _is_free(tests[title])]
    others = sum(
        GRID_PERIOD * float(flight.usable.sum())
        for title, _, flight in usable.flights
        if title not in free[-1:]
    )
    if len(free) < PAIR or others < SHORTEST_TRAINING:
        return usable
    flights = tuple(
        (title, 'confirm' if title == free[-1] else role, flight)
        for title, role, flight in usable.flights
    )
    return replace(usable, flights=flights)


def list_missing_tests(
    plan: LabPlan,
    tests: Mapping[str, Sequence[RecognisedTest]],
    calibration: Calibration,
    rotors: Sequence[str],
) -> list[str]:
    """Return a sentence for each test that is missing and would teach what is not known yet."""
    done = [one for each in tests.values() for one in each]
    out = []
    for planned in plan.tests:
        if not planned.is_needed or _is_done(planned.test, done):
            continue
        unknown = [name for name, _ in planned.informs if _is_unknown(name, calibration)]
        if unknown:
            out.append(_format_missing(planned, unknown, rotors))
    free = sum(_is_free(each) for each in tests.values())
    if free == 1:
        out.append(
            'Only one free flight: no other one confirms the calibration; fly a second one of the '
            'same kind.'
        )
    return out


def _is_done(test: LabTest, done: Sequence[RecognisedTest]) -> bool:
    """Return whether a test is among the recognised ones; a variant needs a step beside it."""
    sizes = [one.size for one in done if (one.kind, one.axis) == (test.kind, test.axis)]
    if not test.variant or not sizes:
        # One sentence on the step is enough, if there is none at all
        return bool(sizes or test.variant)
    if test.variant == 'reverse':
        return min(sizes) < 0.0 < max(sizes)
    most = max(map(abs, sizes))
    return any(abs(size) < SAME_STEP_SHARE * most for size in sizes)


def _is_unknown(name: str, calibration: Calibration) -> bool:
    """Return whether the flights have not taught a parameter."""
    values = [one for one in calibration.values if one.name == name]
    return not any(one.is_known for one in values)


def _format_missing(planned: PlannedTest, unknown: Sequence[str], rotors: Sequence[str]) -> str:
    """Return the sentence of a missing test."""
    words = name_parameters(unknown, rotors)
    names = join_words(words[:MOST_NAMES]) + (' and more' if len(words) > MOST_NAMES else '')
    several = len(words) > 1 or ' and ' in names
    if all(map(is_thrust_law, unknown)):
        # Without a second size or direction, they are those of a proportional command
        return (
            f'No {planned.test.name}: {names} cannot be told from the gain; '
            f'{format_instruction(planned.test)}.'
        )
    return (
        f"No {planned.test.name}: {names} {'stay' if several else 'stays'} the file's; "
        f'{format_instruction(planned.test)}.'
    )


def build_reading_report(reading: LabReading) -> Report:
    """Return the report of a calibration with the recognised tests and what is missing."""
    report = report_calibration(reading.vehicle, reading.calibration.vehicle, reading.calibration)
    confirming = reading.calibration.bags.get('confirm', ())
    rows = [
        [
            name,
            ', '.join(one.title for one in tests),
            f'{reading.seconds[name]:.0f} s',
            'confirms' if name in confirming else 'teaches',
            '; '.join(one.evidence for one in tests),
        ]
        for name, tests in reading.tests.items()
    ]
    table = TextTable('Tests', ('log', 'test', 'usable', 'use', 'recognised by'), rows)
    words = reading.missing or ('Nothing: the tests show all that tests can show.',)
    missing = TextSection('What is missing', words, bullets=True, printed=True)
    tests = {
        name: {
            'use': 'confirm' if name in confirming else 'train',
            'seconds': reading.seconds[name],
            'tests': [one._asdict() for one in tests],
        }
        for name, tests in reading.tests.items()
    }
    assert isinstance(report.data, dict)
    return replace(
        report,
        command='tests read',
        blocks=(table, missing, *report.blocks),
        data={**report.data, 'tests': tests, 'missing': list(reading.missing)},
        closing=(*report.closing, _format_missing_count(len(reading.missing))),
        outputs={**report.outputs, **reading.drafts},
    )


def _format_missing_count(count: int) -> str:
    """Return how much is missing, in a sentence."""
    if not count:
        return 'No test is missing.'
    return f'{format_count(count, "test")} would teach more: see What is missing.'
