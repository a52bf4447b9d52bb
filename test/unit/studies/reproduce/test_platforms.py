# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The paper's table of platforms as numbers: hand counts, and the order they make."""

import math

from lta_config.constants import AIR_DENSITY
from lta_config.schema.comparison_file import load_comparison
from lta_studies.platforms.flight import build_entrant
from lta_studies.reproduce.studies.platforms import (
    count_thrust_lines,
    CRITERIA,
    greatest_extent,
    rank_concordance,
    RANKED,
    thrust_to_weight,
)
from lta_studies.reproduce.study_result import MeasuredValue
import pytest


@pytest.fixture(scope='module')
def vehicles():
    contestants = load_comparison('platforms').contestants
    return {name: build_entrant(contestants[name], AIR_DENSITY).vehicle for name in RANKED}


def test_rotors_push_along_as_many_lines_as_their_axes_have(vehicles):
    # Two pairs cross on GT-MAB; BEAVIS's opposite rotors share a line; SBlimp's four tilts do not.
    assert {name: count_thrust_lines(each) for name, each in vehicles.items()} == {
        'multirotor': 1, 'gtmab': 2, 'beavis': 2, 'sblimp': 4, 'skye': 6,
    }  # fmt: skip


def test_extents_are_those_of_the_hulls_and_of_the_arms_without_one(vehicles):
    assert greatest_extent(vehicles['gtmab']) == 1.0
    assert greatest_extent(vehicles['skye']) == 2.7
    assert greatest_extent(vehicles['multirotor']) == pytest.approx(
        0.092, abs=1e-3
    )  # Crazyflie, diagonal


def test_a_drone_without_a_hull_carries_all_of_itself_and_gtmab_its_two_grams(vehicles):
    assert thrust_to_weight(vehicles['multirotor']) == pytest.approx(1.0)
    body = vehicles['gtmab']
    # 2 g on two rotors of which 96.1 % come through the jets' pull on the hull.
    assert thrust_to_weight(body) == pytest.approx(0.002 / 0.961 / body.mass)


def test_an_order_is_the_share_of_pairs_ranked_apart_that_come_out_so():
    column = list(CRITERIA).index('size')
    as_ranked = {name: MeasuredValue(float(ranks[column])) for name, ranks in RANKED.items()}
    assert rank_concordance('size', as_ranked) == 1.0
    turned = {name: MeasuredValue(-each.value) for name, each in as_ranked.items()}
    assert rank_concordance('size', turned) == 0.0
    # Of 1 low, 3 medium and 1 high, 3 + 1 + 3 pairs are apart; three tie if all mediums are low.
    low = {name: MeasuredValue(max(each.value, 2.0)) for name, each in as_ranked.items()}
    assert rank_concordance('size', low) == pytest.approx(4.0 / 7.0)
    assert math.isclose(
        rank_concordance('endurance', {n: MeasuredValue(1.0) for n in RANKED}), 0.0
    )
