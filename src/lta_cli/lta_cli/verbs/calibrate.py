"""lta calibrate: estimate the numbers that a vehicle file must have, from flights."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import RobotOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_discovery.calibration.run import calibrate_vehicle
from lta_discovery.progress import DiscoverProgress
from lta_report.report import Report
import typer


@report_command('calibrate')
def calibrate(
    run: StudyRun,
    vehicle: Annotated[str, typer.Option(help='Vehicle to calibrate, name or file.')],
    train: Annotated[
        list[Path],
        typer.Option(
            metavar='BAG...',
            help='Flights to calibrate with. Bag folders, results folders or .mcap files.',
        ),
    ],
    confirm: Annotated[
        list[Path] | None,
        typer.Option(
            metavar='BAG...', help='Other flights, whose forecasts test the calibration.'
        ),
    ] = None,
    robot: RobotOption = None,
) -> Report:
    """
    Calibrate a vehicle file from flights: gains, delay, lift, markers, balance.

    Estimates what every lab must settle before it asks for missing effects: gain and sign of each
    commanded axis or rotor, delay of the commands, net lift of each flight and its trend, rotation
    and lever arm of the marker frame, tilt of the tracker, mass, inertia and balance, and sensor
    errors. The vehicle file may be far off. Each value has a 95 % interval, and a remark if the
    flights cannot separate it from others.

    Writes calibrated.yaml, a vehicle file for all other commands, a page and calibrate.json. If no
    calibration forecasts the training flights better than the vehicle file, it writes none.

    A flight without commands must be a free swing: on the spot, as a pendulum, ever less. Any
    other one is refused.

    Exit status 0: done. 2: bad input, or flights too poor to analyse.

    Example: lta calibrate --vehicle gtmab --train A B --confirm C
    """
    with DiscoverProgress(run.console) as progress:
        return calibrate_vehicle(
            vehicle, {'train': train, 'confirm': confirm or []}, robot, progress.show_stage
        )
