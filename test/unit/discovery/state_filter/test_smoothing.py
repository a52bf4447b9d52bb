# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The smoother against the joint normal distribution of a small flight, as one dense matrix."""

from dataclasses import replace

from lta_discovery.state_filter.kalman import filter_flight
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.smoothing import filter_run, go_back, log_slopes, smooth_flight
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import approx_fprime
from scipy.spatial.transform import Rotation

from .dense_gaussian import ALL_SENSORS, BODY, build_dense, build_flight, COUNT, NOISE, RUN

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
