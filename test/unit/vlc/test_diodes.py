# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Diodes of a ring and the place of a lamp that they tell."""

from dataclasses import replace
import math

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_vlc.diodes import build_diode_array, build_even_ring
from lta_vlc.lamp import (
    build_direction_prior,
    Direction,
    estimate_lamp_position,
    estimate_range,
    LampPrior,
)
import numpy as np
import pytest

ENTRY = load_vehicle_file('gtmab').sensors.diodes


def test_the_diodes_of_a_ring_face_outwards_from_its_centre():
    diodes = build_even_ring(4, 0.07, 1.2, 0.02)
    assert diodes.axes[1] == pytest.approx((0.0, 1.0, 0.0), abs=1e-15)
    assert diodes.axes[2] == pytest.approx((-1.0, 0.0, 0.0), abs=1e-15)
    assert diodes.places[3] == pytest.approx((0.0, -0.07, 0.0), abs=1e-15)
    assert (diodes.response, diodes.gains, diodes.spread) == (1.2, (1.0,) * 4, 0.02)
    assert diodes.ring.cosines == tuple(axis[0] for axis in diodes.axes)
    assert diodes.ring.sines == tuple(axis[1] for axis in diodes.axes)
    plain = build_even_ring(4)
    assert plain.places == ((0.0, 0.0, 0.0),) * 4
    assert (plain.response, plain.spread) == (1.0, 0.0)


def test_places_are_relative_to_the_mean_place_of_the_diodes():
    """The unit axes have the mean (1/3, 1/3, 1/3), and the radius is 3 m."""
    axes = {'value': ((2.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, 0.0, 0.5))}
    entry = ENTRY.model_copy(
        update={
            'count': 3,
            'axes': ENTRY.radius.model_copy(update=axes),
            'radius': ENTRY.radius.model_copy(update={'value': 3.0, 'unit': 'm'}),
            'dead': (1,),
        }
    )
    diodes = build_diode_array(entry)
    assert diodes.axes == ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    assert diodes.gains == (1.0, 0.0, 1.0)
    assert diodes.places == (
        pytest.approx((2.0, -1.0, -1.0)),
        pytest.approx((-1.0, 2.0, -1.0)),
        pytest.approx((-1.0, -1.0, 2.0)),
    )


def test_a_vehicles_diodes_are_those_of_its_file():
    diodes = build_diode_array(ENTRY)
    assert len(diodes.axes) == ENTRY.count == 8
    assert diodes.axes[2] == pytest.approx((0.0, 1.0, 0.0), abs=1e-15)
    assert diodes.places[2] == pytest.approx((0.0, 0.07, 0.0), abs=1e-15)
    diodes.check_diode_count(8)
    with pytest.raises(BadInput, match='4 photodiodes, but the vehicle file has 8'):
        diodes.check_diode_count(4)


@pytest.mark.parametrize(
    'allowed',
    [
        {'gains': (0.0,) * 4},
        {'spread': 0.0},
        {'response': 1e-9},
        {'axes': ((1.0 + 0.9e-6, 0.0, 0.0), *build_even_ring(4).axes[1:])},
    ],
)
def test_limiting_values_of_diodes_are_accepted(allowed):
    made = replace(build_even_ring(4), **allowed)
    assert {name: getattr(made, name) for name in allowed} == allowed


def test_the_expected_elevation_and_nearness_follow_from_the_prior():
    """Nearness 1 / 4 with deviation 3 / 4^2, elevation with atan2(1, 4); 1e-3 is the least."""
    prior = LampPrior(distance=4.0, distance_deviation=3.0, height_deviation=1.0)
    assert build_direction_prior(prior) == (
        0.0, pytest.approx(math.atan2(1.0, 4.0)), 0.25, pytest.approx(3.0 / 16.0),
    )  # fmt: skip
    sure = LampPrior(distance=4.0, distance_deviation=0.0, height_deviation=0.0)
    assert build_direction_prior(sure) == (0.0, 1e-3, 0.25, 1e-3)


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
