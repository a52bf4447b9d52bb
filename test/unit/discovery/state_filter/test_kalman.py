# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The filter, its smoother and its likelihood against joint normal distributions."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.replay.state_changes import STATE_WIDTH
from lta_discovery.state_filter.forecasts import predict_deviations
from lta_discovery.state_filter.kalman import filter_flight, FilteredFlight
from lta_discovery.state_filter.likelihood import build_moments_root, list_pulls, ParameterPrior
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.smoothing import filter_run, go_back, log_slopes, smooth_flight
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import approx_fprime
from scipy.spatial.transform import Rotation
from scipy.stats import multivariate_normal

from .dense_gaussian import (
    ALL_SENSORS,
    BODY,
    build_dense,
    build_flight,
    COUNT,
    NOISE,
    PARAMETERS,
    RUN,
)

STARTS = np.array([3, 5, 8])
HORIZONS = (GRID_PERIOD, 3.0 * GRID_PERIOD)


@pytest.mark.parametrize(('channels', 'noise'), [(6, NOISE), (14, ALL_SENSORS)])
@pytest.mark.parametrize('parameters', [(0.0, 0.0, 0.0), (0.7, -1.2, 0.4)])
def test_the_likelihood_is_that_of_the_joint_distribution(
    channels: int, noise: NoiseModel, parameters: tuple[float, ...]
) -> None:
    flight = build_flight(1, channels)
    dense = build_dense(flight, noise)
    told = filter_flight(flight, noise)
    columns = np.append(parameters, 1.0)
    found = -0.5 * (told.log_determinant + columns @ told.products @ columns)
    found -= 0.5 * len(dense.values) * np.log(2.0 * np.pi)
    mean = dense.design @ np.array(parameters)
    wanted = multivariate_normal(mean, dense.covariance).logpdf(dense.values)
    assert found == pytest.approx(wanted, rel=1e-9)


def test_the_most_likely_parameters_are_those_of_generalized_least_squares() -> None:
    flight = build_flight(3)
    dense = build_dense(flight, NOISE)
    products = filter_flight(flight, NOISE).products
    weight = np.linalg.inv(dense.covariance)
    precision = dense.design.T @ weight @ dense.design
    np.testing.assert_allclose(products[:-1, :-1], precision, rtol=1e-7)
    np.testing.assert_allclose(
        -np.linalg.solve(products[:-1, :-1], products[:-1, -1]),
        np.linalg.solve(precision, dense.design.T @ weight @ dense.values),
        rtol=1e-7,
    )


def test_the_state_at_a_start_is_the_mean_given_the_readings_so_far() -> None:
    """Wrench and slow error of the tracker, too, for any parameters."""
    flight, parameters = build_flight(4), np.array([0.5, -0.3, 0.8])
    dense = build_dense(flight, NOISE)
    told = filter_flight(flight, NOISE, STARTS)
    columns = np.append(parameters, 1.0)
    for s, start in enumerate(STARTS):
        at = start - RUN[0]
        wanted = dense.condition(at, at + 1, parameters)
        np.testing.assert_allclose(told.states[s] @ columns, wanted, rtol=1e-7, atol=1e-9)
        some = dense.select(at + 1)
        left = (dense.values - dense.design @ parameters)[some]
        known = left @ np.linalg.solve(dense.covariance[np.ix_(some, some)], left)
        assert columns @ told.sums[s] @ columns == pytest.approx(known, rel=1e-8)


def test_forecasts_are_the_means_given_the_readings_up_to_their_start() -> None:
    """Without what is left of the tracker's slow error, which no forecast has to meet."""
    flight, parameters = build_flight(5), np.array([-0.4, 0.6, 0.2])
    dense = build_dense(flight, NOISE)
    errors = filter_flight(flight, NOISE, STARTS, HORIZONS).errors @ np.append(parameters, 1.0)
    for s, start in enumerate(STARTS):
        for h, horizon in enumerate(HORIZONS):
            k = start + round(horizon / GRID_PERIOD)
            state = dense.condition(k - RUN[0], start - RUN[0] + 1, parameters)[:STATE_WIDTH]
            wanted = flight.left[k] - flight.read[k] @ state - flight.read_moved[k] @ parameters
            if flight.count[k] == 0.0:
                assert np.isnan(errors[s, h]).all()
            else:
                np.testing.assert_allclose(errors[s, h], wanted, rtol=1e-7, atol=1e-10)


