# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Calibrations hidden in flights of the independent simulator, which shares no code."""

from collections.abc import Sequence
from dataclasses import replace
import math
from pathlib import Path

from campaigns.challenge.calibration_case import CalibrationCase, generate_calibration_case
from campaigns.challenge.case_generator import CaseFlight
from campaigns.challenge.flight import DutyPilot, FlightSimulator, TICK
from campaigns.challenge.recording import write_bag
from campaigns.challenge.sensors import SensorSet
from campaigns.challenge.truth import build_vehicle_truth, to_triple, VehicleTruth
from campaigns.challenge.wrench_flight import Course, WrenchActuators, WrenchPilot
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.calibration.calibrated_file import (
    format_calibrated_vehicle,
    format_changed_vehicle,
    VehicleUpdate,
)
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.prepared_flights import fit_quickly, prepare_calibration
from lta_discovery.calibration.report import build_report
from lta_discovery.calibration.result import Calibration
from lta_discovery.calibration.verdict import format_forecast_sentence, format_inseparable
from lta_discovery.discovery.run import DiscoveryRequest, study_usable_flights
from lta_discovery.discovery.study import Discovery, TUNED
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.measured_flight import MeasuredFlight, resample_flight, Stream
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.model.calibration_parameters import list_calibration_parameters
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    COASTING,
    FILE_MODEL,
    find_main_score,
    ForecastRms,
    HorizonErrors,
    LeastRms,
)
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ..hidden_flight import flown  # noqa: TID252 - `test` is Python's own
from ..step_pilot import StepPilot  # noqa: TID252

ROLES = ('train', 'train', 'confirm')
SECONDS = (35.0, 45.0)
SIZES = (0.03, 1.0, 0.03, 1.0, 1.0, 0.003)  # forces at which the gains hold [N, N m]


def calibrate_case(
    seed: int,
    folder: Path,
    name: str = 'gtmab',
    course: Course | None = None,
    heading: float = 0.0,
    number: int = 0,
) -> tuple[CalibrationCase, Calibration]:
    """Return a case and its calibration, through bags; the markers are turned by a heading."""
    vehicle = load_vehicle(name)
    case = generate_calibration_case(
        load_vehicle('gtmab'), seed, number, ROLES, SECONDS, with_flows=not course, course=course
    )
    bags: dict[Role, list[Path]] = {'train': [], 'confirm': []}
    for flight in case.flights:
        turns = flight.streams['ground_truth/odom'][1][:, 3:7]
        turns[:] = (Rotation.from_quat(turns) * Rotation.from_euler('z', heading)).as_quat()
        write_bag(folder / flight.name, flight.streams, vehicle.rotor_names, {})
        bags['train' if flight.role == 'train' else 'confirm'].append(folder / flight.name)
    usable = select_usable_flights(read_bags(bags), vehicle)
    return case, calibrate_flights(vehicle, name, usable.flights, lambda _what, _part: None)


@pytest.fixture(scope='module')
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> tuple[CalibrationCase, Calibration]:
    return calibrate_case(6, tmp_path_factory.mktemp('calibration'))


def list_main_positions(found: Calibration, role: str) -> list[float]:
    """Return the position errors of the file, the calibration and coasting [m]."""
    main = find_main_score(found.scores[role])
    assert main is not None
    return [main.positions[name] for name in (FILE_MODEL, CALIBRATED, COASTING)]


def assert_truth_is_found(case: CalibrationCase, found: Calibration, share: float = 0.5) -> None:
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
    file, calibrated, coasting = list_main_positions(found, 'confirm')
    assert calibrated < share * min(file, coasting)


def test_a_hidden_calibration_is_found(calibrated: tuple[CalibrationCase, Calibration]) -> None:
    """Gains of any sign, a late command, a crooked marker frame and lift, all at once."""
    assert_truth_is_found(*calibrated)
    _, found = calibrated
    assert found.method == 'likelihood'


