"""The planned steps show the law of a thrust, on a blimp of the independent simulator."""

from collections.abc import Sequence
from dataclasses import replace
import importlib.util
import math
from pathlib import Path
from types import ModuleType

from campaigns.challenge.flight import FlightSimulator, TICK
from campaigns.challenge.sensors import SensorSet
from campaigns.challenge.truth import Six, VehicleTruth
from lta_discovery.lab_tests.design import LabTest
from lta_discovery.lab_tests.plan import plan_lab_tests
from lta_discovery.lab_tests.reading import read_lab_tests
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

EXPONENT, REVERSE = 2.0, 0.6
FULL: Six = (
    0.05,
    1.0,
    0.08,
    1.0,
    1.0,
    0.005,
)  # commands at which they push as they should [N, N m]
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


class StepPilot:
    """A pilot who commands a step after a second."""

    def __init__(self, test: LabTest) -> None:
        self.test = test

    def initial_duties(self) -> list[float]:
        """Return no command."""
        return [0.0] * 6

    def compute_duties(self, time: float, state: list[float]) -> list[float]:
        """Return the command at a time."""
        own = self.test.size * (time >= 1.0)
        return [own if axis == self.test.axis else 0.0 for axis in AXES]


def load_example() -> ModuleType:
    """Return the script of the tutorial."""
    path = Path(__file__).resolve().parents[4] / 'examples/blimp_afternoon.py'
    spec = importlib.util.spec_from_file_location('blimp_afternoon', path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write_log(path: Path, blimp: VehicleTruth, test: LabTest, draw: np.random.Generator) -> None:
    """Fly a test, and write its file as a tracker does."""
    tilt = [math.cos(0.5 * test.tilt), 0.0, 0.0, 0.0]
    tilt[1 + (test.axis == 'pitch')] = math.sin(0.5 * test.tilt)
    begin = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, *tilt, 0.0, 0.0, test.rate]
    flight = FlightSimulator(blimp, StepPilot(test), actuators=SquareActuators)
    trajectory = flight.simulate_flight(begin, test.seconds)
    time, poses = SensorSet(trajectory, blimp, 'millisecond', draw).measure_poses()
    newest = np.clip((time / TICK + 1e-6).astype(int), 0, len(trajectory.commands) - 1)
    table = np.column_stack([
        1e3 * time + 5000.0, 1e3 * poses[:, :3], poses[:, 3:], trajectory.commands[newest]
    ])  # fmt: skip
    np.savetxt(path, table, fmt=['%.0f', *['%.2f'] * 3, *['%.6f'] * 4, *['%.5f'] * 6],
               delimiter=',', header=HEAD, comments='')  # fmt: skip


@pytest.mark.long
def test_the_planned_steps_show_exponent_and_reverse(tmp_path: Path) -> None:
    vehicle = load_vehicle('gtmab')
    # A vehicle file that is off, as in the tutorial
    blimp = load_example().draw_blimp(np.random.default_rng([3, 37]))
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