def test_forecasts_are_those_of_a_filter_without_later_readings() -> None:
    flight = build_flight(6)
    told = filter_flight(flight, NOISE, STARTS[1:2], HORIZONS)
    blind = flight.left.copy()
    blind[STARTS[1] + 1 :] = np.nan
    ahead = STARTS[1] + np.rint(np.array(HORIZONS) / GRID_PERIOD).astype(np.int64)
    later = filter_flight(replace(flight, left=blind), NOISE, ahead)
    for h, k in enumerate(ahead):
        wanted = -np.einsum('ms,sk->mk', flight.read[k], later.states[h, :STATE_WIDTH])
        wanted[:, :PARAMETERS] -= flight.read_moved[k]
        wanted[:, PARAMETERS] += flight.left[k]
        np.testing.assert_allclose(told.errors[0, h], wanted, rtol=1e-9, atol=1e-12)


def test_errors_of_forecasts_have_the_variance_given_the_readings_up_to_their_start() -> None:
    """Of a reading with its white noise, whatever was read after the start."""
    flight = build_flight(8)
    dense = build_dense(flight, NOISE)
    found = predict_deviations(flight, NOISE, STARTS, HORIZONS)
    for s, start in enumerate(STARTS):
        some = dense.select(start - RUN[0] + 1)
        for h, horizon in enumerate(HORIZONS):
            k = start + round(horizon / GRID_PERIOD)
            row = np.hstack([flight.read[k], flight.felt[k], np.eye(6), np.zeros((6, 1))])
            at = k - RUN[0]
            across = row @ dense.across[at][:, some]
            inner = np.linalg.inv(dense.covariance[np.ix_(some, some)])
            left = row @ dense.spread[at, :, at] @ row.T - across @ inner @ across.T
            wanted = np.diag(left) + NOISE.white**2 / max(flight.count[k], 1.0)
            np.testing.assert_allclose(found[s, h] ** 2, wanted, rtol=1e-7)


def test_two_runs_of_a_flight_are_independent_but_for_the_parameters() -> None:
    """Of the second run, the likelihood and the starts begin anew; what is known adds up."""
    flight = build_flight(7)
    begun = np.concatenate([flight.begun, 2.0 * flight.begun])
    parts = [
        replace(flight, runs=[one], begun=begun[k : k + 1])
        for k, one in enumerate(((1, 6), (7, 13)))
    ]
    first, second = (filter_flight(one, NOISE, np.array([3, 8]), HORIZONS) for one in parts)
    whole = replace(flight, runs=[(1, 6), (7, 13)], begun=begun)
    both = filter_flight(whole, NOISE, np.array([3, 8]), HORIZONS)
    np.testing.assert_allclose(both.products, first.products + second.products, rtol=1e-12)
    total = first.log_determinant + second.log_determinant
    assert both.log_determinant == pytest.approx(total, rel=1e-12)
    np.testing.assert_allclose(both.sums[1], first.products + second.sums[1], rtol=1e-12)
    np.testing.assert_array_equal(both.errors[1], second.errors[1])


VALUES = np.array([0.3, -0.5, 0.2])
WRENCH = slice(BODY, BODY + 6)


