# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which channels of two flights are compared: of other names or units, and what one lacks."""

from lta_analysis.comparison.sentences import format_verdict
from lta_config.errors import BadInput
from lta_data.bag import open_flight
from lta_data.compare.channel_comparison import select_topic_pairs
from lta_data.compare.comparison import (
    compare_flights,
    compare_sides,
    ComparisonRequest,
)
from lta_data.flight import Channel
import numpy as np
import pytest

from ...report_flight import write_flight  # noqa: TID252 - `test` is Python's own
from .compare_flight import side_of, UNIX, write_motion
from .compare_two import channel, NOISY, OTHER, YAW, Z
from .compare_two import two as two


def test_an_estimate_is_compared_with_the_truth_of_its_own_bag(tmp_path):
    bag = write_flight(tmp_path / 'bag')
    flights = open_flight(bag), open_flight(bag)
    found = compare_flights(*flights, ComparisonRequest(pairs=('odom=ground_truth/odom',)))
    assert found.timing.how == 'none'
    # By hand: the estimate is 2 cm too high and its own frame lies at the start of the flight.
    altitude = channel(found, Z)
    assert altitude.other == 'ground_truth/odom/pose.pose.position.z'
    assert altitude.measures.bias == pytest.approx(-0.02, abs=1e-9)
    laid = compare_flights(
        *flights, ComparisonRequest(pairs=('odom=ground_truth/odom',), frames='fit')
    )
    fit = laid.frames[0].fit
    assert fit.yaw == pytest.approx(0.3, abs=1e-6)
    assert (fit.x, fit.y) == pytest.approx((3.5 * np.cos(0.3), 3.5 * np.sin(0.3)), abs=1e-6)
    assert fit.z == pytest.approx(0.02, abs=1e-9)
    # Its yaw runs away by 0.01 rad a second from 4 s on; the flight ends at 17 s.
    assert channel(laid, YAW).both.difference[-1] == pytest.approx(-0.13, abs=1e-6)
    assert channel(laid, YAW).parting.at == pytest.approx(4.0, abs=0.5)


def test_channels_of_other_names_are_paired_by_how_they_end(tmp_path):
    a = side_of([Channel('pose/pose.position.x', 'm', np.arange(50.0), np.arange(50.0))], 'A')
    b = side_of([Channel('odom/pose.pose.position.x', 'm', np.arange(50.0), np.ones(50))], 'B')
    wanted = select_topic_pairs(['pose=odom'], (), list(a.topics), list(b.topics))
    found = compare_sides(a, b, wanted, ComparisonRequest())
    assert found.channels[0].other == 'odom/pose.pose.position.x'


def test_other_units_are_not_compared():
    t = np.arange(50.0)
    a = side_of([Channel('range/range', 'm', t, t), Channel('range/x', 'm', t, t)], 'A')
    b = side_of([Channel('range/range', 'mm', t, t), Channel('range/x', 'm', t, t)], 'B')
    wanted = select_topic_pairs((), (), list(a.topics), list(b.topics))
    found = compare_sides(a, b, wanted, ComparisonRequest())
    assert [each.name for each in found.channels] == ['range/x']
    assert (
        "Channel 'range/range' is not compared: its unit is m in A, but mm in B." in found.remarks
    )


def test_flights_with_nothing_in_common_say_what_each_has(tmp_path):
    a = write_motion(tmp_path / 'a', until=5.0)
    b = write_motion(tmp_path / 'b', until=5.0, topic='tracker')
    with pytest.raises(
        BadInput, match=r'no topic in common \(A: odom; B: tracker\); name the topics'
    ):
        compare_flights(open_flight(a), open_flight(b), ComparisonRequest())
    found = compare_flights(
        open_flight(a), open_flight(b), ComparisonRequest(pairs=('odom=tracker',))
    )
    assert found.channels[0].verdict == 'identical'
    assert found.a.start == UNIX


def test_topics_that_one_flight_lacks_are_listed(two):
    found = two(NOISY | {'extra': ('motors',)}, OTHER)
    assert (found.only_a, found.only_b) == (('motors',), ())
    assert not found.is_identical
    assert {each.name.split('/')[0] for each in found.channels} == {'odom'}


def test_two_topics_of_one_bag_are_no_two_flights(tmp_path):
    bag = tmp_path / 'bag'
    write_motion(bag, topic='odom', extra=())
    flight = open_flight(bag)
    pairs = ('odom/pose.pose.position.x=odom/pose.pose.position.y',)
    found = compare_flights(flight, flight, ComparisonRequest(pairs=pairs))
    assert format_verdict(found).startswith('odom and odom differ from the start, in x of odom')
