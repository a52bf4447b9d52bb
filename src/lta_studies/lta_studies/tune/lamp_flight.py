"""
Fly a whole mission to the lamp with lost lift.

Good step responses are not enough: gains can turn the drone too slowly for its guidance, so that
it flies past its goal. Each test flight is therefore followed by one mission in the shipped scene,
flown by `lta_flight.closed_loop` with the light link.
"""

from typing import NamedTuple

from lta_config.topics import load_topic_table
from lta_control.cascade import CascadeGains
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
from lta_studies.tune.step_response import TuningCase, TuningScene

STRATEGY = 'bag'


class LampFlightResult(NamedTuple):
    """Whether a mission reached the lamp, and its duration as a share of the time limit."""

    reached: bool
    time: float


def fly_to_lamp(scene: TuningScene, gains: CascadeGains, case: TuningCase) -> LampFlightResult:
    """Fly one mission to the lamp."""
    scenario, table = scene.scenario, load_topic_table()
    world = World(scene.build_true_vehicle(case.loss), scenario, table, case.seed)
    loop = ClosedLoop(
        # The drone assumes the nominal vehicle; only the world has lost lift.
        world,
        table,
        FlightStack(find_navigation_strategy(STRATEGY), gains),
        scene.nominal_vehicle,
    )
    while world.outcome is FlightOutcome.FLYING:
        loop.step()
    return LampFlightResult(
        # A share of the limit, so that costs of different scenes compare.
        world.outcome is FlightOutcome.REACHED,
        world.elapsed / scenario.goal.time_limit.si,
    )
