# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The plan of an afternoon: what each test teaches, and which tells two effects apart."""

from dataclasses import replace
from pathlib import Path

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.flights.measured_flight import GRID_PERIOD, Stream
from lta_discovery.lab_tests.between import (
    build_separation_report,
    predict_evidence,
    rate_tests,
    SeparatingTest,
)
from lta_discovery.lab_tests.design import LabTest, list_designed_tests
from lta_discovery.lab_tests.plan import LabPlan, plan_lab_tests, PlannedTest, rehearse_test
from lta_discovery.lab_tests.plan_report import build_plan_report
from lta_discovery.lab_tests.recognition import read_commanded_wrench, recognise_tests
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import rotation_matrix
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import HtmlBlock, TextTable
from lta_vehicle.figures.stability import compute_pendulum_mode
import numpy as np
import pytest


@pytest.fixture(scope='module')
def gtmab() -> Vehicle:
    return load_vehicle('gtmab')


@pytest.fixture(scope='module')
def plan(gtmab: Vehicle) -> LabPlan:
    return plan_lab_tests(gtmab, 'gtmab', 'wrench')


def by_name(plan: LabPlan, name: str) -> PlannedTest:
    return next(one for one in plan.tests if one.test.name == name)


def test_steps_fit_the_room_in_all_directions(gtmab: Vehicle) -> None:
    """A turn drifts, and a push also lifts: the rehearsed way counts, not that of the axis."""
    small = plan_lab_tests(gtmab, 'gtmab', room=1.2)
    steps = [one for one in small.tests if one.test.kind == 'step']
    assert [one.test.name for one in steps] == [
        'step in surge', 'step in heave', 'step in yaw', 'reverse step in yaw',
    ]  # fmt: skip
    assert all(max(one.room) <= 1.2 for one in steps)


def test_each_test_teaches_what_textbooks_say(plan: LabPlan) -> None:
    """A float the lift, a swing its damping and inertia, a step its gain, a spin-down yaw."""
    for name, taught in {
        'float': {'net_lift.force'},
        'swing in roll': {'rotational_drag.roll', 'rotational_drag.roll_2', 'vehicle.roll'},
        'swing in pitch': {'rotational_drag.pitch', 'rotational_drag.pitch_2', 'vehicle.pitch'},
        'step in surge': {'wrench_gain.surge', 'linear_drag.surge'},
        'step in heave': {'wrench_gain.heave', 'linear_drag.heave'},
        'step in yaw': {'wrench_gain.yaw'},
        'smaller step in surge': {'wrench_gain.exponent_surge'},
        'smaller step in heave': {'wrench_gain.exponent_heave'},
        'smaller step in yaw': {'wrench_gain.exponent_yaw'},
        'reverse step in yaw': {'wrench_gain.reverse_yaw'},
        'spin-down': {'rotational_drag.yaw_2'},
        # Speeds of several sizes tell linear from quadratic drag
        'free flight': {'command_delay.delay', 'marker_offset.yaw', 'quadratic_drag.surge'},
    }.items():
        one = by_name(plan, name)
        assert one.is_needed, name
        assert taught - {known for known, _ in one.informs} == set(), name
    assert len(plan.tests) == 12
    # Nothing but scales fixes the mass, and nothing turns without a moment
    assert 'vehicle.mass' in plan.unknown
    assert 'wrench_gain.yaw' not in {known for known, _ in by_name(plan, 'swing in roll').informs}
    assert 'rotational_drag.roll' not in {
        known for known, _ in by_name(plan, 'swing in pitch').informs
    }


def test_a_rehearsed_swing_has_the_period_of_the_pendulum(gtmab: Vehicle) -> None:
    """Of 20 degrees: 0.8 % longer than a small one (a pendulum's own law), and damped."""
    swing = next(one for one in list_designed_tests(gtmab) if one.axis == 'pitch')
    flight = rehearse_test(gtmab, NominalVehicle.from_vehicle(gtmab), swing, 'rotors')
    lean = -rotation_matrix(flight.quaternion)[:, 2, 0]
    up = np.flatnonzero((lean[:-1] < 0.0) & (lean[1:] >= 0.0))
    period = np.diff(flight.time[up])[:3].mean()
    assert np.max(lean[:10]) == pytest.approx(np.sin(np.radians(20.0)), rel=0.02)
    assert period == pytest.approx(1.008 * compute_pendulum_mode(gtmab, 'pitch').period, rel=0.03)
    assert swing.seconds >= 4.0 * period