def calibrate_bags(folder: Path, flights: Sequence[CaseFlight]) -> Calibration:
    """Return the calibration of a GT-MAB by flights, through bags."""
    vehicle = load_vehicle('gtmab')
    bags: dict[Role, list[Path]] = {'train': [], 'confirm': []}
    for flight in flights:
        write_bag(folder / flight.name, flight.streams, vehicle.rotor_names, {})
        bags[flight.role].append(folder / flight.name)
    usable = select_usable_flights(read_bags(bags), vehicle).flights
    return calibrate_flights(vehicle, 'gtmab', usable, lambda _what, _part: None)


def record_poses(
    name: str, blimp: VehicleTruth, pilot: DutyPilot, tilt: float, seconds: float
) -> CaseFlight:
    """Return poses and commands of a blimp that is let go with its nose down by an angle."""
    half = 0.5 * tilt
    begin = [0.0, 0.0, 3.5, *[0.0] * 3, math.cos(half), 0.0, math.sin(half), *[0.0] * 4]
    simulator = FlightSimulator(blimp, pilot, actuators=WrenchActuators)
    path = simulator.simulate_flight(begin, seconds)
    time = TICK * np.arange(len(path.commands), dtype=np.float64)
    poses = SensorSet(path, blimp, 'exact', np.random.default_rng(len(name))).measure_poses()
    streams = {'ground_truth/odom': poses, 'wrench_command': (time, path.commands)}
    return CaseFlight(name, 'train', streams)


class ShakenPilot:
    """A pilot beside whose commands moments swing the hull, which no record has."""

    def __init__(
        self, pilot: DutyPilot, size: float, period: float, draw: np.random.Generator
    ) -> None:
        self._pilot, self._size, self._period = pilot, size, period
        self._phases = draw.uniform(0.0, 2.0 * math.pi, 2)

    def initial_duties(self) -> list[float]:
        """Return no command."""
        return self._pilot.initial_duties()

    def compute_duties(self, time: float, state: list[float]) -> list[float]:
        """Return the command at a time, with the moments in roll and pitch."""
        turn = 2.0 * math.pi * time / self._period
        shake = [0.0] * 3 + [self._size * math.sin(turn + each) for each in self._phases] + [0.0]
        return np.add(self._pilot.compute_duties(time, state), shake).tolist()


def test_a_swing_that_nothing_explains_hides_no_gain_drag_or_lift(tmp_path: Path) -> None:
    """Unknown moments swing the hull by 5 degrees; 0.7 of the heave command acts."""
    file, flights = build_vehicle_truth(load_vehicle('gtmab')), []
    gains, drag = (1.0, 1.0, 0.7, 1.0, 1.0, 1.0), (0.05, 0.05, 0.12)
    for number, name in enumerate(('one', 'three')):
        blimp = replace(file, wrench_gains=gains, linear_drag=drag, lift=0.008)
        draw = np.random.default_rng([11, 74, number])
        pilot = ShakenPilot(WrenchPilot(file, gains, draw), 0.007, 2.3, draw)
        flight = record_poses(name, blimp, pilot, 0.0, 30.0)
        flight.streams['wrench_command'][1][:, 3:5] = 0.0
        flights.append(flight)
        turns = Rotation.from_quat(flight.streams['ground_truth/odom'][1][:, 3:7])
        assert np.degrees(np.arccos(turns.as_matrix()[:, 2, 2])).max() > 5.0
    found = calibrate_bags(tmp_path, flights)
    truth = {f'linear_drag.{axis}': each for axis, each in zip(AXES, drag, strict=False)}
    truth['wrench_gain.heave'] = 0.7
    for name, value in truth.items():
        one = found.find(name)
        assert one is not None
        assert one.is_known
        assert one.ci95[0] < value < one.ci95[1], name
    for one in found.list_of_flights('net_lift.force'):
        assert one.ci95[0] < 0.008 < one.ci95[1]
        assert abs(one.value - 0.008) < 2e-3


