"""What `lta light calibrate` takes: a turn in front of a lamp."""

import math
from pathlib import Path
from typing import final

from lta_config.errors import BadInput
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, ROBOT, StudyRun, VEHICLE
from lta_studies.light.turn.readings import (
    align_directions,
    fit_response,
    read_turn,
    summarize_directions,
    TurnMotion,
)
from lta_vlc.settings import DemodulationSettings


@final
class DiodeCalibrationRequest(ReportRequest, command='light calibrate'):
    """
    Measure response, gains and bearing errors of the photodiodes by a turn in front of a lamp.

    Turn the drone by 360 degrees or more, 3 m from the lamp, in 20 s or more: in hover, by hand,
    or level on a turntable, whose motion is --rate, or --step with --hold (22.5 degrees give the
    paper's 16 directions). Prints the entries for the vehicle file. The demodulator then knows the
    photodiodes, and its bearings are more accurate. The page has the median bearing error in each
    direction, by the paper's weighted mean and by our fit.

    Exit status 0: done. 2: bad input.

    Example: lta light calibrate runs/turn

    Example: lta light calibrate bench_bag --step 22.5 --hold 6
    """

    bag: Path = argument('Bag of a turn in front of the lamp.')
    vehicle: str = VEHICLE
    frequency: float = option(
        'Flicker frequency of the lamp in Hz.', default=DemodulationSettings().frequency, low=1.0,
        high=1e5,
    )  # fmt: skip
    topic: str = option('Odometry topic with the heading.', default='odom')
    rate: float = option(
        'Constant speed of a turntable in deg/s, counter-clockwise, instead of --topic.',
        default=0.0,
    )
    step: float = option(
        'Step of a turntable in degrees, instead of --topic; needs --hold.', default=0.0
    )
    hold: float = option(
        'Time at each step of the turntable in seconds; needs --step.', default=0.0, low=0.0,
        high=3600.0,
    )  # fmt: skip
    distance: float = option(
        'Distance from the photodiodes to the lamp in metres.', default=3.0, low=0.3
    )
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report of the turn."""
        from lta_studies.light.turn.report import build_report

        # Step and hold belong together and exclude a constant rate
        if bool(self.step) != bool(self.hold) or (self.rate and self.step):
            raise BadInput(
                'The motion of the turntable is ambiguous or incomplete; give either --rate, or '
                'both --step and --hold.'
            )
        motion = TurnMotion(
            self.topic, math.radians(self.rate), math.radians(self.step), self.hold
        )
        readings, diodes = read_turn(
            self.bag, self.robot, self.vehicle, self.frequency, motion, run.console
        )
        readings = align_directions(readings)
        response = fit_response(readings, diodes, self.distance)
        errors = summarize_directions(readings)
        return build_report(
            errors, readings, response, diodes, {'bag': str(self.bag), 'vehicle': self.vehicle}
        )
