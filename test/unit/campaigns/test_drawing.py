# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Cases of the independent simulator are drawn from seed, number and kind alone."""

import ast
from dataclasses import replace
from pathlib import Path

import campaigns.challenge as challenge
from campaigns.challenge.air import RoomAirMotion, UnsteadyWind
from campaigns.challenge.case_generator import ChallengeCase, Kind, OtherCaseGenerator
from campaigns.challenge.effect_injection import (
    HIDINGS,
    inject_effects,
    OF_ROTORS,
    OF_WRENCH,
    true_values,
)
from campaigns.challenge.flight import FlightSimulator
from campaigns.challenge.pilot import SwingingPilot
from campaigns.challenge.sensors import SensorSet
from campaigns.challenge.tolerance import perturb_vehicle
from campaigns.challenge.truth import build_vehicle_truth, VehicleTruth
from campaigns.challenge.unlisted import UNLISTED, wrench_strength
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

VEHICLE = load_vehicle('gtmab')
SHORT = (5.0, 6.0)
TOPICS = ('ground_truth/odom', 'imu', 'range', 'pressure', 'battery')
# Values at which each knob is tried: the middle of its range.
MIDDLE = {
    knob: 0.5 * (hiding.least + hiding.most) for knob, hiding in HIDINGS.items()
    if not knob.startswith(OF_WRENCH)
}  # fmt: skip


@pytest.fixture(scope='module')
def truth() -> VehicleTruth:
    """Return the vehicle as its file has it."""
    return build_vehicle_truth(VEHICLE)


def drawn(
    number: int, kind: Kind | None = None, seconds: tuple[float, float] = SHORT
) -> ChallengeCase:
    """Draw a case."""
    return OtherCaseGenerator(VEHICLE, 3, number, kind, seconds).generate_case()


def seen(truth: VehicleTruth, seconds: float = 3.0) -> dict[str, np.ndarray]:
    """Return what is recorded of a flight, by topic, of the same chance always."""
    draw = np.random.default_rng(2)
    air = [UnsteadyWind(truth, seconds, np.random.default_rng(7))]
    pilot = SwingingPilot(seconds, build_vehicle_truth(VEHICLE), draw)
    # In all directions at once, so that all drag acts.
    begin = [0.0, 0.0, 1.5, 0.3, 0.2, -0.2, 1.0, 0.0, 0.0, 0.0, 0.2, 0.2, 0.2]
    flown = FlightSimulator(truth, pilot, air).simulate_flight(begin, seconds)
    streams = SensorSet(flown, truth, 'exact', np.random.default_rng(4)).record_streams()
    return {topic: values for topic, (_, values) in streams.items()}


