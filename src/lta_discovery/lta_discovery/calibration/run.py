"""Run a calibration: read the bags, fit, and build the report with the vehicle file."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from lta_bridge.provenance import read_commit
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
from lta_discovery.flights.usable_flights import CALIBRATED, select_usable_flights
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import Report

Tell = Callable[[str, float | None], None]


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
    usable = select_usable_flights(flights, vehicle, CALIBRATED)
    calibration = calibrate_flights(vehicle, name, usable.flights, tell)
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
