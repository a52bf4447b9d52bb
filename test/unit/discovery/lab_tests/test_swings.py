# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Damping from swings alone, by the public command, with swings of the independent simulator."""

from collections.abc import Callable
from dataclasses import replace
import math
from pathlib import Path
from typing import Any

from campaigns.challenge.flight import FlightSimulator, SimulatedTrajectory, TICK
from campaigns.challenge.recording import write_bag
from campaigns.challenge.sensors import SensorSet
from campaigns.challenge.truth import build_vehicle_truth, to_triple, VehicleTruth
from campaigns.challenge.wrench_flight import WrenchActuators
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.signal import find_peaks

from ..step_pilot import StepPilot  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]
GRAVITY = 9.80665  # m/s2; of the simulator
RELEASES = (0.4, 0.2, 0.08)  # rad; each log covers a part of the amplitudes
# Linear and quadratic damping and inertia, by the vehicle file; rotation of the markers [rad]
CASES = {
    'weak linear': (0.6, 1.4, 0.9, 0.15),
    'strong linear': (1.67, 0.6, 1.06, 0.0),
    'all of it': (1.4, 1.4, 0.6, 0.15),
}


def hang(truth: VehicleTruth) -> VehicleTruth:
    """Return a vehicle that ballast carries."""
    return replace(truth, lift=GRAVITY * (truth.mass - truth.displaced))


def swing(truth: VehicleTruth, angle: float, seconds: float) -> SimulatedTrajectory:
    """Return a release from a pitch angle."""
    half = 0.5 * angle
    begin = [0.0, 0.0, 3.0, 0.0, 0.0, 0.0, math.cos(half), 0.0, math.sin(half), 0.0, 0.0, 0.0, 0.0]
    return FlightSimulator(truth, StepPilot(), actuators=WrenchActuators).simulate_flight(
        begin, seconds
    )


def period_and_decay(truth: VehicleTruth, angle: float) -> tuple[float, float]:
    """Return the period of a release [s], and its logarithmic decrement from peak to peak."""
    path = swing(truth, angle, 10.0)
    pitch = 2.0 * np.arctan2(path.states[:, 8], path.states[:, 6])
    tops, bottoms = find_peaks(pitch)[0], find_peaks(-pitch)[0]
    count = min(len(tops), len(bottoms))
    heights = pitch[tops[:count]] - pitch[bottoms[:count]]
    decay = math.log(heights[0] / heights[-1]) / (count - 1)
    return float(np.diff(path.time[tops]).mean()), decay


def record_swings(folder: Path, truth: VehicleTruth) -> None:
    """Write a bag of each release."""
    for number, angle in enumerate(RELEASES):
        draw = np.random.default_rng([7, number])
        # Ballast is right to some millinewtons
        own = replace(truth, lift=truth.lift + float(draw.uniform(-0.005, 0.005)))
        path = swing(own, angle, 20.0)
        streams = {
            'ground_truth/odom': SensorSet(path, own, 'exact', draw).measure_poses(),
            'wrench_command': (TICK * np.arange(len(path.commands), dtype=float), path.commands),
        }
        write_bag(folder / f'log_{number}', streams, load_vehicle('gtmab').rotor_names, {})


def read_vehicle(path: str) -> VehicleTruth:
    """Return the vehicle of a file for the simulator, hanging straight."""
    vehicle = load_vehicle(path)
    truth, effects = build_vehicle_truth(vehicle), vehicle.collect_effects()
    return hang(
        replace(
            truth,
            cg=(0.0, 0.0, truth.cg[2] + effects.get('cg_height', {}).get('z', 0.0)),
            added_mass=to_triple(vehicle.added_mass[:3]),
            added_inertia=to_triple(vehicle.added_mass[3:]),
        )
    )


@pytest.mark.parametrize(
    'case',
    [
        'weak linear',
        pytest.param('strong linear', marks=pytest.mark.long),
        pytest.param('all of it', marks=pytest.mark.long),
    ],
)
def test_swings_alone_separate_linear_from_quadratic_damping(
    case: str, tmp_path: Path, call: Callable[..., tuple[int, Any]]
) -> None:
    linear, square, inertia, turn = CASES[case]
    file = build_vehicle_truth(load_vehicle('gtmab'))
    truth = hang(
        replace(
            file,
            inertia=to_triple(inertia * each for each in file.inertia),
            turn_linear=to_triple(linear * each for each in file.turn_linear),
            turn_square=to_triple(square * each for each in file.turn_square),
            marker_turn=(0.5 * turn, turn, -0.5 * turn),
            marker_arm=(0.04, -0.02, 0.03) if turn else (0.0, 0.0, 0.0),
        )
    )
    record_swings(tmp_path / 'logs', truth)
    out = tmp_path / 'read'
    status, said = call(
        'tests', 'read', tmp_path / 'logs', '--vehicle', 'gtmab', '--no-page', '--out', out
    )
    assert status == 0, said.err
    assert said.out.count('pitch swings by') == 3
    assert 'No swing in roll' in said.out
    found = read_vehicle(str(out / 'calibrated.yaml'))
    for angle in (0.05, 0.1, 0.2, 0.4):
        period, decay = period_and_decay(truth, angle)
        now = period_and_decay(found, angle)
        assert now[0] == pytest.approx(period, rel=0.02), angle
        assert now[1] == pytest.approx(decay, rel=0.1), angle
