# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The independent simulator's sensors read what hand calculations say, stamped as labs do."""

from dataclasses import replace
import math

from campaigns.challenge.effect_injection import HIDINGS, inject_effects
from campaigns.challenge.flight import SimulatedTrajectory, TICK
from campaigns.challenge.sensors import SensorSet, STAMPS, Stamps
from campaigns.challenge.truth import build_vehicle_truth, VehicleTruth
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

G = 9.80665


@pytest.fixture(scope='module')
def truth() -> VehicleTruth:
    """Return the vehicle as its file has it."""
    return build_vehicle_truth(load_vehicle('gtmab'))


def path(speed: float = 0.0, pitch: float = 0.0, rate: float = 0.0) -> SimulatedTrajectory:
    """Return a level flight along x at a pitch, from (0, 0, 2) on; `rate` about z."""
    time = TICK * np.arange(-1, 4000)
    states, gains = np.zeros((len(time), 13)), np.zeros((len(time), 6))
    states[:, 0], states[:, 2], states[:, 3], states[:, 12] = speed * time, 2.0, speed, rate
    half = 0.5 * rate * time
    states[:, 6:10] = np.column_stack([
        np.cos(half) * math.cos(0.5 * pitch), -np.sin(half) * math.sin(0.5 * pitch),
        np.cos(half) * math.sin(0.5 * pitch), np.sin(half) * math.cos(0.5 * pitch),
    ])  # fmt: skip
    commands, thrusts = np.zeros((4000, 4)), np.zeros((len(time), 4))
    return SimulatedTrajectory(time, states, gains, commands, thrusts, np.zeros((len(time), 6)))


def sensors(
    truth: VehicleTruth, flown: SimulatedTrajectory, stamps: Stamps = 'exact'
) -> SensorSet:
    """Return the sensors, of the same chance always."""
    return SensorSet(flown, truth, stamps, np.random.default_rng(4))


def test_readings_of_a_hull_that_hangs_askew(truth: VehicleTruth) -> None:
    pitch = 0.2  # nose down: x of the body points down
    seen = sensors(truth, path(pitch=pitch))
    assert np.mean(seen.measure_imu()[1], axis=0) == pytest.approx(
        [0, 0, 0, -G * math.sin(pitch), 0, G * math.cos(pitch)], abs=1e-3
    )
    # Along the body's downward axis from 0.37 m below the hull centre.
    assert np.mean(seen.measure_ranges()[1]) == pytest.approx(
        2.0 / math.cos(pitch) - 0.37, abs=5e-4
    )
    time, poses = seen.measure_poses()
    assert np.diff(time) == pytest.approx(np.full(len(time) - 1, 0.01), rel=6e-3)
    half = 0.5 * pitch
    assert np.mean(poses, axis=0) == pytest.approx(
        [0, 0, 2, 0, math.sin(half), 0, math.cos(half)], abs=2e-4
    )
    assert np.std(poses[:, :3], axis=0) == pytest.approx(np.full(3, 1e-3), rel=0.05)
    # Twice the noise of half the angle: 2.5 mrad about each axis.
    assert 2.0 * np.std(poses[:, 3]) == pytest.approx(2.5e-3 * math.cos(half), rel=0.05)


def test_air_weighs_on_the_barometer(truth: VehicleTruth) -> None:
    low, high = path(), path()
    high.states[:, 2] += 1.0
    one, two = (np.mean(sensors(truth, each).measure_pressures()[1]) for each in (low, high))
    assert one - two == pytest.approx(1.2041 * G, rel=0.01)


def test_a_turning_imu_feels_the_pull_outward(truth: VehicleTruth) -> None:
    off = replace(truth, imu_place=(0.3, 0.0, 0.0))
    seen = np.mean(sensors(off, path(rate=2.0)).measure_imu()[1], axis=0)
    assert seen == pytest.approx([0, 0, 2.0, -0.3 * 2.0**2, 0, G], abs=2e-3)


def test_a_turned_tracker_sees_the_map_turned_back(truth: VehicleTruth) -> None:
    quarter = inject_effects(truth, {'tracker_misalignment.yaw': 0.5 * math.pi})
    _, poses = sensors(quarter, path(speed=1.0)).measure_poses()
    # Its x lies along y of the map, so that a flight along x goes along its -y.
    assert poses[-1, :3] == pytest.approx([0.0, -39.9, 2.0], abs=0.15)
    assert np.mean(poses[:, 5:], axis=0) == pytest.approx(
        [-math.sqrt(0.5), math.sqrt(0.5)], abs=1e-3
    )
    late = inject_effects(truth, {'tracker_delay.delay': 0.05})
    time, poses = sensors(late, path(speed=1.0)).measure_poses()
    assert np.mean(time - poses[:, 0]) == pytest.approx(0.05, abs=1e-4)


@pytest.mark.parametrize('stamps', STAMPS)
def test_stamps_are_off_as_they_say(truth: VehicleTruth, stamps: Stamps) -> None:
    seen = sensors(truth, path(speed=1e3), stamps)  # a micrometre takes a nanosecond
    time, poses = seen.measure_poses()
    off = time - poses[:, 0] / 1e3
    grids = {'millisecond': 1e-3, 'grid': 2e-3}
    if grid := grids.get(stamps):
        assert time / grid == pytest.approx(np.round(time / grid), abs=1e-6)
        assert np.max(np.abs(off)) < 0.5 * grid + 1e-5
    # What is rounded is off by the grid over the root of 12; `exact` by the noise of 1 mm.
    size = {'exact': 1e-6, 'millisecond': 2.9e-4, 'grid': 5.8e-4, 'jitter': 3e-4}[stamps]
    assert np.std(off) == pytest.approx(size, rel=0.1)
    imu = seen.measure_imu()[0]
    assert stamps != 'grid' or np.max(np.abs(imu / 2e-3 - np.round(imu / 2e-3))) > 0.01


@pytest.mark.parametrize('knob', [
    knob for knob, hiding in HIDINGS.items()
    if hiding.field in ('imu_bias', 'gyro_bias', 'range_offset')
])  # fmt: skip
def test_biases_are_added_to_their_own_axis(truth: VehicleTruth, knob: str) -> None:
    effect, _, axis = knob.partition('.')
    flown = path(pitch=0.1)
    biased, fair = (sensors(each, flown) for each in (inject_effects(truth, {knob: 0.05}), truth))
    if effect == 'range_offset':
        assert biased.measure_ranges()[1] - fair.measure_ranges()[1] == pytest.approx(0.05)
        return
    more = np.mean(biased.measure_imu()[1] - fair.measure_imu()[1], axis=0)
    column = 'xyz'.index(axis) + (3 if effect == 'imu_bias' else 0)
    assert more == pytest.approx(0.05 * np.eye(6)[column], abs=1e-12)
