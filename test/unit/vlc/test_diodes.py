# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The model of the diodes at the limits of what is allowed, and the direction finder."""

from dataclasses import replace
import math

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_vlc.diodes import build_diode_array, build_even_ring
from lta_vlc.direction import build_direction_prior
from lta_vlc.lamp import LampPrior
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
