"""What `lta light calibrate` and `lta hardware light` take: a turn in front of a lamp."""

import math
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, ROBOT, StudyRun, VEHICLE
from lta_studies.light.turntable.turntable import (
    fit_response,
    read_turn,
    summarize_directions,
    TurntableMotion,
    zero_offset,
)
from lta_vlc.settings import DemodulationSettings

FREQUENCY_OPTION: Any = option(
    'Flicker frequency of the lamp in Hz.', default=DemodulationSettings().frequency, low=1.0,
    high=1e5,
)  # fmt: skip
DISTANCE_OPTION: Any = option(
    'Distance from the photodiodes to the lamp in metres.', default=3.0, low=0.3
)


@final
class DiodeCalibrationRequest(ReportRequest, command='light calibrate'):
    """
    Measure the response and the gains of the photodiodes by a turn in place.

    Turn the drone by 360 degrees or more, 3 m from the lamp, in 20 s or more: in hover, or by
    hand. Prints the entries for the vehicle file. The demodulator then knows the photodiodes,
    and its bearings are more accurate. On a turntable use "lta hardware light".

    Exit status 0: done. 2: bad input.

    Example: lta light calibrate runs/turn
    """

    bag: Path = argument('Bag of a turn in place in front of the lamp.')
    vehicle: str = VEHICLE
    frequency: float = FREQUENCY_OPTION
    topic: str = option('Odometry topic with the heading.', default='odom')
    distance: float = DISTANCE_OPTION
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report of the turn."""
        from lta_studies.light.turntable.report import build_calibration_report

        motion = TurntableMotion(heading=self.topic)
        readings, diodes = read_turn(
            self.bag, self.robot, self.vehicle, self.frequency, motion, run.console
        )
        zero = zero_offset(readings)
        study, _ = summarize_directions(readings, 'turn', zero)
        response = fit_response(readings, diodes, zero, self.distance)
        facts = {'bag': str(self.bag), 'vehicle': self.vehicle}
        return build_calibration_report(study, readings, response, diodes, facts)


@final
class TurntableRequest(ReportRequest, command='hardware light', folder='turntable'):
    """
    Repeat the paper's polar study with a recording of the real light board on a turntable.

    The turntable motion is --rate, or --step with --hold (22.5 degrees give the paper's 16
    directions), or ground_truth/odom of the same bag. Reports the median error in each direction
    for both estimators, and the measured diode response: exponent and gains for the vehicle file.

    Exit status 0: done. 2: bad input.

    Example: lta hardware light bench_bag --step 22.5 --hold 6
    """

    bag: Path = argument('Bag recorded from the light board, with photodiode readings.')
    rate: float = option(
        'Constant speed of the turntable in deg/s, counter-clockwise.', default=0.0
    )
    step: float = option(
        'Turntable step in degrees, instead of --rate; needs --hold.', default=0.0
    )
    hold: float = option(
        'Time at each turntable step in seconds; needs --step.', default=0.0, low=0.0, high=3600.0
    )
    start: float = option(
        'Bearing of the lamp at the start, in degrees from the nose.', default=0.0
    )
    align: bool = option(
        'Estimate the angle between the zero marks of turntable and light board, and subtract it '
        'from the bearings.',
        default=False,
    )
    vehicle: str = VEHICLE
    frequency: float = FREQUENCY_OPTION
    distance: float = DISTANCE_OPTION
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report of the recording."""
        from lta_studies.light.turntable.report import build_report, format_vehicle_lines

        # Step and hold belong together and exclude a constant rate
        if bool(self.step) != bool(self.hold) or (self.rate and self.step):
            raise BadInput(
                'The turntable motion is ambiguous or incomplete; give either --rate, or both '
                '--step and --hold.'
            )
        motion = TurntableMotion(
            math.radians(self.rate), math.radians(self.step), self.hold, math.radians(self.start)
        )
        readings, diodes = read_turn(
            self.bag, self.robot, self.vehicle, self.frequency, motion, run.console
        )
        # Angle between the zero of the turntable and that of the board [rad]
        zero = zero_offset(readings)
        study, blocks = summarize_directions(readings, 'bench', zero if self.align else 0.0)
        response = fit_response(readings, diodes, zero, self.distance)
        return build_report(
            study, readings, response, diodes,
            {'blocks': blocks, 'zero': zero, 'aligned': self.align},
            facts={'bag': str(self.bag), 'vehicle': self.vehicle},
            closing=(
                *format_vehicle_lines(response, f'measured: turntable, {self.bag}'),
                f'Zero offset of the turntable: {math.degrees(zero):.2f}° '
                f'({"removed" if self.align else "kept; --align removes it"}).',
            ),
        )  # fmt: skip
