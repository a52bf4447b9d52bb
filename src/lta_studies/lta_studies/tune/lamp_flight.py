"""
The whole flight to the lamp, with lost lift: what good steps alone do not promise.

Gains that make every step calmer can turn the drone too slowly for its guidance, and it flies past
its goal. So each examination ends with one mission of the shipped scene, in the loop of
`lta_flight.closed_loop` with its light blocks.
"""

from typing import NamedTuple

from lta_config.topics import load_topic_table
from lta_control.cascade import CascadeGains
from lta_control.strategies import find_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
from lta_studies.tune.step_response import TuningCase, TuningScene

STRATEGY = 'bag'


class LampFlightResult(NamedTuple):
    """How a mission ended: whether at the lamp, and after how long, of the time allowed. [1]"""

    reached: bool
    time: float


def fly_to_lamp(scene: TuningScene, gains: CascadeGains, case: TuningCase) -> LampFlightResult:
    """Fly one mission."""
    scenario, table = scene.scenario, load_topic_table()
    world = World(scene.build_true_vehicle(case.loss), scenario, table, case.seed)
    loop = ClosedLoop(
        world, table, FlightStack(find_strategy(STRATEGY), gains), scene.nominal_vehicle
    )
    while world.outcome is FlightOutcome.FLYING:
        loop.step()
    return LampFlightResult(
        world.outcome is FlightOutcome.REACHED, world.elapsed / scenario.goal.time_limit.si
    )
