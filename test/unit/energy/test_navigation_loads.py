"""What finding a lamp takes beyond hovering, against the paper's figures."""

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_model.electrical import loads
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.world import World
import pytest

ENERGY = load_vehicle_file('gtmab').energy


def test_navigation_takes_what_the_paper_prints_beyond_hovering():
    """1523 to 1544 mW of BAG, DES and DGA, less 1333 mW of hovering."""
    beyond = [loads.navigation_power(ENERGY, name) for name in ('bag', 'des', 'dga')]
    assert beyond == pytest.approx([0.190, 0.2005, 0.211])


def test_who_does_not_look_takes_nothing_and_an_unknown_strategy_senses_alone():
    assert loads.navigation_power(ENERGY, '') == 0.0
    assert loads.navigation_power(ENERGY, 'mine') == pytest.approx(0.190)
    assert loads.navigation_power(load_vehicle_file('multirotor').energy, 'bag') == 0.0


@pytest.mark.parametrize('strategy', ['', 'bag', 'dga'])
def test_the_cell_of_a_flight_feeds_what_lamps_are_found_with(strategy):
    world = World(
        load_vehicle('gtmab'), load_scenario('lamp_room'), load_topic_table(), 1, strategy
    )
    for _ in range(100):
        world.advance((0.0,) * 4)
    assert world.supply.energy_totals.consumed == pytest.approx(
        0.120 + loads.navigation_power(ENERGY, strategy), rel=1e-6
    )
