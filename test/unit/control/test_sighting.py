# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a strategy sees is what the demodulator said."""

import math

from lta_control.motion import DeadReckonedMotion
from lta_control.sighting import bearing_deviation, build_sight, LampPosition
import pytest

STILL = DeadReckonedMotion(0.3, 1.0, 2.0, 0.4, -0.1)


def lamp_at(angle, distance, along, deviation):
    """Return a lamp as light/estimate tells it: long on its ray, narrow across."""
    c, s = math.cos(angle), math.sin(angle)
    across = (distance**2 + along**2) * deviation**2
    xx, yy = along**2 * c * c + across * s * s, along**2 * s * s + across * c * c
    return LampPosition(distance * c, distance * s, 1.0, (xx, (along**2 - across) * c * s, yy))


@pytest.mark.parametrize('angle', [-3.0, -1.0, 0.0, 0.7, 2.5])
def test_bearing_and_deviation_come_back_out_of_the_estimate(angle):
    seen = build_sight(lamp_at(angle, 4.0, 3.0, 0.05), ((1.0, 0.0),), (5.0,), STILL, 0.1)
    assert seen.seen
    assert seen.bearing == pytest.approx(angle)
    assert seen.deviation == pytest.approx(0.05)
    assert seen.elevation == pytest.approx(math.atan2(1.0, 4.0))
    assert (seen.heading, seen.position, seen.drift) == (0.3, (1.0, 2.0), (0.4, -0.1))


def test_without_a_lamp_nothing_is_seen():
    seen = build_sight(None, (), (), STILL, 0.1)
    assert not seen.seen
    assert (seen.bearing, seen.strength, seen.deviation) == (0.0, 0.0, 0.0)
    assert seen.amplitudes == (0.0,)  # of a block that could not be read: a diode in the dark


def test_a_nan_or_infinite_amplitude_is_taken_as_zero():
    axes, read = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)), (4.0, math.nan, math.inf, 0.0)
    seen = build_sight(lamp_at(0.0, 4.0, 3.0, 0.05), axes, read, STILL, 0.25)
    assert seen.amplitudes == (4.0, 0.0, 0.0, 0.0)
    assert (seen.strength, seen.interval) == (4.0, 0.25)


def test_the_deviation_of_a_bearing_by_hand():
    """Variances along (3, 4): (9 xx + 24 xy + 16 yy) / 25; across: (16 xx - 24 xy + 9 yy) / 25."""
    along, across = (9 * 2.0 + 24 * 0.5 + 16 * 1.0) / 25, (16 * 2.0 - 24 * 0.5 + 9 * 1.0) / 25
    found = bearing_deviation(LampPosition(3.0, 4.0, 7.0, (2.0, 0.5, 1.0)))
    assert found == pytest.approx(math.sqrt(across / (25.0 + along)))
    assert bearing_deviation(LampPosition(0.0, 0.0, 7.0, (2.0, 0.5, 1.0))) == math.pi
    # Rounding may leave a variance a little below zero.
    assert bearing_deviation(LampPosition(1.0, 0.0, 0.0, (1.0, 0.0, -1e-18))) == 0.0
    assert bearing_deviation(LampPosition(1.0, 0.0, 0.0, (-1e-18, 0.0, 1.0))) == 1.0
