"""lta light calibrate: measure response and gains of the photodiodes by a turn in place."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import RobotOption, VehicleOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_report.report import Report
from lta_studies.light.turntable.report import build_calibration_report
from lta_studies.light.turntable.response import fit_response
from lta_studies.light.turntable.turntable import (
    read_turn,
    summarize_directions,
    TurntableMotion,
    zero_offset,
)
from lta_vlc.settings import DemodulationSettings
import typer


@report_command('calibrate')
def calibrate(
    bag: Annotated[Path, typer.Argument(help='Bag of a turn in place in front of the lamp.')],
    vehicle: VehicleOption = 'gtmab',
    frequency: Annotated[
        float, typer.Option(help='Flicker frequency of the lamp in Hz.', min=1.0, max=1e5)
    ] = DemodulationSettings().frequency,
    topic: Annotated[str, typer.Option(help='Odometry topic with the heading.')] = 'odom',
    distance: Annotated[
        float, typer.Option(help='Distance from the photodiodes to the lamp in metres.', min=0.3)
    ] = 3.0,
    robot: RobotOption = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Measure the response and the gains of the photodiodes by a turn in place.

    Turn the drone by 360 degrees or more, 3 m from the lamp, in 20 s or more: in hover, or by
    hand. Prints the entries for the vehicle file. The demodulator then knows the photodiodes,
    and its bearings are more accurate. On a turntable use "lta hardware light".

    Exit status 0: done. 2: bad input.

    Example: lta light calibrate runs/turn
    """
    motion = TurntableMotion(heading=topic)
    readings, diodes = read_turn(bag, robot, vehicle, frequency, motion, run.console)
    zero = zero_offset(readings)
    study, _ = summarize_directions(readings, 'turn', zero)
    facts = {'bag': str(bag), 'vehicle': vehicle}
    return build_calibration_report(
        study, readings, fit_response(readings, diodes, zero, distance), diodes, facts
    )
