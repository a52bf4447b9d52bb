# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""An afternoon's logs: CSV files of the independent simulator, what is missing, thrust laws."""

from collections.abc import Sequence
from dataclasses import replace
import importlib.util
import math
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from campaigns.challenge.flight import FlightSimulator, TICK
from campaigns.challenge.sensors import SensorSet
from campaigns.challenge.truth import Six, VehicleTruth
from lta_discovery.flights.measured_flight import Stream
from lta_discovery.lab_tests.design import LabTest
from lta_discovery.lab_tests.plan import LabPlan, plan_lab_tests
from lta_discovery.lab_tests.reading import (
    build_reading_report,
    LabReading,
    list_missing_tests,
    read_lab_tests,
)
from lta_discovery.lab_tests.recognition import recognise_tests, RecognisedTest
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

from ..step_pilot import StepPilot  # noqa: TID252 - `test` is Python's own

ROOT = Path(__file__).resolve().parents[4]
ROTORS = ('up_left', 'up_right', 'forward_left', 'forward_right')


@pytest.fixture(scope='module')
def example() -> ModuleType:
    """The script of the tutorial."""
    path = ROOT / 'examples/blimp_afternoon.py'
    spec = importlib.util.spec_from_file_location('blimp_afternoon', path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope='module')
def plan() -> LabPlan:
    return plan_lab_tests(load_vehicle('gtmab'), 'gtmab', 'wrench')


def calibrated(*unknown: str) -> Any:
    """Return a calibration in which all numbers are known but some."""
    names = {
        'net_lift.force', 'wrench_gain.surge', 'rotational_drag.pitch', 'rotational_drag.pitch_2',
        'vehicle.pitch', 'marker_offset.x', *unknown,
    }  # fmt: skip
    values = [SimpleNamespace(name=name, is_known=name not in unknown) for name in names]
    return SimpleNamespace(values=values)


def recognised(*kinds: tuple[Any, str]) -> dict[str, tuple[RecognisedTest, ...]]:
    return {f'log_{k}': (RecognisedTest(*kind, ''),) for k, kind in enumerate(kinds)}


ALL: tuple[tuple[Any, str], ...] = (
    ('float', ''), ('swing', 'roll'), ('swing', 'pitch'), ('step', 'surge'), ('step', 'heave'),
    ('step', 'yaw'), ('spin_down', 'yaw'), ('free_flight', ''), ('free_flight', ''),
)  # fmt: skip


def test_a_missing_test_is_named_with_what_it_would_teach(plan: LabPlan) -> None:
    known = {name for one in plan.tests for name, _ in one.informs}
    found = calibrated()
    found.values = [SimpleNamespace(name=name, is_known=True) for name in known]
    assert list_missing_tests(plan, recognised(*ALL), found, ROTORS) == []
    # Without a swing, but all is known from the flights: nothing is missing
    rest = recognised(*(one for one in ALL if one != ('swing', 'pitch')))
    assert list_missing_tests(plan, rest, found, ROTORS) == []
    for one in found.values:
        one.is_known = one.name not in ('rotational_drag.pitch', 'rotational_drag.pitch_2')
    assert list_missing_tests(plan, rest, found, ROTORS) == [
        "No swing in pitch: damping in pitch stays the file's; let it swing in pitch for 40 s "
        'from 20 degrees.'
    ]
    for one in found.values:
        one.is_known = one.name != 'wrench_gain.surge'
    rest = recognised(*(one for one in ALL if one != ('step', 'surge')))
    assert list_missing_tests(plan, rest, found, ROTORS) == [
        "No step in surge: gain in surge stays the file's; command 49 mN forward for 11 s."
    ]
    for one in found.values:
        one.is_known = one.name not in ('wrench_gain.exponent_surge', 'wrench_gain.reverse_yaw')
    assert list_missing_tests(plan, recognised(*ALL), found, ROTORS) == [
        'No smaller step in surge: exponent of the thrust in surge cannot be told from the gain; '
        'command 20 mN forward for 11 s.',
        'No reverse step in yaw: thrust in reverse in yaw cannot be told from the gain; command '
        '3.4 mN m to the right for 11 s.',
    ]
    more = recognised(*ALL)
    for k, (axis, size) in enumerate((('surge', 0.05), ('surge', 0.02), ('yaw', -0.004),
                                      ('yaw', 0.004))):  # fmt: skip
        more[f'more_{k}'] = (RecognisedTest('step', axis, '', size),)
    assert list_missing_tests(plan, more, found, ROTORS) == []
    one_flight = recognised(*ALL[:-1])
    for one in found.values:
        one.is_known = True
    (said,) = list_missing_tests(plan, one_flight, found, ROTORS)
    assert said.startswith('Only one free flight')


