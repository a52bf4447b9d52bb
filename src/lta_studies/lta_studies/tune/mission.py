"""
The whole flight to the lamp, with lost lift: what good steps alone do not promise.

Gains that make every step calmer can turn the drone too slowly for its guidance, and it flies past
its goal. So each examination ends with one mission of the shipped scene, in the loop of
`lta_flight.loop` with its light blocks.
"""

from typing import NamedTuple

from lta_config.topics import topic_table
from lta_control.cascade import CascadeGains
from lta_control.strategies import strategy
from lta_flight.loop import Loop
from lta_flight.policy import Policy
from lta_sim.readings import Outcome
from lta_sim.world import World
from lta_studies.tune.exam import Case, Scene

STRATEGY = 'bag'


class Sought(NamedTuple):
    """How a mission ended: whether at the lamp, and after how long, of the time allowed. [1]"""

    reached: bool
    time: float


def seek(scene: Scene, gains: CascadeGains, case: Case) -> Sought:
    """Fly one mission."""
    scenario, table = scene.air, topic_table()
    world = World(scene.true(case.loss), scenario, table, case.seed)
    loop = Loop(world, table, Policy(strategy(STRATEGY), gains), scene.known)
    while world.outcome is Outcome.FLYING:
        loop.step()
    return Sought(world.outcome is Outcome.REACHED, world.elapsed / scenario.goal.time_limit.si)
