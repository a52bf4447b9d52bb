# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Flights of the strategies: their statistics, their groups, and the pilot beside them."""

from itertools import product
import math

from lta_config.schema.sweep_file import SweepFile
from lta_flight.sweep.batch_workers import SweepRow
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.statistics import bootstrap_mean, bootstrap_ratio
from lta_studies.reproduce.flights import fly_job
from lta_studies.reproduce.strategy_flights import (
    group_flights,
    ordered_share,
    PILOT,
    solve_wind_triangle,
    StrategyFlights,
)
import numpy as np
import pytest

NEAR = {
    'schema': 1, 'name': 'near', 'about': 'From close by.', 'vehicle': 'gtmab',
    'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab', 'seeds': {'count': 2},
    'set': {'scenario.start.position.0': '2.2 m', 'scenario.goal.time_limit': '12 s',
            'scenario.start.heading': '0 deg', 'scenario.start.heading_spread': '20 deg'},
    'vary': {'strategy': ['bag', PILOT], 'scenario.air.wind.0': ['0 m/s', '-0.05 m/s']},
}  # fmt: skip


def test_a_mean_has_the_interval_of_all_ways_to_resample_it():
    """Of three flights there are 27 ways; the draws come to the same ends."""
    values = [1.0, 2.0, 6.0]
    ways = [np.mean(way) for way in product(values, repeat=3)]
    found = bootstrap_mean(values)
    assert found.value == 3.0
    expected = np.percentile(ways, (2.5, 97.5), method='inverted_cdf')
    assert (found.low, found.high) == pytest.approx(tuple(expected))
    assert bootstrap_mean([4.0])[:1] == (4.0,)
    assert math.isnan(bootstrap_mean([4.0]).low)
    assert math.isnan(bootstrap_mean([]).value)


def test_a_ratio_is_of_means_over_the_same_seeds():
    """Flights that are all the same multiple of the best have no spread at all."""
    best = [6.0, 7.0, 9.0, 6.5]
    found = bootstrap_ratio([1.1 * each for each in best], best)
    assert found[:3] == pytest.approx((1.1, 1.1, 1.1))
    assert bootstrap_ratio([6.0, 12.0], [6.0, 6.0]).value == pytest.approx(1.5)


def test_only_arrivals_have_a_path():
    rows = {1: SweepRow(1, 1, {}, 'reached', '', figures={'path_length': 5.0})}
    rows |= {k: SweepRow(k, k, {}, 'timeout', '') for k in (2, 3, 4)}
    own = StrategyFlights('bag', '', math.nan, rows)
    assert own.reached_share.value == 0.25
    assert own.mean('path_length')[::3] == (5.0, 1)


def test_the_share_of_draws_in_an_order():
    # Of flights that are 0 or 2 the mean of five draws is below 1 in as many cases as above it.
    assert ordered_share([[0.0, 2.0] * 3, [1.0] * 6]) == pytest.approx(
        0.5 - 0.5 * 20 / 64, abs=0.03
    )
    assert ordered_share([[6.0 + 0.3 * k for k in range(5)], [9.0] * 5]) == 1.0
    assert math.isnan(ordered_share([[1.0] * 5, []]))


def test_the_pilot_keeps_its_track_straight():
    """In a 3-4-5 triangle, and at the bounds of the airspeed: 0.5 and 1 m/s."""
    assert solve_wind_triangle(0.0, 0.3, 0.5, 1.0) == pytest.approx((0.4, -0.3))
    assert solve_wind_triangle(-0.4, 0.0, 0.5, 1.0) == pytest.approx((1.0, 0.0))
    assert solve_wind_triangle(0.0, -0.6, 0.5, 1.0) == pytest.approx((0.8, 0.6))
    assert solve_wind_triangle(0.0, 2.0, 0.5, 1.0) == pytest.approx((0.0, -1.0))
    assert solve_wind_triangle(0.9, 0.0, 0.5, 1.0) == pytest.approx((0.5, 0.0))


def test_a_pilot_flies_beside_a_strategy_in_every_case():
    plan = SweepPlan(SweepFile.model_validate(NEAR))
    rows = [fly_job(plan, plan.build_job(k)) for k in range(plan.count)]
    # A flight that could not be simulated is no missed lamp
    groups = group_flights([*rows, SweepRow(99, 9, {'strategy': 'bag'}, 'failed', '')])
    found = {(each.strategy, each.place): each for each in groups}
    assert found.keys() >= set(product(('bag', PILOT), (0.0, -0.05)))
    for strategy, wind in product(('bag', PILOT), (0.0, -0.05)):
        own = found[strategy, wind]
        assert (sorted(own.rows), own.reached_share.value) == ([1, 2], 1.0)
        # 1.3 m away, the goal circle 0.3 m ahead.
        assert all(0.29 < path < 0.6 for path in own.arrival_values('path_length').values())