@pytest.mark.parametrize(
    ('axis', 'levels', 'size'),
    [
        ('surge', (0.0, 0.1, 0.0), 0.1),
        ('surge', (0.0, -0.1), -0.1),
        ('surge', (0.1, 0.0), 0.1),  # begins in the step
        ('surge', (-0.1, 0.0, -0.1), -0.1),
        ('yaw', (0.004, 0.0), 0.004),
        # A trim in heave
        ('heave', (0.03, 0.07, 0.03), 0.04),
        ('heave', (0.03, 0.01, 0.03), -0.02),
        ('heave', (0.07, 0.03), 0.04),
        ('heave', (0.03, -0.02), -0.05),
    ],
)
def test_a_step_leaves_the_rest_or_a_trim(
    axis: str, levels: tuple[float, ...], size: float
) -> None:
    values = np.zeros((50 * len(levels), 6))
    values[:, AXES.index(axis)] = np.repeat(levels, 50)
    flight: Any = SimpleNamespace(
        time=np.arange(0.0, 3.0, 0.04), quaternion=np.tile([1.0, 0.0, 0.0, 0.0], (75, 1)),
        wrench=Stream(0.1 * np.arange(len(values)), values),
    )  # fmt: skip
    (step,) = recognise_tests(flight, load_vehicle('gtmab'))
    assert (step.kind, step.axis, step.size) == ('step', axis, pytest.approx(size))


