# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""How old a stamp is: what lies far ahead is as old as what never came."""

import math

from lta_graph.health import CLOCK_TOLERANCE, stamp_age
import pytest

NOW = 10**18


@pytest.mark.parametrize(
    ('ahead', 'expected'),
    [
        (-2.5, 2.5),
        (0.0, 0.0),
        (CLOCK_TOLERANCE - 0.01, 0.01 - CLOCK_TOLERANCE),
        (CLOCK_TOLERANCE + 0.01, math.inf),
        (3600.0, math.inf),
    ],
)
def test_the_far_future_is_infinitely_old(ahead, expected):
    assert stamp_age(NOW + round(1e9 * ahead), NOW) == pytest.approx(expected)


def test_what_never_came_is_infinitely_old():
    assert stamp_age(None, NOW) == math.inf
