"""
List the flights of an evaluation seed by seed, and fly them.

All sets fly their first seed before any flies its second, so that an evaluation that is stopped
early covers all sets. A flight is identified by its set and its index in that set's sweep, which
does not depend on the number of seeds: more seeds extend an existing evaluation. In batch mode the
flights of a strategy are one batch, and the pilot, which reads the simulated world, flies alone.

The pilot is a reference: it knows the positions of lamp and drone and the wind at the hull, and
uses the same mission, controller and rotors as every strategy. With the wind w, the unit vector t
to the lamp and n to the left of it, its air velocity is

    a = sqrt(V^2 - (w.n)^2) t - (w.n) n

so that the ground track is straight wherever the airspeed V exceeds the crosswind. V is the cruise
speed, or the controller's limit if the cruise speed leaves less than half of itself over ground.
The wind is low-pass filtered, because following every gust would only cost time. The path of the
pilot is the reference for the strategies.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, Self

from lta_config.errors import BadInput
from lta_config.schema.sweep_file import load_sweep, SweepSeeds
from lta_control.attitude import yaw_from_quaternion
from lta_control.cascade import CascadeGains
from lta_control.strategies.protocol import (
    CruiseSettings,
    LightMeasurement,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_loop, FlightSpec, load_spec
from lta_flight.sweep.batch_workers import BatchWorkers
from lta_flight.sweep.job_runner import run_job, SweepRow
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_model.state import QUATERNION
from lta_report.workers import ItemFailure, Workers
from lta_sim.world import World
from lta_studies.light.evaluation.sets import find_flight_set

PILOT = 'pilot'
WIND_FILTER_TIME = 5.0  # s, time constant of the low-pass filter of the wind
LEAST_GROUND_SHARE = (
    0.5  # share of the cruise speed over ground below which the pilot flies faster
)


def build_pilot_strategy(world: World, top: float) -> NavigationStrategy:
    """
    Return a strategy that uses the true state of the world instead of the light.

    `world`: simulated world. `top`: airspeed limit of the controller [m/s].
    """
    lamp_x, lamp_y, _ = world.scenario.goal_lamp.position.vector

    def start(heading: float) -> Memory:
        return (heading,)

    def steer(
        settings: CruiseSettings, memory: Memory, sight: LightMeasurement
    ) -> tuple[SteeringCommand, Memory]:
        towards = math.atan2(lamp_y - float(world.state[1]), lamp_x - float(world.state[0]))
        c, s = math.cos(towards), math.sin(towards)
        x, y, _ = world.wind
        # The first call has no filtered wind yet and takes the current one.
        if len(memory) > 1:
            # First-order low-pass filter, discretised; at most 1 for long intervals
            share = min(sight.interval / WIND_FILTER_TIME, 1.0)
            x, y = memory[1] + share * (x - memory[1]), memory[2] + share * (y - memory[2])
        # Wind along the track and to the left of it
        along, left = solve_wind_triangle(x * c + y * s, y * c - x * s, settings.speed, top)
        qx, qy, qz, qw = world.state[QUATERNION].tolist()
        # The drone's heading is relative to its start; correct it by the true heading.
        turn = towards + math.atan2(left, along) - yaw_from_quaternion((qx, qy, qz, qw))
        heading = sight.heading + math.remainder(turn, math.tau)
        return SteeringCommand(heading, math.hypot(along, left)), (heading, x, y)

    return NavigationStrategy(PILOT, start, steer)


def solve_wind_triangle(
    with_it: float, across: float, cruise: float, top: float
) -> tuple[float, float]:
    """
    Return the air velocity for a straight track: along the track, and left of it. [m/s]

    `with_it`, `across`: wind along the track to the lamp, and to the left of it [m/s]. `cruise`,
    `top`: cruise and maximum airspeed [m/s].
    """
    # Cruise if that makes enough way, else as fast as the controller allows
    for speed in (cruise, max(cruise, top)):
        # Cancel the crosswind as far as the airspeed allows.
        left = min(max(-across, -speed), speed)
        along = math.sqrt(speed * speed - left * left)
        if along + with_it >= LEAST_GROUND_SHARE * cruise and left == -across:
            break
    return along, left


MOST_SEEDS: Final = 1000  # seeds per point of a plan; fixes the indices of the flights
STRATEGY_PATH: Final = 'strategy'


@final
@dataclass(frozen=True, slots=True)
class EvaluationTask:
    """One flight: its set and its job there."""

    part: str
    job: SweepJob


@final
class BatchEvaluation:
    """
    Fly tasks in batches; those of the pilot by other workers.

    `batches`: workers of the batches. `others`: workers that apply `fly_task`.
    """

    def __init__(self, batches: BatchWorkers, others: Workers[EvaluationTask, SweepRow]) -> None:
        self._batches, self._others = batches, others
        self.lost = 0

    def __enter__(self) -> Self:
        """Start the workers."""
        self._others.__enter__()
        return self

    def __exit__(self, *exception: object) -> None:
        """Stop the workers."""
        self._others.__exit__(*exception)
        self.lost = self._others.lost

    def run(
        self, items: Iterable[EvaluationTask]
    ) -> Iterator[tuple[EvaluationTask, SweepRow | ItemFailure]]:
        """Yield each task with its row, one strategy after the other, then the pilot's."""
        by_strategy: dict[str, list[EvaluationTask]] = {}
        for task in items:
            by_strategy.setdefault(str(task.job.changes[STRATEGY_PATH]), []).append(task)
        piloted = by_strategy.pop(PILOT, [])
        for tasks in by_strategy.values():
            by_job = {id(task.job): task for task in tasks}
            for job, row in self._batches.run(task.job for task in tasks):
                yield by_job[id(job)], row
        yield from self._others.run(piloted)


