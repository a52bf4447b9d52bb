"""The paper's table of platforms as numbers: hand counts, and the order they make."""

import math

from lta_config.constants import AIR_DENSITY
from lta_config.schema.comparison_file import load_comparison
from lta_studies.platforms.entries import entrant
from lta_studies.reproduce.found import Value
from lta_studies.reproduce.studies.platforms import (
    carried,
    concordance,
    CRITERIA,
    directions,
    extent,
    RANKED,
)
import pytest


@pytest.fixture(scope='module')
def vehicles():
    contestants = load_comparison('platforms').contestants
    return {name: entrant(contestants[name], AIR_DENSITY).vehicle for name in RANKED}


def test_rotors_push_along_as_many_lines_as_their_axes_have(vehicles):
    # Two pairs cross on GT-MAB; BEAVIS's opposite rotors share a line; SBlimp's four tilts do not.
    assert {name: directions(each) for name, each in vehicles.items()} == {
        'multirotor': 1, 'gtmab': 2, 'beavis': 2, 'sblimp': 4, 'skye': 6,
    }  # fmt: skip


def test_extents_are_those_of_the_hulls_and_of_the_arms_without_one(vehicles):
    assert extent(vehicles['gtmab']) == 1.0
    assert extent(vehicles['skye']) == 2.7
    assert extent(vehicles['multirotor']) == pytest.approx(0.092, abs=1e-3)  # Crazyflie, diagonal


def test_a_drone_without_a_hull_carries_all_of_itself_and_gtmab_its_two_grams(vehicles):
    assert carried(vehicles['multirotor']) == pytest.approx(1.0)
    body = vehicles['gtmab']
    # 2 g on two rotors of which 96.1 % come through the jets' pull on the hull.
    assert carried(body) == pytest.approx(0.002 / 0.961 / body.mass)


def test_an_order_is_the_share_of_pairs_ranked_apart_that_come_out_so():
    column = list(CRITERIA).index('size')
    as_ranked = {name: Value(float(ranks[column])) for name, ranks in RANKED.items()}
    assert concordance('size', as_ranked) == 1.0
    turned = {name: Value(-each.value) for name, each in as_ranked.items()}
    assert concordance('size', turned) == 0.0
    # Of 1 low, 3 medium and 1 high, 3 + 1 + 3 pairs are apart; three tie if all mediums are low.
    low = {name: Value(max(each.value, 2.0)) for name, each in as_ranked.items()}
    assert concordance('size', low) == pytest.approx(4.0 / 7.0)
    assert math.isclose(concordance('endurance', {n: Value(1.0) for n in RANKED}), 0.0)