@pytest.mark.parametrize(('channels', 'noise'), [(6, NOISE), (14, ALL_SENSORS)])
def test_motion_and_wrench_are_the_means_given_all_readings(
    channels: int, noise: NoiseModel
) -> None:
    flight = build_flight(1, channels)
    level = np.array([0.0] * 6 + [1.0] + [0.0] * 6)
    smooth = smooth_flight(replace(flight, motion=np.tile(level, (COUNT, 1))), noise, VALUES)
    dense = build_dense(flight, noise)
    count = RUN[1] - RUN[0]
    for at in range(count):
        wanted = dense.condition(at, count, VALUES)
        motion = smooth.motion[RUN[0] + at]
        np.testing.assert_allclose(motion[:3], wanted[:3], rtol=1e-7, atol=1e-9)
        turn = Rotation.from_quat(motion[3:7]).as_rotvec()
        np.testing.assert_allclose(turn, wanted[3:6], rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(motion[7:], wanted[6:BODY], rtol=1e-7, atol=1e-9)
        wrench = smooth.wrench[RUN[0] + at]
        np.testing.assert_allclose(wrench, wanted[WRENCH], rtol=1e-7, atol=1e-9)
        gain = dense.across[at] @ np.linalg.inv(dense.covariance)
        left = np.diag(dense.spread[at, :, at] - gain @ dense.across[at].T)[WRENCH]
        np.testing.assert_allclose(smooth.deviation[RUN[0] + at], np.sqrt(left), rtol=1e-6)


def test_points_outside_of_the_runs_have_no_motion() -> None:
    flight = replace(build_flight(2), motion=np.tile([0.0] * 6 + [1.0] + [0.0] * 6, (COUNT, 1)))
    smooth = smooth_flight(flight, NOISE, VALUES)
    outside = np.ones(COUNT, dtype=np.bool_)
    outside[RUN[0] : RUN[1]] = False
    assert np.isnan(smooth.motion[outside]).all()
    assert np.isfinite(smooth.motion[~outside]).all()


@pytest.mark.parametrize(('channels', 'noise'), [(6, NOISE), (14, ALL_SENSORS)])
def test_slopes_by_the_noise_are_those_of_the_likelihood(channels: int, noise: NoiseModel) -> None:
    """The mean over two values of the parameters, by differences of what the filter gives."""
    flight, mix = build_flight(3, channels), np.stack([VALUES, -VALUES], axis=1)
    both = np.vstack([mix, np.ones(2)]) / np.sqrt(2.0)

    def log_density(logarithms: NDArray[np.float64]) -> float:
        one = filter_flight(flight, noise.with_logarithms(logarithms))
        squares = float(np.trace(both.T @ one.products @ both))
        return -0.5 * (one.log_determinant + squares)

    run = filter_run(flight, noise, 0, both)
    slopes = log_slopes(noise, go_back(flight, noise, 0, run)[2])
    wanted = approx_fprime(noise.logarithms, log_density, 1e-6)
    np.testing.assert_allclose(slopes, wanted, rtol=1e-4, atol=1e-4)


DEVIATIONS = np.array([0.5, 0.0, 0.8, 0.3, 2.0])
OWN = np.array([False, False, False, True, True])


def test_a_root_of_the_moments_is_that_of_shared_and_own_parameters() -> None:
    """The second parameter is held, the last two are those of the flight."""
    rng = np.random.default_rng(4)
    rows = rng.standard_normal((30, len(OWN) + 1))
    products = rows.T @ rows
    none = np.full(len(OWN), np.inf)
    prior = ParameterPrior(DEVIATIONS, -none, none, OWN)
    acting = np.flatnonzero(DEVIATIONS > 0.0)
    precision = products[np.ix_(acting, acting)] + np.diag(DEVIATIONS[acting] ** -2.0)
    covariance = np.linalg.inv(precision)
    mean = np.zeros(len(OWN))
    mean[acting] = -covariance @ products[acting, -1]
    root = np.linalg.cholesky(covariance[:2, :2])
    out = build_moments_root(products, prior, np.where(OWN, 0.0, mean), root)
    wanted = np.zeros((len(OWN) + 1, len(OWN) + 1))
    wanted[np.ix_(acting, acting)] = covariance
    wanted += np.outer(np.append(mean, 1.0), np.append(mean, 1.0))
    np.testing.assert_allclose(out @ out.T, wanted, rtol=1e-9, atol=1e-12)


def test_pulls_of_pieces_are_those_beside_what_a_flight_has_of_its_own() -> None:
    """Three pieces of whitened readings, by least squares with two unknowns of the flight."""
    rows = np.random.default_rng(6).standard_normal((30, len(OWN) + 1))
    pieces = [rows[:8], rows[8:13], rows[13:]]
    sums = np.stack([rows[:end].T @ rows[:end] for end in (8, 13)])
    none = np.zeros((0, 0, 0))
    filtered = FilteredFlight(rows.T @ rows, 0.0, none, sums, none)
    away = np.full(len(OWN), np.inf)
    pulls = list_pulls(filtered, ParameterPrior(DEVIATIONS, -away, away, OWN))
    own = np.flatnonzero(OWN)
    # The prior of an unknown is one more reading
    design = np.concatenate([rows[:, own], np.diag(1.0 / DEVIATIONS[own])])
    both = np.concatenate([rows, np.zeros((len(own), rows.shape[1]))])
    slopes = np.linalg.lstsq(design, both)[0]
    wanted = [-(one - one[:, own] @ slopes).T @ (one - one[:, own] @ slopes) for one in pieces]
    shared = np.flatnonzero(~OWN)
    for found, one in zip(pulls, wanted, strict=True):
        np.testing.assert_allclose(found[shared], one[shared, -1], rtol=1e-9)
        assert not found[own].any()
