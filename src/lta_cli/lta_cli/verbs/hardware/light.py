"""lta hardware light: evaluate a recording of a light board on a turntable."""

import math
from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import RobotOption, VehicleOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_config.errors import BadInput
from lta_report.report import Report
from lta_studies.light.turntable.report import build_report, format_vehicle_lines
from lta_studies.light.turntable.response import fit_response
from lta_studies.light.turntable.turntable import (
    read_turn,
    summarize_directions,
    TurntableMotion,
    zero_offset,
)
from lta_vlc.settings import DemodulationSettings
import typer


@report_command('turntable')
def light(
    bag: Annotated[
        Path, typer.Argument(help='Bag recorded from the light board, with photodiode readings.')
    ],
    rate: Annotated[
        float, typer.Option(help='Constant speed of the turntable in deg/s, counter-clockwise.')
    ] = 0.0,
    step: Annotated[
        float, typer.Option(help='Turntable step in degrees, instead of --rate; needs --hold.')
    ] = 0.0,
    hold: Annotated[
        float,
        typer.Option(
            help='Time at each turntable step in seconds; needs --step.', min=0.0, max=3600.0
        ),
    ] = 0.0,
    start: Annotated[
        float, typer.Option(help='Bearing of the lamp at the start, in degrees from the nose.')
    ] = 0.0,
    align: Annotated[
        bool,
        typer.Option(
            '--align',
            help='Estimate the angle between the zero marks of turntable and light board, and '
            'subtract it from the bearings.',
        ),
    ] = False,
    vehicle: VehicleOption = 'gtmab',
    frequency: Annotated[
        float, typer.Option(help='Flicker frequency of the lamp in Hz.', min=1.0, max=1e5)
    ] = DemodulationSettings().frequency,
    distance: Annotated[
        float, typer.Option(help='Distance from the photodiodes to the lamp in metres.', min=0.3)
    ] = 3.0,
    robot: RobotOption = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Repeat the paper's polar study with a recording of the real light board on a turntable.

    The turntable motion is --rate, or --step with --hold (22.5 degrees give the paper's 16
    directions), or ground_truth/odom of the same bag. Reports the median error in each direction
    for both estimators, and the measured diode response: exponent and gains for the vehicle file.

    Exit status 0: done. 2: bad input.

    Example: lta hardware light bench_bag --step 22.5 --hold 6
    """
    # Step and hold belong together and exclude a constant rate
    if bool(step) != bool(hold) or (rate and step):
        raise BadInput(
            'The turntable motion is ambiguous or incomplete; give either --rate, or both --step '
            'and --hold.'
        )
    table = TurntableMotion(math.radians(rate), math.radians(step), hold, math.radians(start))
    readings, diodes = read_turn(bag, robot, vehicle, frequency, table, run.console)
    # Angle between the zero of the turntable and that of the board [rad]
    zero = zero_offset(readings)
    directions, blocks = summarize_directions(readings, 'bench', zero if align else 0.0)
    fitted = fit_response(readings, diodes, zero, distance)
    return build_report(
        directions, readings, fitted, diodes, {'blocks': blocks, 'zero': zero, 'aligned': align},
        facts={'bag': str(bag), 'vehicle': vehicle},
        closing=(
            *format_vehicle_lines(fitted, f'measured: turntable, {bag}'),
            f'Zero offset of the turntable: {math.degrees(zero):.2f}° '
            f'({"removed" if align else "kept; --align removes it"}).',
        ),
    )  # fmt: skip