def test_a_step_fits_the_room_and_the_rotors(gtmab: Vehicle) -> None:
    """The duties of a step give its force, and carry the weight."""
    large, small = (
        {one.axis: one for one in list_designed_tests(gtmab, room) if one.kind == 'step'}
        for room in (4.0, 2.0)
    )
    assert set(large) == {'surge', 'heave', 'yaw'}
    nominal = NominalVehicle.from_vehicle(gtmab)
    for axis, place in (('surge', 0), ('heave', 2), ('yaw', 5)):
        flight = rehearse_test(gtmab, nominal, large[axis], 'rotors')
        wrench = read_commanded_wrench(flight, gtmab).values[-1]
        weight = 9.80665 * gtmab.heaviness
        extra = weight if axis == 'heave' else 0.0
        assert wrench[place] == pytest.approx(large[axis].size + extra, rel=0.02)
        assert np.ptp(flight.commands.values) <= 1.0
        # A turn needs a forward rotor alone, so nothing holds its altitude
        assert wrench[2] == pytest.approx(weight, rel=0.05) or axis != 'surge'
    flight = rehearse_test(gtmab, nominal, large['surge'], 'wrench')
    assert np.ptp(flight.position[:, 0]) < 4.0
    assert 0.0 < small['surge'].size < large['surge'].size
    # A turn needs no room
    assert small['yaw'].size == large['yaw'].size


def test_a_light_vehicle_climbs_with_its_rotors_alone(gtmab: Vehicle, tmp_path: Path) -> None:
    """What the gas lifts beyond the weight is no part of the commanded force."""
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    light = {'value': -0.002, 'unit': 'kg', 'source': 'a test'}
    (tmp_path / 'light.yaml').write_text(set_yaml_values(text, {'trim.heaviness': light}))
    vehicle = load_vehicle(str(tmp_path / 'light.yaml'))
    assert vehicle.heaviness == pytest.approx(-0.002)
    step = next(one for one in list_designed_tests(vehicle) if one.name == 'step in heave')
    columns = [rotor.column[AXES.index('heave')] for rotor in vehicle.rotors]
    assert np.dot(columns, step.thrusts) == pytest.approx(step.size, rel=0.02)


def test_a_released_vehicle_begins_where_the_test_says(gtmab: Vehicle) -> None:
    spin = next(one for one in list_designed_tests(gtmab) if one.kind == 'spin_down')
    flight = rehearse_test(gtmab, NominalVehicle.from_vehicle(gtmab), spin, 'wrench')
    turn = 2.0 * np.unwrap(np.arctan2(flight.quaternion[:27, 2], flight.quaternion[:27, 3]))
    rate = np.polyval(np.polyder(np.polyfit(flight.time[:27], turn, 3)), flight.time[13])
    assert np.degrees(rate) == pytest.approx(90.0, abs=5.0)
    # Ballast carries it: it stays at its height
    assert np.ptp(flight.position[:, 2]) < 0.01


@pytest.mark.parametrize('commands', ['rotors', 'wrench'])
def test_every_rehearsed_test_is_recognised(gtmab: Vehicle, commands: str) -> None:
    nominal = NominalVehicle.from_vehicle(gtmab)
    for one in list_designed_tests(gtmab):
        flight = rehearse_test(gtmab, nominal, one, commands)  # type: ignore[arg-type]
        found = recognise_tests(flight, gtmab)
        assert (one.kind, one.axis) in [(each.kind, each.axis) for each in found], one.name
        # One forward rotor alone pushes as well as it turns
        both = one.kind == 'step' and one.axis == 'yaw' and commands == 'rotors'
        assert len(found) == 1 + both, one.name


