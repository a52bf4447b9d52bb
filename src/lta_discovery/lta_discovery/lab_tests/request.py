# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta tests plan`, `lta tests read` and `lta tests between` take."""

from pathlib import Path
from typing import Any, final

from lta_data.importers.draft.choices import Answers
from lta_discovery.lab_tests.design import LONGEST_WAY
from lta_discovery.lab_tests.plan import plan_lab_tests
from lta_discovery.lab_tests.reading import read_lab_tests
from lta_discovery.lab_tests.rehearsal import Commands
from lta_discovery.progress import DiscoverProgress
from lta_model.vehicle import load_vehicle
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, ROBOT, StudyRun, VEHICLE_NAME

WRENCH_OPTION: Any = option(
    'The vehicle is commanded by force and moment instead of duties.', default=False
)
ROOM: Any = option(
    'Longest way of a test in metres; steps are made smaller.', default=LONGEST_WAY, low=0.5
)


@final
class LabPlanRequest(ReportRequest, command='tests plan', folder='tests-plan'):
    """
    List the tests of an afternoon with a tracker that calibrate a vehicle.

    It needs the logged position and attitude of the vehicle (motion capture, or a camera that sees
    markers on it) and its commands, on one clock. Weigh it, let it float, let it swing, a step on
    each commanded axis, a spin-down, and two free flights; for each why, how long, how large, and
    what can go wrong. All follows from the vehicle file: each test is rehearsed with its model,
    and listed if its poses teach something that shorter tests do not. The page can be printed.

    Exit status 0: done. 2: bad input.

    Example: lta tests plan gtmab --room 3
    """

    vehicle: str = VEHICLE_NAME
    wrench: bool = WRENCH_OPTION
    room: float = ROOM

    def run(self, run: StudyRun) -> Report:
        """Return the report of the plan."""
        from lta_discovery.lab_tests.plan_report import build_plan_report

        vehicle = load_vehicle(self.vehicle)
        plan = plan_lab_tests(
            vehicle, self.vehicle, 'wrench' if self.wrench else 'rotors', self.room
        )
        return build_plan_report(plan, vehicle)


@final
class LabReadingRequest(ReportRequest, command='tests read', folder='tests-read'):
    """
    Calibrate a vehicle from the logs of its tests, and say which tests are missing.

    Reads bags, and all formats of lta import, whose mapping it drafts if there is none. Which test
    a log holds follows from its motion and commands: a float, a swing, a step, a spin-down, or a
    free flight. The last of several free flights confirms the calibration (lta calibrate) from the
    others.

    Writes calibrated.yaml, a page, read.json, and the mapping that it drafted.

    Exit status 0: done. 2: bad input, or logs too poor to analyse.

    Example: lta tests read afternoon --vehicle gtmab
    """

    logs: Path = argument('Folder with the logs: one for each test.', metavar='FOLDER')
    vehicle: str = option('Vehicle to calibrate, name or file.', complete='vehicle')
    mapping: str | None = option(
        'Mapping of logs that are no bags. By default NAME.yaml beside the log, or mapping.yaml '
        'in the folder; without both it is drafted.',
        default=None,
    )
    answers: Answers = option(
        'Decide a question of the draft, such as time.rate=60. Repeatable.', default={},
        name='set', metavar='KEY=VALUE',
    )  # fmt: skip
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report with the calibrated vehicle file."""
        from lta_discovery.lab_tests.reading import build_reading_report

        with DiscoverProgress(run.console) as progress:
            reading = read_lab_tests(
                self.vehicle, self.logs, self.mapping, self.answers, self.robot,
                progress.show_stage,
            )  # fmt: skip
        return build_reading_report(reading)


@final
class SeparatingTestRequest(ReportRequest, command='tests between', folder='tests-between'):
    """
    Find the test that tells two effects of a vehicle apart.

    Each test of "lta tests plan" is rehearsed with the vehicle file, as a tracker sees it. Says
    which one is expected to favour the true effect clearly, or what to measure where none does.

    Exit status 0: done. 2: bad input.

    Example: lta tests between linear_drag.surge added_mass.surge --vehicle gtmab
    """

    first: str = argument('Effect, such as linear_drag.surge.')
    second: str = argument('Another effect.')
    vehicle: str = option('Vehicle name or file.', complete='vehicle')
    wrench: bool = WRENCH_OPTION
    room: float = ROOM

    def run(self, run: StudyRun) -> Report:
        """Return the report of the tests."""
        from lta_discovery.lab_tests.between import build_separation_report, rate_tests

        pair = self.first, self.second
        commands: Commands = 'wrench' if self.wrench else 'rotors'
        rated = rate_tests(load_vehicle(self.vehicle), *pair, commands, self.room)
        return build_separation_report(self.vehicle, pair, rated)
