# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Two noisy recordings of one motion, compared."""

import itertools

from lta_data.bag import open_flight
from lta_data.compare.comparison import compare_flights, ComparisonRequest
import pytest

from .compare_flight import write_motion

X, Z = 'odom/pose.pose.position.x', 'odom/pose.pose.position.z'
YAW = 'odom/pose.pose.orientation.yaw'


@pytest.fixture
def two(tmp_path):
    """Return a function that compares two recordings of the motion."""
    count = itertools.count()

    def make(first=None, second=None, **asked):
        bags = [tmp_path / f'{label}{next(count)}' for label in 'ab']
        for bag, how in zip(bags, (first or {}, second or {}), strict=True):
            write_motion(bag, **how)
        return compare_flights(*map(open_flight, bags), ComparisonRequest(**asked))

    return make


def channel(found, name):
    return next(each for each in found.channels if each.name == name)


NOISY = {'noise': 0.01, 'seed': 1}
OTHER = {'noise': 0.01, 'seed': 2, 'rate': 30.0, 'phase': 0.003}