def test_no_code_is_shared_with_the_model() -> None:
    allowed = ('lta_config.errors', 'lta_config.vehicle_edit', 'lta_model.vehicle')
    # These record the flights and score what discovery says of them
    beside = ('recording.py', 'score.py', 'trial.py')
    files = [one for one in Path(challenge.__path__[0]).glob('*.py') if one.name not in beside]
    assert len(files) > 10
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding='utf-8'))):
            names = [node.module] if isinstance(node, ast.ImportFrom) else []
            names += [one.name for one in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                own = name is not None and name.startswith('lta_')
                assert not own or name.startswith(allowed), file


def test_a_case_depends_on_seed_number_and_kind_alone() -> None:
    first, again, another = drawn(3, 'pair'), drawn(3, 'pair'), drawn(4, 'pair')
    assert first.answer == again.answer != another.answer
    for one, two in zip(first.flights, again.flights, strict=True):
        for topic, (time, values) in one.streams.items():
            assert np.array_equal(time, two.streams[topic][0])
            assert np.array_equal(values, two.streams[topic][1])


def test_kinds_hide_what_they_say_and_can_be_judged() -> None:
    for kind, (count, outside) in {
        'clean': (0, False), 'single': (1, False), 'pair': (2, False), 'mixed': (1, True),
    }.items():  # fmt: skip
        case = drawn(1, kind)  # type: ignore[arg-type]
        answer = case.answer
        assert (answer['kind'], len(answer['hidden'])) == (kind, count)
        assert (answer['outside'] in UNLISTED, answer['size'] > 0.0) == (outside, outside)
        effects = {one['knob'].partition('.')[0] for one in answer['hidden']}
        assert set(answer['nominal']['given']) == effects
        assert len(effects) == count
        for flight in case.flights:
            assert set(flight.streams) == {*TOPICS, 'motors'}


def test_a_commanded_wrench_hides_what_its_log_can_show() -> None:
    for number in range(8):
        case = drawn(number, 'wrench', (3.0, 4.0))
        (hidden,) = case.answer['hidden']
        assert not hidden['knob'].startswith(OF_ROTORS)
        assert hidden['knob'].partition('.')[0] in case.answer['nominal']['given']
        for flight in case.flights:
            assert set(flight.streams) == {'ground_truth/odom', 'wrench_command'}
            wrench = flight.streams['wrench_command'][1]
            assert np.all(wrench[:, [1, 3, 4]] == 0.0)
            assert np.all(np.ptp(wrench, 0)[[0, 2, 5]] > 0.0)


def test_a_rough_tracker_loses_and_misplaces_the_vehicle() -> None:
    time, poses = drawn(2, 'rough', (60.0, 61.0)).flights[0].streams['ground_truth/odom']
    gaps, steps = np.diff(time), np.linalg.norm(np.diff(poses[:, :3], axis=0), axis=1)
    assert np.median(gaps) == pytest.approx(0.03, rel=0.01)
    assert 0.3 < np.max(gaps) < 4 * 1.5
    assert 2 <= np.sum(steps[gaps < 0.1] > 0.3) < 30


def test_flights_are_vigorous_and_stay_above_the_floor() -> None:
    for flight in drawn(0, 'clean', (30.0, 32.0)).flights:
        poses = flight.streams['ground_truth/odom'][1]
        tilt = np.degrees(np.arccos(1.0 - 2.0 * (poses[:, 3] ** 2 + poses[:, 4] ** 2)))
        assert 10.0 < np.max(tilt) < 35.0
        assert 0.6 < np.min(poses[:, 2]) < np.max(poses[:, 2]) < 2.6
        time, duties = flight.streams['motors']
        assert np.diff(time) == pytest.approx(np.full(len(time) - 1, 0.01))
        assert 0.0 <= np.min(duties) < np.max(duties) <= 1.0


def test_each_hidden_effect_changes_what_is_recorded(truth: VehicleTruth) -> None:
    plain = seen(truth)
    for knob, value in MIDDLE.items():
        other_one = seen(inject_effects(truth, {knob: value}))
        far = [
            np.max(np.abs(values - other_one[topic])) / np.std(values)
            if values.shape == other_one[topic].shape else np.inf
            for topic, values in plain.items() if topic not in ('motors', 'battery')
        ]  # fmt: skip
        assert max(far) > 0.003, knob  # of the same chance: without it they are equal


def test_what_is_told_is_true_of_the_vehicle_as_built(truth: VehicleTruth) -> None:
    as_built = perturb_vehicle(truth, np.random.default_rng(5))
    hidden = {
        'quadratic_drag.surge': 0.1, 'added_mass.heave': 0.05, 'motor_lag': 0.1,
        'thrust_scale.factor': -0.2, 'rotor_fault.lost_2': 0.3, 'cg_offset.x': 0.01,
        'munk_moment.lost': 0.6, 'rotational_drag.yaw': 1e-3,
    }  # fmt: skip
    given = true_values(inject_effects(as_built, hidden), truth, hidden)
    assert given['quadratic_drag'] == {'surge': pytest.approx(as_built.drag[0] + 0.1)}
    assert given['added_mass'] == {'heave': pytest.approx(as_built.added_mass[2] + 0.05)}
    # Two stages in series, of 90 % and 10 %: their variances add up
    lag = (0.9**2 + 0.1**2) ** 0.5 * (as_built.lag + 0.1)
    assert given['motor_lag'] == dict.fromkeys(('up', 'down'), pytest.approx(lag))
    assert given['thrust_scale'] == {'factor': pytest.approx(0.8 * as_built.thrust)}
    assert given['rotor_fault'] == {'lost_2': pytest.approx(1.0 - 0.7 * as_built.gains[1])}
    assert given['cg_offset'] == {'x': pytest.approx(as_built.cg[0] + 0.01)}
    assert given['munk_moment'] == {'lost': pytest.approx(1.0 - 0.4 * 0.52)}
    assert given['rotational_drag'] == {'yaw': pytest.approx(as_built.turn_linear[2] + 1e-3)}
    # Trimmed: as heavy over the air as its file has it.
    assert as_built.mass != truth.mass
    heavy = truth.mass - truth.displaced
    assert as_built.mass - as_built.displaced == pytest.approx(heavy, abs=1e-12)


@pytest.mark.parametrize('name', UNLISTED)
def test_each_thing_outside_the_library_pushes(truth: VehicleTruth, name: str) -> None:
    kind, draw = UNLISTED[name], np.random.default_rng(1)
    numbers = {key: span.draw_value(draw) for key, span in kind.numbers.items()}
    numbers |= {'size': (kind.numbers['size'].least * kind.numbers['size'].most) ** 0.5}
    numbers |= {key: 0.0 for key in ('x', 'y', 'way') if key in numbers}
    numbers |= {'rotor': 2.0} if 'rotor' in numbers else {}
    pilot = SwingingPilot(7.0, truth, draw)
    begin = [0.5, 0.3, 1.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    flown = FlightSimulator(truth, pilot, [], kind.make(numbers)).simulate_flight(begin, 7.0)
    assert 0.5 < wrench_strength(flown.unlisted) < 200.0
    assert np.all(np.isfinite(flown.states))


def test_draughts_are_as_strong_as_they_are_told(truth: VehicleTruth) -> None:
    air = RoomAirMotion(2e-3, 2000.0, np.random.default_rng(6))
    series = np.array(
        [air.sample_flow(time, 0.0, 0.0, 1.0) for time in np.arange(0.0, 2000.0, 0.5)]
    )
    assert np.std(series[:, :2], axis=0) == pytest.approx([2e-3, 2e-3], rel=0.15)
    # Two filters of 2.5 s: (1 + t / T) exp(-t / T) of it is left after a time t.
    u = series[:, 0] - np.mean(series[:, 0])
    assert np.mean(u[5:] * u[:-5]) / np.mean(u * u) == pytest.approx(2.0 / np.e, abs=0.1)
    wind = UnsteadyWind(replace(truth, wind=(0.2, 0.0, 0.0)), 100.0, np.random.default_rng(6))
    speeds = [wind.sample_flow(time, 0.0, 0.0, 1.0)[0] for time in np.arange(0.0, 100.0, 0.5)]
    assert np.mean(speeds) == pytest.approx(0.2, rel=0.02)
    assert 0.01 * 0.2 < np.std(speeds) < 0.03 * 0.2
