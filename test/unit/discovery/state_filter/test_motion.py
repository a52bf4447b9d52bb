# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The measured motion, and the noise of its readings."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import (
    FlightStreams,
    GRID_PERIOD,
    MeasuredFlight,
    resample_flight,
    Stream,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
from lta_discovery.state_filter.kalman import filter_flight
from lta_discovery.state_filter.likelihood import ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.motion import collect_readings, find_runs, fit_motion
from lta_discovery.state_filter.noise_fit import learn_noise
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
from lta_discovery.state_filter.smoothing import smooth_flight
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

from .. import hidden_flight  # noqa: TID252 - `test` is Python's own
from ..hidden_flight import flown  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]

COUNT = 100  # grid points
RADIUS, TURN = 1.5, 0.4  # m, rad/s


def build_flight(time: Array, position: Array, quaternion: Array) -> MeasuredFlight:
    """Return a flight with nothing but poses."""
    noise = np.concatenate([np.full(6, 1e-3), np.full(8, np.inf)])
    commands = Stream(time, np.zeros((len(time), 4)))
    return MeasuredFlight(
        time, position, quaternion, np.full((len(time), 8), np.nan), noise,
        np.ones(len(time), dtype=np.bool_), commands, np.full(len(time), np.nan),
    )  # fmt: skip


def fly_circle(time: Array) -> tuple[Array, Array]:
    """Return poses on a circle with the nose ahead."""
    angle = TURN * time
    position = np.column_stack([RADIUS * np.sin(angle), -RADIUS * np.cos(angle), 1.0 + 0.0 * time])
    return position, Rotation.from_euler('z', angle[:, None]).as_quat()


def circling(time: Array) -> MeasuredFlight:
    """Return a flight round a circle on the grid, read at some times."""
    grid = 5.0 + GRID_PERIOD * np.arange(COUNT)
    flight = build_flight(grid, *fly_circle(grid))
    return replace(flight, poses=Stream(time, np.column_stack(fly_circle(time))))


@pytest.mark.parametrize('with_future', [True, False])
def test_motion_on_a_parabola_is_exact(with_future: bool) -> None:
    """x = 1 + 2 t - 0.3 t^2, at constant heading; the velocity is that in the axes of the body."""
    time = GRID_PERIOD * np.arange(COUNT)
    turn = Rotation.from_euler('z', 0.5 * np.pi)
    position = np.column_stack([1.0 + 2.0 * time - 0.3 * time**2, 0.0 * time, 0.5 * time])
    flight = build_flight(time, position, np.tile(turn.as_quat(), (COUNT, 1)))
    motion = fit_motion(flight, with_future)
    known = np.isfinite(motion).all(axis=1)
    # 0.6 of the window has to be known: a quarter of a second on each side, or half before
    lost = [0, COUNT - 1] if with_future else [*range(7)]
    assert np.flatnonzero(~known).tolist() == lost
    np.testing.assert_allclose(motion[known, :3], position[known], atol=1e-9)
    # The nose points along y
    np.testing.assert_allclose(motion[known, 8], -(2.0 - 0.6 * time[known]), atol=1e-8)
    np.testing.assert_allclose(motion[known, 7], 0.0, atol=1e-8)
    np.testing.assert_allclose(motion[known, 9], 0.5, atol=1e-8)
    np.testing.assert_allclose(motion[known, 10:], 0.0, atol=1e-9)


@pytest.mark.parametrize(('with_future', 'error'), [(True, 1e-4), (False, 0.02)])
def test_motion_on_a_circle(with_future: bool, error: float) -> None:
    """Speed along the nose, and yaw rate; a parabola through the past is off by a few percent."""
    time = 5.0 + GRID_PERIOD * np.arange(COUNT)
    motion = fit_motion(circling(time), with_future)[15:-15]
    np.testing.assert_allclose(motion[:, 7], RADIUS * TURN, atol=error)
    np.testing.assert_allclose(motion[:, 8:12], 0.0, atol=error)
    np.testing.assert_allclose(motion[:, 12], TURN, atol=1e-9)
    np.testing.assert_allclose(motion[:, :3], fly_circle(time)[0][15:-15], atol=0.1 * error)


