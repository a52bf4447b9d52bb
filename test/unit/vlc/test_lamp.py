"""The lamp on the ray: mean and covariance by hand."""

import math

from lta_vlc.array import Bearing
from lta_vlc.lamp import bearing_through, lamp_estimate, LampPrior
import numpy as np
import pytest

PRIOR = LampPrior(
    distance=4.0, distance_deviation=3.0, height_deviation=0.5, bearing_deviation=0.04
)


def test_straight_ahead_by_hand():
    estimate = lamp_estimate(Bearing(0.5, 0.0, 0.0, 0.03), PRIOR)
    assert estimate.position == pytest.approx([4.0, 0.0, 0.0])
    # Along: 3^2. Across: (4^2 + 3^2)(0.03^2 + 0.04^2) = 25 x 0.0025. Up: 0.5^2.
    assert estimate.covariance == pytest.approx(np.diag([9.0, 0.0625, 0.25]), abs=1e-12)


def test_to_the_left_by_hand():
    estimate = lamp_estimate(Bearing(0.0, 0.5, math.pi / 2.0, 0.03), PRIOR)
    assert estimate.position == pytest.approx([0.0, 4.0, 0.0], abs=1e-12)
    assert estimate.covariance == pytest.approx(np.diag([0.0625, 9.0, 0.25]), abs=1e-12)


@pytest.mark.parametrize('angle', [-2.5, 0.4, 1.1])
def test_largest_uncertainty_lies_along_the_ray(angle):
    covariance = lamp_estimate(Bearing(1.0, 0.0, angle, 0.03), PRIOR).covariance
    values, vectors = np.linalg.eigh(covariance)
    assert values == pytest.approx([0.0625, 0.25, 9.0], rel=1e-9)
    ray = np.array([math.cos(angle), math.sin(angle), 0.0])
    assert abs(vectors[:, 2] @ ray) == pytest.approx(1.0, abs=1e-12)


def test_covariance_is_that_of_drawn_lamps():
    generator = np.random.default_rng(31)
    angle = 0.7 + math.hypot(0.03, 0.04) * generator.standard_normal(200_000)
    distance = 4.0 + 3.0 * generator.standard_normal(200_000)
    drawn = np.cov(np.stack([distance * np.cos(angle), distance * np.sin(angle)]))
    stated = lamp_estimate(Bearing(1.0, 0.0, 0.7, 0.03), PRIOR).covariance[:2, :2]
    # 200 000 draws know a variance of 9 to 0.03; the bend adds 25 x 0.0025 at most.
    assert drawn == pytest.approx(stated, abs=0.1)
    across = np.array([-math.sin(0.7), math.cos(0.7)])
    assert across @ drawn @ across == pytest.approx(0.0625, rel=0.02)


def test_a_loop_without_messages_rounds_a_bearing_as_the_message_does():
    """To the last bit: the angle of the point that the message carries."""
    prior = LampPrior()
    for angle in np.random.default_rng(5).uniform(-math.pi, math.pi, 300).tolist():
        x, y, _ = lamp_estimate(Bearing(0.0, 0.0, angle, 0.1), prior).position.tolist()
        assert bearing_through(angle, prior) == math.atan2(y, x)
