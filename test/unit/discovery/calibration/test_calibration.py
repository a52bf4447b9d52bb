"""Calibrations hidden in flights of the independent simulator, which shares no code."""

import math
from pathlib import Path

from lta_challenge.other.calibration_case import CalibrationCase, generate_calibration_case
from lta_challenge.recording import write_bag
from lta_config.files import find_file
from lta_discovery.calibration.calibrated_file import format_calibrated_vehicle
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.report import build_report
from lta_discovery.calibration.result import Calibration
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

ROLES = ('train', 'train', 'confirm')
SECONDS = (35.0, 45.0)


def calibrate_case(seed: int, folder: Path) -> tuple[CalibrationCase, Calibration]:
    """Return a case and its calibration, through bags."""
    vehicle = load_vehicle('gtmab')
    case = generate_calibration_case(vehicle, seed, 0, ROLES, SECONDS)
    bags: dict[Role, list[Path]] = {'train': [], 'confirm': []}
    for flight in case.flights:
        write_bag(folder / flight.name, flight.streams, vehicle.rotor_names, {})
        bags['train' if flight.role == 'train' else 'confirm'].append(folder / flight.name)
    usable = select_usable_flights(read_bags(bags), vehicle)
    return case, calibrate_flights(vehicle, 'gtmab', usable.flights, lambda _what, _part: None)


@pytest.fixture(scope='module')
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> tuple[CalibrationCase, Calibration]:
    """Return the calibration of one case."""
    return calibrate_case(3, tmp_path_factory.mktemp('calibration'))


def assert_truth_is_found(case: CalibrationCase, found: Calibration) -> None:
    """Check all values against the truth: at most one in twenty is outside of its interval."""
    inside = []
    for name, value in case.list_true_values(load_vehicle('gtmab')).items():
        one = found.find(name)
        assert one is not None, name
        low, high = one.ci95
        inside.append(low <= value <= high)
        deviation = (high - low) / 3.92
        assert abs(one.value - value) < 4.5 * deviation, name
    for one in found.list_of_flights('net_lift.force'):
        inside.append(one.ci95[0] <= case.lifts[one.flight] <= one.ci95[1])
        assert abs(one.value - case.lifts[one.flight]) < 4e-3
    assert np.mean(inside) >= 0.85
    last = found.scores['confirm'][-1]
    assert last.after[0] < 0.5 * min(last.before[0], last.coast[0])


def test_a_hidden_calibration_is_found(calibrated: tuple[CalibrationCase, Calibration]) -> None:
    """Gains of any sign, a late command, a crooked marker frame and lift, all at once."""
    assert_truth_is_found(*calibrated)
    _, found = calibrated
    assert found.method == 'likelihood'


def test_the_first_line_says_what_is_wrong(
    calibrated: tuple[CalibrationCase, Calibration],
) -> None:
    case, found = calibrated
    report = build_report(found, None)
    surge = found.find('wrench_gain.surge')
    assert surge is not None
    assert surge.is_far
    assert report.headline.startswith('Surge: ')
    assert ('backwards' in report.headline.partition(';')[0]) == (case.truth.wrench_gains[0] < 0.0)
    assert 'delay of the commands cannot be separated from the clock' in str(report.blocks)


def test_the_calibrated_file_is_the_calibrated_vehicle(
    calibrated: tuple[CalibrationCase, Calibration], tmp_path: Path
) -> None:
    """Read back, it has the mass, inertia, balance and effects of the calibration."""
    _, found = calibrated
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    path = tmp_path / 'calibrated.yaml'
    path.write_text(format_calibrated_vehicle(text, load_vehicle('gtmab'), found, 'a test'))
    read = NominalVehicle.from_vehicle(load_vehicle(str(path)))
    wanted = found.calibrated
    assert read.mass == pytest.approx(wanted.mass)
    assert read.displaced == pytest.approx(wanted.displaced, rel=1e-6)
    np.testing.assert_allclose(read.inertia, wanted.inertia, rtol=1e-6)
    np.testing.assert_allclose(read.cg, wanted.cg, rtol=1e-9)
    for effect in ('wrench_gain', 'marker_offset', 'tracker_misalignment', 'command_delay'):
        for name, value in wanted.given[effect].items():
            assert read.parameter_value(effect, name) == pytest.approx(value), effect
    lifts = [one.value for one in found.list_of_flights('net_lift.force')]
    assert read.parameter_value('net_lift', 'force') == pytest.approx(np.mean(lifts))
    assert math.isfinite(read.build_model().inverse.sum())