def test_a_step_logged_at_its_changes_alone_ends_in_a_spin_down(gtmab: Vehicle) -> None:
    """The last command but one holds until the last one, which ends it."""
    tests = {one.kind: one for one in list_designed_tests(gtmab)}
    nominal = NominalVehicle.from_vehicle(gtmab)
    spin = rehearse_test(gtmab, nominal, tests['spin_down'], 'wrench')
    time = np.arange(0.0, 22.0, GRID_PERIOD)
    # Speeds up while the moment acts, and turns on by 2 rad
    later = np.maximum(time - 8.0, 0.0)
    heading = np.minimum(time, 8.0) ** 2 / 16.0 + 2.0 * (1.0 - np.exp(-later / 2.0))
    turned = np.column_stack([0 * time, 0 * time, np.sin(heading / 2), np.cos(heading / 2)])
    wrench = np.zeros((3, 6))
    wrench[1, AXES.index('yaw')] = 1e-3
    flight = replace(
        spin,
        time=time,
        position=np.zeros((len(time), 3)),
        quaternion=turned,
        wrench=Stream(np.array([0.0, 1.0, 8.0]), wrench),
    )
    assert [one.kind for one in recognise_tests(flight, gtmab)] == ['step', 'spin_down']


def test_a_log_without_any_command_is_recognised_by_its_motion(gtmab: Vehicle) -> None:
    swing = next(one for one in list_designed_tests(gtmab) if one.kind == 'swing')
    flight = rehearse_test(gtmab, NominalVehicle.from_vehicle(gtmab), swing, 'rotors')
    rotors = len(gtmab.rotors)
    silent = replace(flight, commands=Stream(np.zeros(0), np.zeros((0, rotors))))
    assert [one.kind for one in recognise_tests(silent, gtmab)] == ['swing']


def test_two_sizes_and_both_directions_show_the_law_of_a_thrust(plan: LabPlan) -> None:
    """One size leaves the exponent open, and two together show it."""
    tests = {one.test.name: one.test for one in plan.tests}
    for axis in ('surge', 'heave', 'yaw'):
        step, smaller = (tests[f'{kind}step in {axis}'] for kind in ('', 'smaller '))
        assert smaller.size == pytest.approx(0.4 * step.size)
    assert tests['reverse step in yaw'].size == pytest.approx(-tests['step in yaw'].size)
    # The up and forward rotors of GT-MAB do not reverse
    assert not {'reverse step in surge', 'reverse step in heave'} & {*tests}
    for name in ('smaller step in surge', 'smaller step in yaw', 'reverse step in yaw'):
        one = by_name(plan, name)
        assert one.is_needed, name
        assert all(left < 0.6 for _, left in one.informs), name
    report = build_plan_report(plan, load_vehicle('gtmab'))
    assert 'two sizes and in both directions' in str(report.blocks)


def test_a_vehicle_that_falls_gets_no_list() -> None:
    with pytest.raises(BadInput, match=r'does not carry 100 % of its weight; the list is for'):
        list_designed_tests(load_vehicle('multirotor'))


def test_the_page_lists_the_afternoon(plan: LabPlan, gtmab: Vehicle) -> None:
    report = build_plan_report(plan, gtmab)
    table, why = (block for block in report.blocks if isinstance(block, TextTable))
    assert [row[0].split(' ', 2)[2] for row in table.rows] == [
        'weigh', 'float', 'swing in roll', 'swing in pitch', 'step in surge',
        'smaller step in surge', 'step in heave', 'smaller step in heave', 'step in yaw',
        'smaller step in yaw', 'reverse step in yaw', 'spin-down', 'free flight 1',
        'free flight 2',
    ]  # fmt: skip
    assert table.rows[2][1:3] == ['released from 20 degrees; once more from 5', '40']
    assert dict(why.rows)['swing in pitch'].startswith('damping in pitch')
    (sketches,) = (block.html for block in report.blocks if isinstance(block, HtmlBlock))
    assert sketches.count('<svg') == 12  # a free flight is drawn once, the scales are not
    (reverse,) = (one for one in sketches.split('<figure>') if 'reverse step in yaw' in one)
    assert 'scale(1 -1)' in reverse  # the arrow goes clockwise, seen from above
    assert isinstance(report.data, dict)
    steps = [one for one in report.data['tests'] if one['kind'] == 'step']
    assert all(one['share_of_limit'] <= 0.5 and one['duties'] == [] for one in steps)