def build_sweep_plan(name: str, check: Callable[[SweepPlan], None] = SweepPlan.check) -> SweepPlan:
    """
    Return the checked sweep plan of a set, including the pilot's flights if it has any.

    Raise `BadInput` if the set's sweep cannot be flown.
    """
    part = find_flight_set(name)
    file = load_sweep(part.file)
    strategies = file.vary.get(STRATEGY_PATH)
    if not isinstance(strategies, list) or file.samples is not None:
        raise BadInput(
            f'The sweep file {part.file} of the set {name} must list strategies under '
            'vary and must not use samples; correct the file.'
        )
    # Check before the pilot is added, which is not a strategy that a file may name.
    check(SweepPlan(file))
    flyers = [*strategies, *([PILOT] if part.piloted else [])]
    seeds = SweepSeeds(first=file.seeds.first, count=MOST_SEEDS)
    return SweepPlan(
        file.model_copy(update={'vary': {**file.vary, STRATEGY_PATH: flyers}, 'seeds': seeds})
    )


def count_flights_per_seed(plan: SweepPlan) -> int:
    """Return the number of flights per seed."""
    return plan.count // plan.file.draws_per_point


def iterate_tasks(plans: dict[str, SweepPlan], seeds: int) -> Iterator[EvaluationTask]:
    """Yield every flight, seed by seed."""
    # Seeds are the outer loop: every set has its first seed before any has a second.
    for turn in range(seeds):
        for name, plan in plans.items():
            for point in range(count_flights_per_seed(plan)):
                yield EvaluationTask(
                    name, plan.build_job(point * plan.file.draws_per_point + turn)
                )


def build_standalone_job(plan: SweepPlan, job: SweepJob) -> SweepJob:
    """Return a self-contained job, as the workers fly jobs of all sets."""
    base = plan.base
    return replace(
        job, case={**base.names, STRATEGY_PATH: base.strategy, **base.replaced, **job.case}
    )


def fly_task(task: EvaluationTask) -> SweepRow:
    """Fly a task whose job is self-contained."""
    return fly_standalone_job(task.job)


def fly_standalone_job(job: SweepJob) -> SweepRow:
    """Fly a self-contained job."""
    return run_job(job, lambda: prepare_flight(job))


def prepare_flight(job: SweepJob) -> ClosedLoop:
    """Return the closed loop of a self-contained job before its first step."""
    changes = dict(job.changes)
    piloted = changes[STRATEGY_PATH] == PILOT
    if piloted:
        # The spec needs a real strategy; the pilot replaces it below.
        changes[STRATEGY_PATH] = job.case[STRATEGY_PATH]
    loop = build_loop(build_flight_spec(changes), job.seed)
    if piloted:
        loop.policy = replace(
            loop.policy, strategy=build_pilot_strategy(loop.world, top_airspeed(loop))
        )
    return loop


def top_airspeed(loop: ClosedLoop) -> float:
    """Return the airspeed limit of the controller. [m/s]"""
    gains = loop.policy.gains
    # Only the cascade has an airspeed limit.
    return gains.speed_limit if isinstance(gains, CascadeGains) else math.inf


def build_flight_spec(changes: dict[str, object]) -> FlightSpec:
    """Return the spec of a self-contained job."""
    vehicle, scenario, strategy, gains = (
        str(changes.pop(root)) for root in ('vehicle', 'scenario', STRATEGY_PATH, 'gains')
    )
    return load_spec(vehicle, scenario, strategy, gains).with_values(changes)


def build_sweep_plans(
    names: Sequence[str], check: Callable[[SweepPlan], None] = SweepPlan.check
) -> dict[str, SweepPlan]:
    """Return the unique plans of some sets in their order, each checked."""
    return {name: build_sweep_plan(name, check) for name in dict.fromkeys(names)}