def test_a_single_swing_shows_a_pendulum_forty_percent_faster_than_the_files(
    tmp_path: Path,
) -> None:
    """After 3 s of forecast it is half a swing ahead; in a flight beside it, the gain is 0.3."""
    file = build_vehicle_truth(load_vehicle('gtmab'))
    blimp = replace(
        file, cg=(0.004, -0.003, 1.4 * file.cg[2]), marker_arm=(-0.06, -0.03, -0.07), lift=0.04,
        inertia=to_triple([0.64 * each for each in file.inertia]),
        wrench_gains=(0.3, 1.0, 1.0, 1.0, 1.0, 0.9),
    )  # fmt: skip
    pilot = WrenchPilot(file, blimp.wrench_gains, np.random.default_rng([11, 73, 1]))
    flights = [
        record_poses('free', blimp, pilot, 0.0, 25.0),
        record_poses('swing', blimp, StepPilot(5, 1e-4), math.radians(20.0), 14.0),
    ]
    found = calibrate_bags(tmp_path, flights)
    for name, truth in (
        ('vehicle.pitch', 0.64),
        ('vehicle.yaw', 0.64),
        ('wrench_gain.yaw', 0.9),
        ('cg_height.z', 0.4 * file.cg[2]),
        ('marker_offset.z', -0.07),
    ):
        one = found.find(name)
        assert one is not None
        assert one.is_known
        assert one.ci95[0] < truth < one.ci95[1], (name, one)
    main = find_main_score(found.scores['train'])
    assert main is not None
    assert main.errors[CALIBRATED].attitude < math.radians(1.5)


@pytest.mark.parametrize('share', [1.0, 1.7])
def test_a_drag_is_found_in_single_steps(tmp_path: Path, share: float) -> None:
    """Of flights that show one command each, as those of a lab often do."""
    file = build_vehicle_truth(load_vehicle('gtmab'))
    blimp = replace(
        file,
        drag=to_triple([share * each for each in file.drag]),
        lift=9.80665 * (file.mass - file.displaced),
        wrench_gains=(2.4, 1.0, 1.0, 1.0, 1.0, 1.0),
    )
    flights = [
        record_poses('ahead', blimp, StepPilot(0, 0.05), 0.0, 9.0),
        record_poses('upward', blimp, StepPilot(2, 0.03), 0.0, 9.0),
        record_poses('swinging', blimp, StepPilot(5, 1e-4), 0.35, 14.0),
        record_poses('ahead, half', blimp, StepPilot(0, 0.025), 0.0, 11.0),
    ]
    found = calibrate_bags(tmp_path, [*flights[:3], replace(flights[3], role='confirm')])
    drag, gain = found.find('quadratic_drag.surge'), found.find('wrench_gain.surge')
    assert drag is not None
    assert gain is not None
    assert gain.ci95[0] < 2.4 < gain.ci95[1]
    assert drag.ci95[0] < share * file.drag[0] < drag.ci95[1]
    far = found.scores['confirm'][-1]
    assert far.horizon == 8.0
    # Along the nose, where half of the force makes 2 m
    assert far.errors[CALIBRATED].nose < min(0.1, far.errors[FILE_MODEL].nose)


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


def test_forecasts_that_diverge_are_no_numbers(
    calibrated: tuple[CalibrationCase, Calibration],
) -> None:
    """As those of a multirotor, which tips over without its controller."""
    sizes = {COASTING: 1.4, FILE_MODEL: math.inf, CALIBRATED: 2e19}
    errors = {name: ForecastRms(size, 0.5, size, size, size) for name, size in sizes.items()}
    lost = HorizonErrors(3.0, errors, 9, LeastRms(0.01, 0.02))
    found = replace(calibrated[1], scores={'confirm': (lost,)})
    sentence = format_forecast_sentence(found)
    assert 'diverged with the vehicle file, diverged calibrated, 140 cm if' in sentence
    assert 'The forecasts diverge: the file is far off, or the vehicle is unstable' in sentence


