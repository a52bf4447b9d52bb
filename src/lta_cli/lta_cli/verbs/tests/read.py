"""lta tests read: calibrate a vehicle from the logs of its tests."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import RobotOption
from lta_cli.options.draft_command import parse_settings
from lta_cli.options.study_command import report_command, StudyRun
from lta_discovery.lab_tests.reading import read_lab_tests
from lta_discovery.lab_tests.reading_report import build_reading_report
from lta_discovery.progress import DiscoverProgress
from lta_report.report import Report
import typer


@report_command('tests-read')
def read(
    run: StudyRun,
    folder: Annotated[Path, typer.Argument(help='Folder with the logs: one for each test.')],
    vehicle: Annotated[str, typer.Option(help='Vehicle to calibrate, name or file.')],
    mapping: Annotated[
        str | None,
        typer.Option(
            help='Mapping of logs that are no bags. By default NAME.yaml beside the log, or '
            'mapping.yaml in the folder; without both it is drafted.'
        ),
    ] = None,
    set: Annotated[
        list[str] | None,
        typer.Option(
            '--set',
            metavar='KEY=VALUE',
            help='Decide a question of the draft, such as time.rate=60. Repeatable.',
        ),
    ] = None,
    robot: RobotOption = None,
) -> Report:
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
    with DiscoverProgress(run.console) as progress:
        reading = read_lab_tests(
            vehicle, folder, mapping, parse_settings(set or []), robot, progress.show_stage
        )
    return build_reading_report(reading)