def test_a_test_that_teaches_nothing_of_its_own_is_left_out() -> None:
    """The rotors of RGBlimp do not reverse; a turn the other way is in the free flights."""
    vehicle = load_vehicle('rgblimp')
    plan = plan_lab_tests(vehicle, 'rgblimp')
    left = [one.test.name for one in plan.tests if not one.is_needed]
    assert left == ['reverse step in yaw']
    assert LabTest('step', 'surge', 1.0).name == 'step in surge'


def parameter(
    name: str, tolerance: float = 0.0, typical: float = 1.0, per_flight: bool = False
) -> FreeParameter:
    return FreeParameter(
        name, '1', {('effect', name): 1.0}, 1e-5, 1e-4, tolerance, typical, per_flight=per_flight
    )


def test_the_evidence_is_what_the_rival_and_all_tolerances_leave() -> None:
    """Of columns (3, 4), (0, 5) and a nuisance (1, 0) within 0.5, at twice the typical size."""
    columns = np.array([[3.0, 0.0, 1.0], [4.0, 5.0, 0.0]])
    known = [parameter('a'), parameter('b'), parameter('n', 0.5, 0.0)]
    # The nuisance leaves 25 - 9 / 5 of a, 25 of b and 20 of both
    left = 0.5 * 4.0 * (25.0 - 9.0 / 5.0 - 20.0**2 / 25.0)
    assert predict_evidence(columns.T @ columns, known, 0, 1) == pytest.approx(left)
    same = np.array([[3.0, 6.0], [4.0, 8.0]])
    assert predict_evidence(same.T @ same, known[:2], 0, 1) == pytest.approx(0.0, abs=1e-9)


def test_what_differs_between_flights_hides_the_shared_value() -> None:
    """One reading of size 1: a deviation of 0.5 of the flight leaves 1 / (1 + 1 / 4) of it."""
    known = [parameter('bias', 0.5, 2.0, per_flight=True), parameter('b')]
    information = np.diag([1.0, 1.0])
    assert predict_evidence(information, known, 0, 1) == pytest.approx(0.5 * 16.0 / 1.25)


def test_a_step_in_surge_tells_two_effects_in_surge_apart_and_a_spin_down_does_not(
    gtmab: Vehicle,
) -> None:
    rated = rate_tests(gtmab, 'linear_drag.surge', 'added_mass.surge')
    nats = {one.test.name: one.nats for one in rated}
    assert nats['step in surge'] > 100.0 * max(nats['spin-down'], 0.01)
    report = build_separation_report('gtmab', ('linear_drag.surge', 'added_mass.surge'), rated)
    assert report.headline.startswith('To tell linear drag (surge) from added mass (surge), ')


def test_where_no_test_decides_it_says_what_to_measure() -> None:
    rated = [SeparatingTest(LabTest('float', '', 8.0), 0.1)]
    report = build_separation_report('gtmab', ('net_lift.force', 'payload.mass'), rated)
    assert 'weigh the vehicle' in report.headline
    other = build_separation_report('gtmab', ('net_lift.force', 'linear_drag.surge'), rated)
    assert other.headline.endswith('measure one of these effects on its own.')


def test_what_cannot_be_told_apart_is_refused(gtmab: Vehicle) -> None:
    with pytest.raises(BadInput, match=r"effect 'net_lift\.foce'"):
        rate_tests(gtmab, 'net_lift.foce', 'payload.mass')
    with pytest.raises(BadInput, match='is given twice'):
        rate_tests(gtmab, 'cg_offset.x', 'cg_offset.x')