@pytest.mark.long
def test_a_marker_frame_without_regard_to_the_nose_is_found(tmp_path: Path) -> None:
    """Rigid bodies of a tracker are often defined while the vehicle points anywhere."""
    case, found = calibrate_case(3, tmp_path, heading=math.radians(100.0))
    true = Rotation.from_euler(
        'ZYX', [case.list_true_values(load_vehicle('gtmab'))[f'marker_offset.{angle}']
                for angle in ('yaw', 'pitch', 'roll')]
    ) * Rotation.from_euler('z', 100.0, degrees=True)  # fmt: skip
    angles = [found.find(f'marker_offset.{angle}') for angle in ('yaw', 'pitch', 'roll')]
    fitted = Rotation.from_euler('ZYX', [one.value for one in angles if one is not None])
    assert (true.inv() * fitted).magnitude() < math.radians(3.0)
    file, calibrated, coasting = list_main_positions(found, 'confirm')
    assert calibrated < 0.5 * min(file, coasting)


def study_case(case: CalibrationCase, folder: Path) -> Discovery:
    """Return what a discovery finds in the flights of a case."""
    vehicle, bags = load_vehicle('gtmab'), {'train': [], 'confirm': []}
    for flight in case.flights:
        bags['train' if flight.role == 'train' else 'confirm'].append(folder / flight.name)
    usable = select_usable_flights(read_bags(bags), vehicle)
    request = DiscoveryRequest.of_bags('gtmab', bags)
    return study_usable_flights(request, vehicle, usable, lambda _what, _part: None)[0]


@pytest.mark.long
@pytest.mark.parametrize('course', ['hover', 'circle', 'places'])
def test_flights_in_closed_loop_are_calibrated_and_nothing_is_named(
    tmp_path: Path, course: Course
) -> None:
    """A controller without dither."""
    case, found = calibrate_case(6, tmp_path, course=course)
    # A hover is nearly a coast: the share was 0.56 there
    assert_truth_is_found(case, found, share=0.75)
    study = study_case(case, tmp_path)
    assert study.named == ()
    assert study.first.calibration is not None
    assert study.comparison.main is not None
    errors = study.comparison.main.errors
    assert errors[TUNED].position < errors[COASTING].position


def test_the_gain_of_a_controller_that_dithers_nothing_is_found(tmp_path: Path) -> None:
    """The short fit finds it, by which a discovery decides whether to calibrate."""
    vehicle = load_vehicle('gtmab')
    case = generate_calibration_case(
        vehicle, 6, 0, ('train', 'confirm'), (24.0, 26.0), with_flows=False, course='places'
    )
    for flight in case.flights:
        write_bag(tmp_path / flight.name, flight.streams, vehicle.rotor_names, {})
    bags = {'train': [tmp_path / one.name for one in case.flights]}
    flights = select_usable_flights(read_bags(bags), vehicle).flights
    prepared = prepare_calibration(vehicle, flights)
    start = fit_quickly(prepared)
    for axis in ('surge', 'sway', 'heave'):
        k = [one.name for one in prepared.parameters].index(f'wrench_gain.{axis}')
        assert 1.0 + start.values[k] == pytest.approx(0.3, abs=0.15), axis


def test_nothing_tells_the_heading_of_the_tracker_in_still_air(
    calibrated: tuple[CalibrationCase, Calibration],
) -> None:
    """The heading of the markers on the vehicle is another number, which flights tell."""
    case, found = calibrated
    heading, markers = found.find('tracker_misalignment.yaw'), found.find('marker_offset.yaw')
    assert heading is not None
    assert markers is not None
    assert not heading.is_known
    assert format_inseparable(heading).startswith(
        'cannot be separated from the direction of the axes of the map'
    )
    assert markers.is_known
    assert markers.value == pytest.approx(case.truth.marker_turn[0], abs=0.02)


