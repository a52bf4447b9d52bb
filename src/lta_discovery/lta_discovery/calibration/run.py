# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run a calibration: read the bags, fit, and build the report with the vehicle file."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import final

from lta_bag.provenance import read_commit
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_discovery.calibration.calibrated_file import (
    format_calibrated_vehicle,
    format_calibration_source,
)
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.report import build_report
from lta_discovery.calibration.result import Calibration
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import CALIBRATION_TIME, select_usable_flights
from lta_discovery.progress import DiscoverProgress
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import Report
from lta_report.request import option, ReportRequest, ROBOT, StudyRun

Tell = Callable[[str, float | None], None]


@final
class CalibrationRequest(ReportRequest, command='calibrate'):
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

    vehicle: str = option('Vehicle to calibrate, name or file.', complete='vehicle')
    train: tuple[Path, ...] = option(
        'Flights to calibrate with. Bag folders, results folders or .mcap files.',
        metavar='BAG...',
    )  # fmt: skip
    confirm: tuple[Path, ...] = option(
        'Other flights, whose forecasts test the calibration.', default=(), metavar='BAG...'
    )
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report with the calibrated vehicle file."""
        bags: dict[Role, Sequence[Path]] = {'train': self.train, 'confirm': self.confirm}
        with DiscoverProgress(run.console) as progress:
            return calibrate_vehicle(self.vehicle, bags, self.robot, progress.show_stage)


def calibrate_vehicle(
    name: str, bags: Mapping[Role, Sequence[Path]], robot: str | None, tell: Tell
) -> Report:
    """
    Calibrate a vehicle file from recorded flights.

    `name`: name of the vehicle, or its file. `bags`: 'train' and 'confirm'. `robot`: robot to
    read, where a bag holds several. Raise `BadInput` if the flights are not usable.
    """
    vehicle = load_vehicle(name)
    flights = read_bags(bags, robot, lambda bag: tell(f'reading {bag}', None))
    tell('checking data quality', None)
    usable = select_usable_flights(flights, vehicle, CALIBRATION_TIME)
    calibration = calibrate_flights(vehicle, name, usable.flights, tell, is_judged=True)
    return report_calibration(vehicle, name, replace(calibration, warnings=usable.warnings))


def report_calibration(vehicle: Vehicle, name: str, calibration: Calibration) -> Report:
    """Return the report of a calibration with the calibrated vehicle file, if there is one."""
    if calibration.method == 'file':
        return build_report(calibration, None)
    text = find_file('vehicle', name).read_text(encoding='utf-8')
    source = format_calibration_source(calibration.bags['train'], read_commit() or 'unknown')
    try:
        calibrated = format_calibrated_vehicle(text, vehicle, calibration, source)
    except BadInput as fault:
        calibration = replace(calibration, warnings=(*calibration.warnings, str(fault)))
        return build_report(calibration, None)
    return build_report(calibration, calibrated)
