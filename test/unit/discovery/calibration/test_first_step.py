# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A discovery calibrates first where its flights call for it, and only there."""

from collections.abc import Callable
from dataclasses import replace
import itertools
import math
from pathlib import Path

from campaigns.challenge.calibration_case import generate_calibration_case
from campaigns.challenge.recording import write_bag
from lta_config.files import find_file
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.calibration import first_step
from lta_discovery.calibration.calibrated_file import (
    format_calibrated_vehicle,
    split_by_duty,
    state_by_duty,
)
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.first_step import (
    apply_calibration,
    calibrate_first,
    FirstStep,
    free_flight_lifts,
)
from lta_discovery.calibration.report import build_report
from lta_discovery.calibration.result import CalibratedValue, Calibration
from lta_discovery.calibration.verdict import (
    format_lift_warning,
    list_differences,
    pendulum_rates,
)
from lta_discovery.flights.bags import AssignedFlight, read_bags, restrict_to_interval
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.model.calibration_parameters import (
    build_reverse_parameter,
    list_calibration_parameters,
    list_reversed_rotors,
)
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
from lta_model.vehicle import load_vehicle, parse_vehicle, Vehicle
import numpy as np
import pytest


@pytest.fixture(scope='module')
def vehicle() -> Vehicle:
    return load_vehicle('gtmab')


def read_flights(vehicle: Vehicle, folder: Path, is_right: bool) -> list[AssignedFlight]:
    """Return two short flights of a vehicle whose file is right or not."""
    case = generate_calibration_case(
        vehicle, 3, 0, ('train', 'confirm'), (24.0, 26.0), with_flows=False, is_right=is_right
    )
    for flight in case.flights:
        write_bag(folder / flight.name, flight.streams, vehicle.rotor_names, {})
    bags = {one.role: [folder / one.name] for one in case.flights}
    return list(select_usable_flights(read_bags(bags), vehicle).flights)


@pytest.fixture(scope='module')
def wrong(vehicle: Vehicle, tmp_path_factory: pytest.TempPathFactory) -> list[AssignedFlight]:
    return read_flights(vehicle, tmp_path_factory.mktemp('wrong'), is_right=False)


def make_score(*errors: tuple[float, float]) -> HorizonErrors:
    """Return a score from position and attitude errors of coasting, file and calibration."""
    rms = (ForecastRms(*each, *3 * [each[0] / 3.0**0.5]) for each in errors)
    names = (COASTING, FILE_MODEL, CALIBRATED)
    return HorizonErrors(3.0, dict(zip(names, rms, strict=True)), 20, LeastRms(0.0, 0.0))


def make_value(
    name: str, before: float, value: float, deviation: float, flight: str = ''
) -> CalibratedValue:
    ends = (value - 1.96 * deviation, value + 1.96 * deviation)
    return CalibratedValue(name, '1', flight, before, value, ends, True, True, ())


def make_calibration(
    nominal: NominalVehicle, *values: CalibratedValue, after: float = 0.02
) -> Calibration:
    """Return a calibration with some values and a forecast error [m]."""
    score = make_score((0.2, 0.3), (0.5, 0.2), (after, 0.4 * after))
    calibrated = nominal.with_value('wrench_gain', 'surge', 0.3)
    scores = {'train': (score,)}
    return Calibration('gtmab', nominal, calibrated, calibrated, values, scores, 'likelihood', {})


GAIN = make_value('wrench_gain.surge', 1.0, 0.3, 0.01)
Decide = Callable[..., FirstStep]


@pytest.fixture
def decide(
    vehicle: Vehicle, wrong: list[AssignedFlight], monkeypatch: pytest.MonkeyPatch
) -> Decide:
    """Return a function that takes a first step whose suspicion and calibration are given."""

    def step(found: Calibration, suspicion: str = 'wrench_gain.surge') -> FirstStep:
        monkeypatch.setattr(first_step, '_list_suspicions', lambda *_: [suspicion])
        monkeypatch.setattr(first_step, 'calibrate_flights', lambda *_, **__: found)
        return calibrate_first(vehicle, 'gtmab', wrong, lambda _what, _part: None)

    return step