def test_motion_without_the_future_uses_no_later_pose() -> None:
    flight = circling(5.0 + GRID_PERIOD * np.arange(COUNT))
    at = 60
    position, quaternion = flight.position.copy(), flight.quaternion.copy()
    position[at + 1 :] += 3.0
    quaternion[at + 1 :] = Rotation.from_euler('y', 1.0).as_quat()
    other = replace(flight, position=position, quaternion=quaternion)
    first, second = (fit_motion(one, with_future=False) for one in (flight, other))
    np.testing.assert_array_equal(first[: at + 1], second[: at + 1])
    assert np.abs(first[at + 1, :3] - second[at + 1, :3]).max() > 0.5
    assert not np.array_equal(fit_motion(flight)[at], fit_motion(other)[at])


def test_runs_end_where_poses_are_lost_and_last_a_second() -> None:
    flight = circling(5.0 + GRID_PERIOD * np.arange(COUNT))
    position = flight.position.copy()
    position[30:60] = np.nan
    position[62:75] = np.nan
    # 8 of the 13 poses around a point have to be known: from 77 on that is so for 22 points only
    assert find_runs(flight, fit_motion(replace(flight, position=position))) == [(1, 29)]


def test_poses_of_any_rate_are_moved_to_the_grid() -> None:
    """At 20 Hz, every fifth grid period has none; poses count where they are the nearest."""
    time = 5.003 + 0.05 * np.arange(70)
    flight = circling(time)
    motion = fit_motion(flight)
    readings, count = collect_readings(flight, motion)
    inside = slice(5, 80)
    assert set(count[inside]) == {0.0, 1.0}
    assert count[inside].sum() == 60.0
    read = count > 0.0
    assert np.isnan(readings[~read]).all()
    place, turn = fly_circle(flight.time)
    # Straight on over 20 ms at most, of an acceleration of 0.24 m/s2
    np.testing.assert_allclose(readings[read, :3], place[read], atol=6e-5)
    off = Rotation.from_quat(readings[read, 3:]).inv() * Rotation.from_quat(turn[read])
    assert off.magnitude().max() < 1e-7


def test_repeated_poses_are_no_readings() -> None:
    """A recorder at 50 Hz repeats each pose of a tracker at 25 Hz."""
    time = 5.0 + 0.02 * np.arange(2 * COUNT)
    flight = circling(time)
    assert flight.poses is not None
    values = np.repeat(flight.poses.values[::2], 2, axis=0)
    flight = replace(flight, poses=Stream(time, values))
    readings, count = collect_readings(flight, fit_motion(flight))
    inside = slice(5, -5)
    assert set(count[inside]) == {1.0}
    np.testing.assert_allclose(readings[inside, :3], fly_circle(flight.time)[0][inside], atol=1e-6)


def test_four_poses_of_a_period_are_averaged() -> None:
    """Their noise is that of the mean: half of it."""
    rng = np.random.default_rng(8)
    time = 4.985 + 0.01 * np.arange(4 * COUNT)
    flight = circling(time)
    assert flight.poses is not None
    values = flight.poses.values.copy()
    values[:, :3] += 1e-3 * rng.standard_normal((len(values), 3))
    wobble = Rotation.from_rotvec(2e-3 * rng.standard_normal((len(values), 3)))
    values[:, 3:] = (Rotation.from_quat(values[:, 3:]) * wobble).as_quat()
    flight = replace(flight, poses=Stream(time, values))
    readings, count = collect_readings(flight, fit_motion(flight))
    inside = slice(5, -5)
    assert set(count[inside]) == {4.0}
    place, turn = fly_circle(flight.time)
    assert np.std((readings[:, :3] - place)[inside]) == pytest.approx(0.5e-3, rel=0.15)
    off = Rotation.from_quat(turn[inside]).inv() * Rotation.from_quat(readings[inside, 3:])
    assert np.std(off.as_rotvec()) == pytest.approx(1e-3, rel=0.15)


def test_lost_and_outlying_poses_are_no_readings() -> None:
    """Those of a part in which the grid has no pose, too."""
    flight = circling(5.0 + GRID_PERIOD * np.arange(COUNT))
    assert flight.poses is not None
    values = flight.poses.values.copy()
    values[40] = np.nan
    position = flight.position.copy()
    position[50:53] = np.nan
    flight = replace(flight, position=position, poses=Stream(flight.poses.time, values))
    readings, count = collect_readings(flight, fit_motion(flight))
    lost = [40, 50, 51, 52]
    assert np.array_equal(np.flatnonzero(count[5:-5] == 0.0) + 5, lost)
    assert np.isnan(readings[lost]).all()


SMOOTHED = 3  # times; each leaves the square of what the one before left out


