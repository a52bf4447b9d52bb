"""The smoother against the joint normal distribution of a small flight, as one dense matrix."""

from dataclasses import replace

from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.smoothing import smooth_flight
import numpy as np
import pytest
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
