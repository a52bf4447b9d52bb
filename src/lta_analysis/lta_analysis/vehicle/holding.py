"""
Up to which loss of helium the tuned gains hold: flown in the closed loop, heavier and heavier.

The drone knows the vehicle as its file has it; the true one has lost lift (`net_lift`). Gains hold
where the flight reaches its goal and keeps its altitude within 10 cm rms in the cruise, for every
seed flown. The losses are tried from the least on, up to where the rotors cannot carry it any
more; then the bracket around the first failure is halved.
"""

from collections.abc import Callable

from lta_analysis.ingredients import gather, Ingredients, loop_of
from lta_analysis.loop import Loop
from lta_analysis.loop_view import LoopView
from lta_analysis.report.results import results_of
from lta_analysis.vehicle.staying import spare_lift
from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.topics import topic_table
from lta_sim.readings import Outcome
from lta_sim.vehicle import load_vehicle, Vehicle
from lta_sim.world import World

SCENARIO, STRATEGY = 'lamp_room', 'bag'
SEEDS = (1, 2)
ALTITUDE = 0.10  # m, rms
STEPS = 8  # of the losses tried first
HALVINGS = 3


def held_loss(name: str, tell: Callable[[float, bool], None] | None = None) -> float:
    """
    Return the largest loss of lift at which the gains of a vehicle's file still hold. [kg].

    Parameters
    ----------
    name : str
        Vehicle name or file.
    tell : callable or None
        Called after each loss that was tried, with it [kg] and whether the gains held.

    Raises
    ------
    BadInput
        If the file names no gains, the vehicle cannot hover, or it cannot be flown by them at all.

    """
    vehicle = load_vehicle(name)
    control, spare = vehicle.file.control, spare_lift(vehicle)
    if control is None or control.gains is None:
        raise BadInput(f'{vehicle.file.name} names no gains in its control block; leave --gains.')
    if spare is None:
        raise BadInput(f'{vehicle.file.name} cannot hover, so nothing can be lost; leave --gains.')
    made_of = gather(name, SCENARIO, STRATEGY, control.gains)

    def holds(loss: float) -> bool:
        kept = all(flown_well(made_of, loss, seed) for seed in SEEDS)
        if tell is not None:
            tell(loss, kept)
        return kept

    return bracketed(holds, spare)


def bracketed(holds: Callable[[float], bool], most: float) -> float:
    """Return the largest value up to which something holds, from steps and halvings."""
    low = None
    for step in range(STEPS + 1):
        at = most * step / STEPS
        if not holds(at):
            break
        low = at
    else:
        return most
    if low is None:
        return 0.0
    high = at
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def flown_well(made_of: Ingredients, loss: float, seed: int) -> bool:
    """Return whether a flight with that much lift lost [kg] is a good one."""
    known = loop_of(made_of, seed)
    lighter = made_of.with_values({'vehicle.effects.net_lift.force': _force(loss)})
    true = loop_of(lighter, seed)
    world = World(true.world.vehicle, known.world.scenario, topic_table(), seed)
    loop = Loop(world, topic_table(), known.policy, Vehicle(known.world.vehicle.file))
    view = LoopView(loop)
    for _ in loop.flight():
        view.take()
    error = results_of(view).altitude_error
    return world.outcome is Outcome.REACHED and error is not None and error <= ALTITUDE


def _force(loss: float) -> dict[str, object]:
    return {'value': -loss * STANDARD_GRAVITY, 'unit': 'N'}
