# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The covariances of `odom` and `airspeed` in whole flights; docs/control.md has the table."""

from campaigns import odometry
import numpy as np
import pytest


@pytest.mark.parametrize(
    ('wind', 'least'), [((0.0, 0.0), 0.1), ((-0.4, 0.0), 0.4), ((0.0, 0.4), 0.4)]
)
def test_the_covariance_of_odom_is_honest(wind, least):
    case = odometry.OdometryScene(wind=wind)
    flights = [odometry.measure_flight(case, seed, longest=25.0) for seed in (1, 2, 3, 4)]
    normalised = np.mean([each.normalised for each in flights], axis=0)
    velocity, place = normalised[:3], normalised[3:6]
    # Averages over few flights; docs/control.md has those over more. In still air the filter
    # cannot tell that there is no wind
    assert np.all(velocity < 2.0)
    assert least < velocity[:2].mean() < 2.0
    assert np.all(place < 3.0)
    assert least < place.mean() < 2.0
    # Much better than the wind of 0.4 m/s, which the airspeed alone would be off by
    assert np.sqrt((flights[0].errors[:, :2] ** 2).mean()) < 0.15
    assert normalised[6:].max() < 2.0


def test_without_a_lamp_the_covariance_grows_to_that_of_the_wind():
    case = odometry.CASES['lamp never seen, 0.4 m/s across']
    flights = [odometry.measure_flight(case, seed, longest=40.0) for seed in (1, 2)]
    assert np.mean([each.normalised[:2] for each in flights]) < 2.0
    for each in flights:
        assert np.sqrt(each.variances[-1, 0]) > 0.2