@pytest.fixture(scope='module')
def reading(example: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> LabReading:
    """A swing and a push, without a mapping; the names say the opposite."""
    folder = tmp_path_factory.mktemp('afternoon')
    kept = {'swing_1': 'push', 'push_1': 'swing', 'push_3': 'float'}
    example.write_afternoon(
        folder, 4, lambda name: name.partition('/')[2].removesuffix('.csv') in kept
    )
    logs = folder / 'tests'
    for name, other in kept.items():
        (logs / f'{name}.csv').rename(logs / f'{other}.csv')
    return read_lab_tests('gtmab', logs, None, {}, None, lambda _what, _part: None)


@pytest.mark.long
def test_logs_are_recognised_by_their_motion(reading: LabReading) -> None:
    assert {name: [one.title for one in tests] for name, tests in reading.tests.items()} == {
        'push': ['swing in pitch'], 'swing': ['step in surge'], 'float': ['step in yaw'],
    }  # fmt: skip
    assert 'quaternion: [qx, qy, qz, qw], order: xyzw' in reading.drafts['mapping.yaml']


@pytest.mark.long
def test_an_afternoon_gives_a_vehicle_file_and_says_what_is_missing(
    reading: LabReading, example: ModuleType
) -> None:
    report = build_reading_report(reading)
    assert report.headline.startswith('Surge: 30 % of the commanded force arrives')
    assert 'calibrated.yaml' in report.outputs
    surge = reading.calibration.find('wrench_gain.surge')
    assert surge is not None
    assert surge.ci95[0] <= example.SURGE <= surge.ci95[1]
    assert any('No step in heave' in one and 'gain in heave' in one for one in reading.missing)
    assert not any('No swing in pitch' in one for one in reading.missing)
    assert isinstance(report.data, dict)
    assert report.data['tests']['push']['tests'][0]['kind'] == 'swing'
    assert report.closing[-1].endswith('would teach more: see What is missing.')


def test_the_blimp_of_the_tutorial_is_the_one_that_it_describes(example: ModuleType) -> None:
    """0.3 of the surge, a pendulum that is 40 % faster, markers 3 to 15 degrees off."""
    for seed in range(5):
        blimp = example.draw_blimp(np.random.default_rng([seed, 37]))
        file = example.build_vehicle_truth(load_vehicle('gtmab'))
        assert blimp.wrench_gains[0] == 0.3
        turn = example.Rotation.from_euler('ZYX', blimp.marker_turn).magnitude()
        assert 3.0 <= math.degrees(turn) <= 15.0
        ratio = math.sqrt((blimp.cg[2] / file.cg[2]) * (own_inertia(file) / own_inertia(blimp)))
        assert ratio == pytest.approx(1.4, abs=0.02)


def own_inertia(truth: Any) -> float:
    """Return the inertia of the pendulum in pitch, about the hull centre, less the coupling."""
    c, mass = truth.cg[2], truth.mass
    return float(
        truth.inertia[1] + mass * c * c + truth.added_inertia[1]
        - (mass * c) ** 2 / (mass + truth.added_mass[0])
    )  # fmt: skip


EXPONENT, REVERSE = 2.0, 0.6
# Commands at which they push as they should [N, N m]
FULL: Six = (0.05, 1.0, 0.08, 1.0, 1.0, 0.005)
HEAD = 'timestamp_ms,x_mm,y_mm,z_mm,qx,qy,qz,qw,cmd_fx,cmd_fy,cmd_fz,cmd_tau_x,cmd_tau_y,cmd_tau_z'


class SquareActuators:
    """Propellers whose thrust goes by the square of the command, and is weaker in reverse."""

    def __init__(self, truth: VehicleTruth, duties: Sequence[float]) -> None:
        self.gains = truth.wrench_gains
        self.set_duties(duties)

    def set_duties(self, duties: Sequence[float]) -> None:
        """Set the commanded wrench from now on."""
        self.wrench = list(duties)

    def advance(self, seconds: float) -> None:
        """Do nothing: the wrench is held."""

    def thrusts_after_command(self, seconds: float) -> list[float]:
        """Return the wrench that acts on each axis."""
        return [
            full
            * math.copysign(abs(one / full) ** EXPONENT, one)
            * (REVERSE if one < 0.0 else 1.0)
            for one, full in zip(self.wrench, FULL, strict=True)
        ]

    def total_wrench(self, thrusts: Sequence[float]) -> Six:
        """Return the wrench."""
        a, b, c, d, e, f = thrusts
        return a, b, c, d, e, f


def write_log(path: Path, blimp: VehicleTruth, test: LabTest, draw: np.random.Generator) -> None:
    """Fly a test, and write its file as a tracker does."""
    tilt = [math.cos(0.5 * test.tilt), 0.0, 0.0, 0.0]
    tilt[1 + (test.axis == 'pitch')] = math.sin(0.5 * test.tilt)
    begin = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, *tilt, 0.0, 0.0, test.rate]
    pilot = StepPilot(AXES.index(test.axis), test.size) if test.axis else StepPilot()
    flight = FlightSimulator(blimp, pilot, actuators=SquareActuators)
    trajectory = flight.simulate_flight(begin, test.seconds)
    time, poses = SensorSet(trajectory, blimp, 'millisecond', draw).measure_poses()
    newest = np.clip((time / TICK + 1e-6).astype(int), 0, len(trajectory.commands) - 1)
    table = np.column_stack([
        1e3 * time + 5000.0, 1e3 * poses[:, :3], poses[:, 3:], trajectory.commands[newest]
    ])  # fmt: skip
    np.savetxt(path, table, fmt=['%.0f', *['%.2f'] * 3, *['%.6f'] * 4, *['%.5f'] * 6],
               delimiter=',', header=HEAD, comments='')  # fmt: skip


@pytest.mark.long
def test_the_planned_steps_show_exponent_and_reverse(tmp_path: Path, example: ModuleType) -> None:
    vehicle = load_vehicle('gtmab')
    # A vehicle file that is off, as in the tutorial
    blimp = example.draw_blimp(np.random.default_rng([3, 37]))
    plan = plan_lab_tests(vehicle, 'gtmab', 'wrench')
    tests = [
        one.test for one in plan.tests if one.is_needed and one.test.kind != 'free_flight'
    ]  # fmt: skip
    for k, test in enumerate(tests):
        draw = np.random.default_rng([3, 37, k])
        lifted = replace(blimp, lift=draw.uniform(0.0, 0.006))
        write_log(tmp_path / f'log_{k:02d}.csv', lifted, test, draw)
    found = read_lab_tests('gtmab', tmp_path, None, {}, None, lambda _what, _part: None)
    # The intervals are far from 1, the law of a proportional command
    for name, truth, width in (
        ('exponent_surge', EXPONENT, 0.6),
        ('exponent_heave', EXPONENT, 0.6),
        ('exponent_yaw', EXPONENT, 0.3),
        ('reverse_yaw', REVERSE, 0.1),
    ):
        value = found.calibration.find(f'wrench_gain.{name}')
        assert value is not None, name
        assert value.ci95[0] <= truth <= value.ci95[1], (name, value.ci95)
        assert value.ci95[1] - value.ci95[0] < width, (name, value.ci95)
    assert not [said for said in found.missing if 'exponent' in said or 'reverse' in said]
