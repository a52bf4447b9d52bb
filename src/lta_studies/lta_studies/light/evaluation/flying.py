"""
The flights of the evaluation, seed by seed, and how one is flown.

All sets fly their first seed before any flies its second: whoever stops early has all sets with
fewer seeds. A flight is known by its set and its place in that set's sweep, which does not depend
on how many seeds are asked for: more seeds only add to those there are.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.schema.sweep_file import load_sweep, Seeds
from lta_control.cascade import CascadeGains
from lta_flight.ingredients import gather, Ingredients, loop_of
from lta_flight.loop import Loop
from lta_flight.sweep.flown import flown, Row
from lta_flight.sweep.plan import Job, Plan
from lta_studies.light.evaluation import pilot
from lta_studies.light.evaluation.sets import flight_set

MOST: Final = 1000  # seeds
STRATEGY: Final = 'strategy'


@final
@dataclass(frozen=True, slots=True)
class Task:
    """One flight: its set, and its job there."""

    part: str
    job: Job


def plan_of(name: str) -> Plan:
    """
    Return the flights of a set, all of them checked; the pilot's among them where it flies.

    Raises
    ------
    BadInput
        If the set's sweep cannot be flown.

    """
    part = flight_set(name)
    file = load_sweep(part.file)
    strategies = file.vary.get(STRATEGY)
    if not isinstance(strategies, list) or file.samples is not None:
        raise BadInput(
            f'The sweep {part.file} of the set {name} must list strategies, and draw nothing.'
        )
    Plan(file).check()
    flyers = [*strategies, *([pilot.NAME] if part.piloted else [])]
    seeds = Seeds(first=file.seeds.first, count=MOST)
    return Plan(file.model_copy(update={'vary': {**file.vary, STRATEGY: flyers}, 'seeds': seeds}))


def points(plan: Plan) -> int:
    """Return how many flights of one seed there are."""
    return plan.count // plan.file.draws


def tasks(plans: dict[str, Plan], seeds: int) -> Iterator[Task]:
    """Yield every flight, seed by seed."""
    for turn in range(seeds):
        for name, plan in plans.items():
            for point in range(points(plan)):
                yield Task(name, plan.job(point * plan.file.draws + turn))


def whole(plan: Plan, job: Job, place: int) -> Job:
    """Return a job that names all it is made of: one worker flies the jobs of all sets."""
    base = plan.base
    case = {**base.names, STRATEGY: base.strategy, **base.replaced, **job.case}
    return replace(job, index=place, case=case)


def fly_task(job: Job) -> Row:
    """Fly one flight, from a job that names all it is made of."""
    return flown(job, lambda: begun(job))


def begun(job: Job) -> Loop:
    """Return the flight of a job that names all it is made of, about to begin."""
    changes = dict(job.changes)
    piloted = changes[STRATEGY] == pilot.NAME
    if piloted:
        changes[STRATEGY] = job.case[STRATEGY]
    loop = loop_of(made_of(changes), job.seed)
    if piloted:
        loop.policy = replace(loop.policy, strategy=pilot.pilot(loop.world, top_airspeed(loop)))
    return loop


def top_airspeed(loop: Loop) -> float:
    """Return the most airspeed that the controller of a flight allows. [m/s]"""
    gains = loop.policy.gains
    return gains.speed_limit if isinstance(gains, CascadeGains) else math.inf


def made_of(changes: dict[str, object]) -> Ingredients:
    """Return what a flight is made of that names all of it."""
    vehicle, scenario, strategy, gains = (
        str(changes.pop(root)) for root in ('vehicle', 'scenario', STRATEGY, 'gains')
    )
    return gather(vehicle, scenario, strategy, gains).with_values(changes)


def chosen(names: Sequence[str]) -> dict[str, Plan]:
    """Return the plans of some sets, in their order, each once."""
    return {name: plan_of(name) for name in dict.fromkeys(names)}
