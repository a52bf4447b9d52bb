# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of the logs of a laboratory: the calibration, the tests, what is missing."""

from dataclasses import replace

from lta_discovery.calibration.run import report_calibration
from lta_discovery.lab_tests.reading import LabReading
from lta_report.formatting import format_count
from lta_report.report import Report, TextSection, TextTable


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