def test_a_right_file_is_not_even_calibrated(
    vehicle: Vehicle, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError

    monkeypatch.setattr(first_step, 'calibrate_flights', refuse)
    flights = read_flights(vehicle, tmp_path, is_right=True)
    assert calibrate_first(vehicle, 'gtmab', flights, lambda _what, _part: None) == FirstStep()


@pytest.mark.parametrize(
    ('values', 'after', 'called'),
    [
        ((GAIN,), 0.02, True),
        ((GAIN,), 0.45, False),  # forecasts hardly better than the file's
        ((make_value('wrench_gain.surge', 1.0, 0.7, 0.01),), 0.02, False),  # a usual gain
        ((make_value('wrench_gain.surge', 1.0, 0.3, 0.3),), 0.02, False),  # not sure
        ((make_value('marker_offset.pitch', 0.0, 0.09, 0.002),), 0.02, True),
        ((make_value('marker_offset.x', 0.0, 0.015, 0.001),), 0.02, False),
        ((make_value('vehicle.pitch', 1.0, 0.6, 0.03),), 0.02, True),  # no effect is an inertia
        ((make_value('vehicle.mass', 1.0, 0.6, 0.03),), 0.02, False),
        ((make_value('cg_offset.x', 0.0, 0.02, 1e-4),), 0.02, False),  # discovery names it
        ((make_value('rotor_1.thrust', 1.0, 0.7, 0.01),), 0.02, False),  # a fault has a name
        ((make_value('rotor_1.thrust', 1.0, -0.7, 0.01),), 0.02, True),
        (tuple(make_value('net_lift.force', 0.0, force, 1e-4, name)
               for name, force in (('A', 0.021), ('B', 0.012))), 0.02, True),
        (tuple(make_value('net_lift.force', 0.0, force, 1e-4, name)
               for name, force in (('A', 0.021), ('B', 0.020))), 0.02, False),
    ],
)  # fmt: skip
def test_what_calls_for_a_calibration(
    vehicle: Vehicle,
    decide: Decide,
    values: tuple[CalibratedValue, ...],
    after: float,
    *,
    called: bool,
) -> None:
    nominal = NominalVehicle.from_vehicle(vehicle)
    found = make_calibration(nominal, *values, after=after)
    assert decide(found).calibration == (found if called else None)


def test_every_number_beyond_tolerance_is_reported(vehicle: Vehicle) -> None:
    """Numbers without words of their own by their value, the clearest first."""
    drag, lever, lift = (
        make_value('linear_drag.sway', 0.0, 0.05, 0.005),
        make_value('wrench_gain.pitch_from_surge', 0.0, 0.02, 0.001),
        make_value('net_lift.force', 0.0, 0.01, 0.001, flight='A'),
    )
    found = make_calibration(NominalVehicle.from_vehicle(vehicle), drag, lever, lift, GAIN)
    first, second, third, fourth = list_differences(found)
    assert first == 'surge: 30 % of the commanded force arrives'
    assert second.startswith('net lift: 10 mN')
    assert third.startswith('wrench gain (pitch from surge) 0.020')
    assert fourth.startswith('linear drag (sway) 0.050')
    assert fourth.endswith('(vehicle file: 0)')


@pytest.mark.parametrize(
    ('method', 'highest', 'differ'),
    [
        ('likelihood', 0.021, True),
        ('likelihood', 0.0125, False),
        ('forecasts', 0.021, True),
        ('file', 0.021, False),
    ],
)
def test_flights_of_a_good_file_may_have_lifts_of_their_own(
    vehicle: Vehicle,
    decide: Decide,
    method: str,
    highest: float,
    *,
    differ: bool,
) -> None:
    """A calibration that forecasts no better is not used, but its lifts differ by 9 mN."""
    lifts = tuple(
        make_value('net_lift.force', 0.0, force, 1e-4, name)
        for name, force in (('A', 0.012), ('B', highest))
    )
    found = make_calibration(NominalVehicle.from_vehicle(vehicle), *lifts, after=0.9)
    found = replace(found, method=method)
    result = decide(found, 'net_lift.force')
    assert result.calibration is None
    assert result.lifts == (lifts if differ else ())
    if differ:
        assert '12 mN in A, 21 mN in B' in format_lift_warning(result.lifts)


def test_a_free_lift_is_that_of_a_calibration_and_no_candidate(vehicle: Vehicle) -> None:
    nominal = NominalVehicle.from_vehicle(vehicle)
    before = list_free_parameters(nominal)
    after = free_flight_lifts(before, nominal)
    changed = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert [b.name for _, b in changed] == ['net_lift.force']
    old, new = changed[0]
    assert old.tolerance == 0.0006
    assert new.tolerance == pytest.approx(0.01 * 9.81 * nominal.mass, rel=1e-3)
    assert new.typical == 0.0
    assert new.per_flight


def test_flights_of_three_seconds_are_calibrated_by_their_shorter_forecasts(
    vehicle: Vehicle, wrong: list[AssignedFlight]
) -> None:
    """No flight has a forecast over 3 s; many such runs have those over a second."""
    name, _, flight = wrong[0]
    edges = np.linspace(0.0, 1.0, 10)
    runs = [
        (f'{name}_{k}', 'train', restrict_to_interval(flight, *each))
        for k, each in enumerate(itertools.pairwise(edges))
    ]
    found = calibrate_flights(vehicle, 'gtmab', runs, lambda _what, _part: None)
    main = find_main_score(found.scores['train'])
    assert main is not None
    assert main.horizon == 1.0
    assert main.positions[CALIBRATED] < 0.5 * main.positions[FILE_MODEL]


def test_a_flight_too_short_for_forecasts_disturbs_no_calibration(
    vehicle: Vehicle, wrong: list[AssignedFlight]
) -> None:
    """Of a second; what it tells of its own lift is next to nothing, and its interval is wide."""
    (name, _, flight), (other, _, rest) = wrong
    brief = (other, 'train', restrict_to_interval(rest, 0.5, 0.54))
    alone, both = (
        calibrate_flights(vehicle, 'gtmab', each, lambda _what, _part: None)
        for each in ([(name, 'train', flight)], [(name, 'train', flight), brief])
    )
    for axis in ('surge', 'heave'):
        first, second = (each.find(f'wrench_gain.{axis}') for each in (alone, both))
        assert first is not None
        assert second is not None
        assert second.value == pytest.approx(first.value, abs=3.0 * first.deviation)
    known, unknown = both.list_of_flights('net_lift.force')
    assert unknown.deviation > 3.0 * known.deviation


def test_calibrated_numbers_are_no_candidates(vehicle: Vehicle) -> None:
    """Tolerances are the usual ones, or the intervals if those are wider; drag stays an effect."""
    nominal = NominalVehicle.from_vehicle(vehicle).with_value('wrench_gain', 'surge', 0.3)
    values = [
        GAIN,
        make_value('marker_offset.x', 0.0, 0.1, 0.03),
        make_value('command_delay.delay', 0.0, 0.2, 1e-4),
        make_value('quadratic_drag.surge', 0.09, 0.2, 0.001),
        make_value('net_lift.force', 0.0, 0.02, 1e-3, 'A'),
        make_value('helium_leak.rate', 0.0, 1e-4, 1e-5, 'A'),
    ]
    before = {one.name: one for one in list_free_parameters(nominal, wrench=True)}
    after = {one.name: one for one in apply_calibration(list(before.values()), nominal, values)}
    assert after['wrench_gain.surge'].tolerance == pytest.approx(0.2 * 0.3)
    assert after['wrench_gain.yaw'] == before['wrench_gain.yaw']
    assert after['marker_offset.x'].tolerance == pytest.approx(0.03)
    assert after['command_delay.delay'].tolerance == pytest.approx(0.005)
    assert before['command_delay.delay'].typical > 0.0
    assert after['command_delay.delay'].typical == 0.0
    assert after['quadratic_drag.surge'] == before['quadratic_drag.surge']
    assert after['net_lift.force'].tolerance > 0.03
    assert after['net_lift.force'].typical == 0.0
    assert after['helium_leak.rate'].per_flight
    assert after['helium_leak.rate'].tolerance == pytest.approx(1e-4)
    assert after['helium_leak.rate'].low == -math.inf


def test_a_calibration_that_confirming_flights_contradict_is_not_advised(vehicle: Vehicle) -> None:
    sound = make_calibration(NominalVehicle.from_vehicle(vehicle), GAIN)
    worse = make_score((0.14, 0.3), (0.09, 0.2), (0.11, 0.2))
    bad = replace(sound, scores=sound.scores | {'confirm': (worse,)})
    assert build_report(sound, None).headline == 'Surge: 30 % of the commanded force arrives.'
    assert build_report(bad, None).headline == (
        'The confirming flights contradict the calibration, so keep the vehicle file. Estimated '
        'from the training flights alone: Surge: 30 % of the commanded force arrives.'
    )
    assert f'--vehicle {bad.vehicle} ' in build_report(bad, 'a file').closing[-1]
    assert '--vehicle calibrated.yaml ' in build_report(sound, 'a file').closing[-1]


def test_a_pendulum_is_named_by_its_rate_where_nothing_tells_what_makes_it_so(
    vehicle: Vehicle,
) -> None:
    """A centre of gravity twice as deep: 1.41 times the rate."""
    nominal = NominalVehicle.from_vehicle(vehicle)
    found = make_calibration(nominal)
    before, _ = pendulum_rates(nominal)
    faster = nominal.with_value('cg_height', 'z', float(nominal.cg[2]))
    after, _ = pendulum_rates(faster)
    known = replace(found, calibrated=faster, pendulum_deviations=(0.02, math.inf))
    percent = 100.0 * (after / before - 1.0)
    assert list_differences(known) == [f'the roll pendulum is {percent:.0f} % faster']
    assert list_differences(replace(known, pendulum_deviations=(0.2, 0.2))) == []
    over = nominal.with_value('cg_height', 'z', -2.0 * float(nominal.cg[2]))
    assert list_differences(replace(known, calibrated=over)) == []  # it does not swing


def test_the_headline_does_not_contradict_the_tile_below_it(vehicle: Vehicle) -> None:
    """A delay of 20 ms and a pendulum a little faster have no words of their own."""
    nominal = NominalVehicle.from_vehicle(vehicle)
    late = make_value('command_delay.delay', 0.0, 0.02, 0.003)
    slow = make_value('vehicle.roll', 1.0, 1.1, 0.01)
    bias = make_value('imu_bias.x', 0.0, 1.0, 0.01, flight='A')
    report = build_report(make_calibration(nominal, late, slow, bias), 'a file')
    assert (report.tiles[0].name, report.tiles[0].value) == ('Beyond tolerance', '2')
    assert report.headline == (
        'Inertia in roll (factor) 1.100 (vehicle file: 1); command delay 0.020 (vehicle file: 0).'
    )
    assert 'lta discover' in report.closing[-1]
    report = build_report(make_calibration(nominal, bias), None)
    assert report.tiles[0].value == '0'
    assert report.headline == 'The vehicle file is within its tolerances.'
    assert len(report.closing) == 2


def rotor_wrench(nominal: NominalVehicle, rotor: int, duty: float) -> np.ndarray:
    a, b = (nominal.parameter_value('thrust_curve', f'{part}_{rotor}') for part in 'ab')
    thrust = a * duty * abs(duty) + b * duty
    column = [nominal.parameter_value('rotor_thrust', f'{axis}_{rotor}') for axis in AXES]
    reverse = [
        nominal.parameter_value('rotor_envelope_interaction', f'{axis}_{rotor}') for axis in AXES
    ]
    return np.multiply(column, thrust) + np.multiply(reverse, min(thrust, 0.0))


def test_a_rotor_that_pushes_backwards_has_a_sign_in_the_file(
    vehicle: Vehicle, tmp_path: Path
) -> None:
    """All rotors keep one thrust curve, as control laws need; the columns have the shares."""
    nominal = NominalVehicle.from_vehicle(vehicle)
    wanted = nominal
    for rotor, share in enumerate((0.9, 2.2, -1.78, 1.0), start=1):
        for part in (f'a_{rotor}', f'b_{rotor}'):
            thrust = share * nominal.parameter_value('thrust_curve', part)
            wanted = wanted.with_value('thrust_curve', part, thrust)
    found = replace(make_calibration(nominal), calibrated=wanted)
    path = tmp_path / 'calibrated.yaml'
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    path.write_text(format_calibrated_vehicle(text, vehicle, found, 'a test'))
    read = load_vehicle(str(path))
    assert read.full_thrust == pytest.approx(2.2 * vehicle.full_thrust)
    assert read.allocation[2][0] == pytest.approx(-1.78 / 2.2 * vehicle.allocation[2][0])
    for rotor in range(1, 5):
        np.testing.assert_allclose(
            rotor_wrench(NominalVehicle.from_vehicle(read), rotor, 0.4),
            rotor_wrench(wanted, rotor, 0.4),
            rtol=1e-9,
            atol=1e-12,
        )


@pytest.mark.parametrize('turned', [False, True])
def test_a_rotor_that_pushes_weaker_in_reverse_is_written_as_one(
    tmp_path: Path, turned: bool
) -> None:
    """For duties of either sign the file pushes as the fit, also with a rotor turned around."""
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    for rotor in ('up_left', 'up_right', 'forward_left', 'forward_right'):
        text = set_yaml_values(text, {f'rotors.{rotor}.reversible': True})
    vehicle = parse_vehicle(text, 'gtmab')
    nominal = NominalVehicle.from_vehicle(vehicle)
    share, reverse = (-0.5, 1.0 / 0.4) if turned else (0.8, 0.4)
    wanted = nominal
    for part in ('a_1', 'b_1'):
        wanted = wanted.with_value(
            'thrust_curve', part, share * nominal.parameter_value('thrust_curve', part)
        )
    wanted = build_reverse_parameter(nominal, 1).apply_to(wanted, reverse - 1.0)
    # By hand: forward -0.5 / 0.4 of the file's thrust, and 0.4 of that in reverse
    assert split_by_duty(share, reverse) == pytest.approx((-1.25 if turned else 0.8, 0.4))
    found = replace(make_calibration(nominal), calibrated=wanted)
    path = tmp_path / 'calibrated.yaml'
    path.write_text(format_calibrated_vehicle(text, vehicle, found, 'a test'))
    assert 'rotor_envelope_interaction' not in path.read_text()
    read = NominalVehicle.from_vehicle(load_vehicle(str(path)))
    for rotor, duty in ((1, 0.4), (1, -0.4), (2, -0.4), (4, -0.4)):
        np.testing.assert_allclose(
            rotor_wrench(read, rotor, duty),
            rotor_wrench(wanted, rotor, duty),
            rtol=1e-9,
            atol=1e-12,
        )


def test_reverse_is_calibrated_of_rotors_that_are_flown_in_reverse_alone() -> None:
    duties = [np.array([[0.5, -0.5, -0.5, -0.04]]), np.zeros((0, 4))]
    assert list_reversed_rotors(duties, (True, True, False, True)) == [2]


def test_a_rotor_the_wrong_way_round_is_stated_by_duty(vehicle: Vehicle) -> None:
    nominal = NominalVehicle.from_vehicle(vehicle)
    knobs = list_calibration_parameters(nominal, [False] * 6, True, [1])
    names = [knob.name for knob in knobs]
    pair = [names.index('rotor_1.thrust'), names.index('rotor_1.reverse')]
    shared, covariance = np.zeros(len(knobs)), np.zeros((len(knobs), len(knobs)))
    # Fitted: -0.5 of the thrust, 2.5 of it for positive duties, exact to 0.01 for negative ones
    shared[pair] = -1.5, 1.5
    covariance[pair[0], pair[0]] = 1e-4
    values = [make_value(names[k], 1.0, 1.0 + shared[k], 0.01) for k in pair]
    thrust, reverse = state_by_duty(values, knobs, shared, covariance)
    assert (thrust.value, reverse.value) == pytest.approx((-1.25, 0.4))
    assert thrust.deviation == pytest.approx(0.025)
    assert reverse.deviation == 0.0
