# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The lamp on the ray: mean and covariance by hand."""

import math

from lta_vlc.lamp import Direction, estimate_lamp_position, estimate_range, LampPrior
import numpy as np
import pytest

PRIOR = LampPrior(distance=4.0, distance_deviation=3.0)


def direction(azimuth, elevation, covariance, strength=100.0, deviation=0.0):
    level = math.cos(elevation)
    (a, b), (_, c) = covariance
    ray = level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)
    return Direction(*ray, a, b, c, strength, deviation, 0.0)


def matrix(lamp):
    """Return the covariance of a lamp as a matrix."""
    return np.array(
        [[lamp.xx, lamp.xy, lamp.xz], [lamp.xy, lamp.yy, lamp.yz], [lamp.xz, lamp.yz, lamp.zz]]
    )


@pytest.mark.parametrize(
    ('azimuth', 'place', 'variances'),
    [
        (0.0, [4.0, 0.0, 0.0], [9.0, 0.0625, 0.25]),
        (math.pi / 2, [0.0, 4.0, 0.0], [0.0625, 9.0, 0.25]),
    ],
    ids=['ahead', 'left'],
)
def test_ahead_and_to_the_left_by_hand(azimuth, place, variances):
    """Along: 3^2. Across: (4^2 + 3^2) 0.05^2. Up: 25 x 0.1^2."""
    lamp = estimate_lamp_position(direction(azimuth, 0.0, [[0.05**2, 0.0], [0.0, 0.1**2]]), PRIOR)
    assert lamp[:3] == pytest.approx(place, abs=1e-12)
    assert matrix(lamp) == pytest.approx(np.diag(variances), abs=1e-12)


@pytest.mark.parametrize(('azimuth', 'elevation'), [(-2.5, 0.0), (0.4, 0.6), (1.1, -0.9)])
def test_covariance_is_that_of_drawn_lamps(azimuth, elevation):
    generator = np.random.default_rng(31)
    given = np.array([[0.03**2, 0.0004], [0.0004, 0.04**2]])
    drawn = generator.multivariate_normal([azimuth, elevation], given, 200_000)
    distance = 4.0 + 3.0 * generator.standard_normal(200_000)
    level = np.cos(drawn[:, 1])
    rays = np.stack(
        [level * np.cos(drawn[:, 0]), level * np.sin(drawn[:, 0]), np.sin(drawn[:, 1])]
    )
    found = np.cov(distance * rays)
    stated = matrix(estimate_lamp_position(direction(azimuth, elevation, given), PRIOR))
    # 200 000 draws know a variance of 9 to 0.03; the bend adds 25 x 0.04^2 at most.
    assert found == pytest.approx(stated, abs=0.1)
    ray = np.array(estimate_lamp_position(direction(azimuth, elevation, given), PRIOR)[:3]) / 4.0
    left = np.array([-ray[1], ray[0], 0.0]) / math.hypot(ray[0], ray[1])
    up = np.cross(ray, left)
    for a, b in ((left, left), (up, up), (left, up)):
        assert a @ found @ b == pytest.approx(a @ stated @ b, rel=0.03)


def test_the_range_follows_from_the_strength_where_the_lamp_was_measured():
    prior = LampPrior(intensity=500.0)
    # 500 x 0.8 / 100 = 2^2; 5 % of strength are 2.5 % of range, beside 15 % by the beam.
    distance, deviation = estimate_range(direction(0.0, 0.0, np.eye(2), 100.0, 5.0), prior)
    assert distance == pytest.approx(2.0)
    assert deviation == pytest.approx(2.0 * math.hypot(0.15, 0.025))
    assert estimate_range(direction(0.0, 0.0, np.eye(2)), PRIOR) == (4.0, 3.0)