def test_a_wind_in_the_vehicle_file_makes_the_heading_a_number_to_be_fitted() -> None:
    still = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    windy = still.with_value('steady_wind', 'x', 0.15)
    for nominal, is_fitted in ((still, False), (windy, True)):
        knobs = list_calibration_parameters(nominal, [True, False, True] + 3 * [False], True)
        assert ('tracker_misalignment.yaw' in {knob.name for knob in knobs}) is is_fitted


@pytest.mark.long
def test_a_wind_in_the_vehicle_file_shows_the_heading_of_the_tracker(tmp_path: Path) -> None:
    """The tracker's axes are turned by 0.12 rad in a wind that an anemometer has measured."""
    wind, heading = {'value': 0.3, 'unit': 'm/s', 'source': 'an anemometer'}, 0.12
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    path = tmp_path / 'windy.yaml'
    path.write_text(set_yaml_values(text, {'effects.steady_wind.x': wind}))
    flights: list[tuple[str, str, MeasuredFlight]] = []
    for seed in (31, 32):
        streams = flown({'vehicle.effects.steady_wind.x': wind}, seed, 62.0)
        turn, poses = Rotation.from_euler('z', -heading), streams.pose.values
        turned = (turn * Rotation.from_quat(poses[:, 3:])).as_quat()
        pose = Stream(streams.pose.time, np.hstack([turn.apply(poses[:, :3]), turned]))
        alone = {'voltage': streams.others['voltage']}
        flight = resample_flight(replace(streams, pose=pose, others=alone))
        flights.append((f'{seed}', 'train', flight))
    vehicle = load_vehicle(str(path))
    found = calibrate_flights(vehicle, 'windy', flights, lambda _what, _part: None)
    one = found.find('tracker_misalignment.yaw')
    assert one is not None
    assert one.is_known
    assert one.ci95[0] < heading < one.ci95[1]
    assert one.ci95[0] > 0.0


def test_the_mass_of_a_vehicle_with_a_moving_mass_is_written(tmp_path: Path) -> None:
    """The file states it without the moving mass, which the reader adds."""
    vehicle = load_vehicle('rgblimp')
    before = after = NominalVehicle.from_vehicle(vehicle)
    known = {one.name: one for one in list_free_parameters(before)}
    for name, change in (('mass', 0.05), ('roll', -0.4), ('pitch', 0.9), ('yaw', 0.5)):
        after = known[f'vehicle.{name}'].apply_to(after, change)
    text = find_file('vehicle', 'rgblimp').read_text(encoding='utf-8')
    path = tmp_path / 'calibrated.yaml'
    change = VehicleUpdate(before, after)
    path.write_text(format_changed_vehicle(text, vehicle, change, {}, 'a test'))
    read = NominalVehicle.from_vehicle(load_vehicle(str(path)))
    assert read.mass == pytest.approx(1.05127 * before.mass, rel=1e-5)
    assert read.displaced == pytest.approx(after.displaced, rel=1e-6)
    np.testing.assert_allclose(read.inertia, after.inertia, rtol=1e-6)
    np.testing.assert_allclose(read.cg, after.cg, rtol=1e-9)
    light = known['vehicle.roll'].apply_to(before, -4.0)
    with pytest.raises(BadInput, match='less than that of its moving mass'):
        format_changed_vehicle(text, vehicle, VehicleUpdate(before, light), {}, 'a test')


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
        for name, value in wanted.effect_parameters[effect].items():
            assert read.parameter_value(effect, name) == pytest.approx(value), effect
    lifts = [one.value for one in found.list_of_flights('net_lift.force')]
    assert read.parameter_value('net_lift', 'force') == pytest.approx(np.mean(lifts))
    assert math.isfinite(read.build_model().inverse.sum())