def test_a_turn_of_the_tracker_about_the_vertical_cannot_be_seen() -> None:
    """
    Nothing in a still hall knows north, so all headings of the tracker's frame fit as well.

    About noisy poses the same column seems to be known to some hundredths of a radian.
    """
    vehicle, flight = load_vehicle('gtmab'), resample_flight(flown({}, 1, 24.0))
    nominal = NominalVehicle.from_vehicle(vehicle)
    parameters = list_free_parameters(nominal)
    yaw = [one.name for one in parameters].index('tracker_misalignment.yaw')
    system, noise = FlightSystem(vehicle, flight, parameters), NoiseModel.guess(nominal, flight)
    none, information = np.zeros(len(parameters)), list[float]()
    for _ in range(SMOOTHED + 1):
        linear = system.linearize(nominal, none)
        information.append(float(filter_flight(linear, noise).products[yaw, yaw]))
        smooth = smooth_flight(linear, noise, none)
        system = system.with_motion(smooth.motion, smooth.wrench, nominal)
    assert information[0] > 10.0
    assert information[-1] < 1e-3


WHITE = np.array([2e-3] * 3 + [5e-3] * 3)  # m, rad
SLOW = np.array([3e-3] * 3 + [6e-3] * 3)  # m, rad
MEMORY = 0.3  # s
RATE = 100  # Hz; of the recording

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='module')
def exact() -> FlightStreams:
    """A minute's flight of which nothing but exact poses is known."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hidden_flight, 'POSE_NOISE', 0.0)
        patch.setattr(hidden_flight, 'TURN_NOISE', 0.0)
        streams = hidden_flight.flown({}, 31, 62.0)
    return replace(streams, others={'voltage': streams.others['voltage']})


def observe(streams: FlightStreams, rate: int, white: Array, slow: Array) -> FlightStreams:
    """Return what a tracker of a rate reads, with white errors and slow ones."""
    rng = np.random.default_rng(rate)
    time = streams.pose.time
    kept = np.exp(-np.diff(time, prepend=time[0] - 1.0 / RATE) / MEMORY)
    wander = np.zeros((len(time), 6))
    wander[0] = slow * rng.standard_normal(6)
    for k in range(1, len(time)):
        fresh = np.sqrt(1.0 - kept[k] ** 2) * slow * rng.standard_normal(6)
        wander[k] = kept[k] * wander[k - 1] + fresh
    error = wander + white * rng.standard_normal((len(time), 6))
    values = streams.pose.values.copy()
    values[:, :3] += error[:, :3]
    values[:, 3:] = quaternion_product(values[:, 3:], quaternion_exponential(error[:, 3:]))
    every = RATE // rate
    return replace(streams, pose=Stream(time[::every], values[::every]))


@pytest.mark.parametrize('rate', [10, 25, 100])
def test_white_and_slow_errors_of_a_tracker_are_told_apart(
    exact: FlightStreams, gtmab: Known, rate: int
) -> None:
    nominal, every = gtmab
    parameters = [one for one in every if one.name in ('net_lift.force', 'thrust_scale.factor')]
    flight = resample_flight(observe(exact, rate, WHITE, SLOW))
    system = FlightSystem(load_vehicle('gtmab'), flight, parameters)
    values = np.zeros(len(parameters))
    linear = system.linearize(nominal, values)
    begin = [NoiseModel.guess(nominal, flight)]
    (found,) = learn_noise([linear], ParameterPrior.of(parameters), values, begin)
    np.testing.assert_allclose(found.white, WHITE, rtol=0.2)
    np.testing.assert_allclose(found.correlated, SLOW, rtol=0.2)
    assert found.correlation == pytest.approx(MEMORY, rel=0.3)


def test_the_mean_of_noise_models_is_geometric(gtmab: Known) -> None:
    one = NoiseModel(
        np.full(6, 1e-3), np.full(6, 4e-3), 0.2, np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        np.array([2.0] * 3 + [8.0] * 3),
    )  # fmt: skip
    other = replace(one, white=np.full(6, 4e-3), correlation=0.8, wrench=4.0 * one.wrench)
    both = average_noise([one, other])
    np.testing.assert_allclose(both.white, 2e-3)
    np.testing.assert_allclose(both.correlated, 4e-3)
    assert both.correlation == pytest.approx(0.4)
    np.testing.assert_allclose(both.wrench, 2.0 * one.wrench)
    np.testing.assert_allclose(both.memory, one.memory)
    np.testing.assert_allclose(one.with_logarithms(one.logarithms).wrench, one.wrench)
