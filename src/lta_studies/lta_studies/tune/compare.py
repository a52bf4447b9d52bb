# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Rate flights by a cost, and compare old and new gains on the same draws of loss and seed.

The cost of a step of size h that lasts T is

    (1 / (h T)) integral |r - y| dt  +  OVERSHOOT_WEIGHT o / h  +  steady error / h

with the setpoint r, the true value y and the overshoot o. The total is the mean over the steps
plus terms for the altitude error during the other steps, the swing of the hull at the end, an
unstable swing in cruise, the duration of the mission (plus `MISSED_GOAL_COST` if it misses its
goal), and the activity of the rotors. A flight that loses its altitude costs `LOST_ALTITUDE_COST`
more, which outweighs all other terms.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from operator import attrgetter
from typing import Final, final, NamedTuple, TypeVar

from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_control.laws.cascade import CascadeGains
from lta_control.motion import Setpoint
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_flight.sweep.statistics import (
    MeanInterval,
    ShareInterval,
    student_interval,
    wilson_interval,
)
from lta_report.study_store import StoreFormat
from lta_report.workers import ItemFailure, Workers
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
from lta_studies.tune.loop_cut import linearize_loop, LoopCut
from lta_studies.tune.margins import STEADY_ALTITUDE, TUNING_CRUISE_SPEED
from lta_studies.tune.step_response import (
    Array,
    fly_steps,
    SETPOINT_STEPS,
    SetpointStep,
    StepResponse,
    TuningCase,
    TuningScene,
)
import numpy as np
from pydantic import TypeAdapter

TUNING_STRATEGY = 'bag'


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
        FlightStack(find_navigation_strategy(TUNING_STRATEGY), gains),
        scene.nominal_vehicle,
    )
    while world.outcome is FlightOutcome.FLYING:
        loop.step()
    return LampFlightResult(
        # A share of the limit, so that costs of different scenes compare.
        world.outcome is FlightOutcome.REACHED,
        world.elapsed / scenario.goal.time_limit.si,
    )


SETTLED_SHARE: Final = 0.1  # share of a step within which it counts as settled
TAIL_SHARE: Final = 0.25  # last share of a step, over which the steady error is taken
OVERSHOOT_WEIGHT: Final = 0.5  # weight in the cost of a step
GROWTH_COST_TIME: Final = 10.0  # s; a swing that grows by 1 % per second costs 0.1
MISSION_COST: Final = 0.5  # cost of a mission that uses the whole time limit
MISSED_GOAL_COST: Final = 2.0  # cost of a mission that misses its goal
EFFORT_COST_TIME: Final = 0.1  # s; cost of a mean duty change of 1 per second and rotor
ALTITUDE_SCALE: Final = 0.4  # m of rms altitude error that cost 1
SWING_SCALE: Final = 0.2  # rad of swing that cost 1
SWING_TIME: Final = 6.0  # s at the end of the flight over which the swing is taken
LARGEST_ALTITUDE_ERROR: Final = 0.3  # m; a larger altitude error at the end counts as lost
LOST_ALTITUDE_COST: Final = 10.0


@final
@dataclass(frozen=True, slots=True)
class StepMetrics:
    """Metrics of one step."""

    settle: float  # settling time to within 10 % of the step; infinite if it never settles [s]
    # Overshoot, rms error over the last quarter, and mean absolute error, relative to the step [1]
    overshoot: float
    steady: float
    error: float

    @property
    def cost(self) -> float:
        """Cost of the step."""
        return self.error + OVERSHOOT_WEIGHT * self.overshoot + self.steady


@final
@dataclass(frozen=True, slots=True)
class ResponseMetrics:
    """Metrics of one test flight."""

    marks: tuple[StepMetrics, ...]  # metrics of each step
    altitude: float  # rms altitude error during the other steps [m]
    swing: float  # standard deviation of the tilt over the last seconds [rad]
    effort: float  # mean change of a rotor's duty per second [1/s]
    lost: bool  # whether the altitude was lost or the motors stopped
    adrift: float  # largest altitude error at the end of a step [m]
    # Growth rate of the least damped mode in cruise, from the linear loop; 0 if not computed [1/s]
    growth: float = 0.0
    reached: bool = True  # whether the mission reached its goal
    search: float = 0.0  # duration of the mission as a share of its time limit [1]

    @property
    def cost(self) -> float:
        """Total cost of the flight; lower is better."""
        mean = sum(mark.cost for mark in self.marks) / len(self.marks)
        # The altitude error, capped, ranks lost flights, so that a search can improve on them.
        missing = LOST_ALTITUDE_COST + min(self.adrift, LOST_ALTITUDE_COST) if self.lost else 0.0
        rest = (
            self.altitude / ALTITUDE_SCALE
            + self.swing / SWING_SCALE
            + EFFORT_COST_TIME * self.effort
        )
        rest += GROWTH_COST_TIME * max(0.0, self.growth)
        rest += MISSION_COST * self.search + (0.0 if self.reached else MISSED_GOAL_COST)
        return mean + rest + missing


def compute_step_metrics(time: Array, value: Array, step: SetpointStep) -> StepMetrics:
    """Compute the metrics of a step from the true values of its channel over time [s]."""
    size = abs(step.after - step.before)
    off = (value - step.after) / (step.after - step.before)  # negative on the way, 0 there
    outside = np.flatnonzero(np.abs(off) > SETTLED_SHARE)
    settle = 0.0
    if len(outside):
        last = int(outside[-1])
        # Outside the band at the last sample: the step never settled.
        settle = math.inf if last == len(time) - 1 else float(time[last + 1] - step.start)
    tail = off[-max(1, int(TAIL_SHARE * len(off))) :]
    assert size > 0.0
    return StepMetrics(
        settle,
        max(0.0, float(off.max())),
        float(np.sqrt(np.mean(tail**2))),
        float(np.mean(np.abs(off))),
    )


def compute_response_metrics(
    trace: StepResponse, steps: Sequence[SetpointStep] = SETPOINT_STEPS
) -> ResponseMetrics:
    """Compute the metrics of a test flight."""
    marks, others, ends = [], [], []
    altitude = steps[0].before
    for step in steps:
        during = (trace.time >= step.start) & (trace.time < step.end)
        marks.append(
            compute_step_metrics(
                trace.time[during], trace.select_channel(step.channel)[during], step
            )
        )
        if step.channel == 'altitude':
            altitude = step.after
        else:
            others.append(trace.altitude[during] - altitude)
        # The mean over 2 s averages out a swing around the setpoint.
        last = trace.altitude[during & (trace.time >= step.end - 2.0)]
        ends.append(abs(float(last.mean()) - altitude))
    # Rms altitude error while another channel steps
    held = math.sqrt(float(np.mean(np.concatenate(others) ** 2))) if others else 0.0
    flying = trace.time >= steps[0].start
    adrift = max(ends)
    # The standard deviation ignores a constant lean.
    swing = float(trace.tilt[trace.time >= steps[-1].end - SWING_TIME].std())
    lost = trace.stopped or not adrift <= LARGEST_ALTITUDE_ERROR  # NaN counts as lost
    return ResponseMetrics(
        tuple(marks), held, swing, float(trace.work[flying].mean()), lost, adrift
    )


Result = TypeVar('Result')
CRUISE_SETPOINT = Setpoint(STEADY_ALTITUDE, 0.0, TUNING_CRUISE_SPEED)
WORST = StepMetrics(math.inf, 1.0, 1.0, 1.0)
DIVERGED_METRICS = ResponseMetrics(
    (WORST,) * len(SETPOINT_STEPS), 1.0, 1.0, 0.0, True, LOST_ALTITUDE_COST
)  # metrics of a flight whose simulation diverged


class EvaluationJob(NamedTuple):
    """One test flight to fly."""

    scene: TuningScene
    gains: CascadeGains
    case: TuningCase


def evaluate_gains(task: EvaluationJob) -> ResponseMetrics:
    """Fly one step test and one mission, and add the growth rate of the linear loop."""
    scene, gains, case = task
    try:
        report = compute_response_metrics(fly_steps(scene, gains, case))
        # A slow instability may not show in one minute of flight, but its eigenvalue does.
        linear = linearize_loop(
            LoopCut(scene.build_true_vehicle(case.loss), scene.nominal_vehicle, gains),
            CRUISE_SETPOINT,
        )
        sought = fly_to_lamp(scene, gains, case)
        return replace(
            report, growth=linear.growth_rate, reached=sought.reached, search=sought.time
        )
    # An invalid input must stop the search; only a diverged simulation counts as a cost.
    except BadInput:
        raise
    except (ValueError, ArithmeticError):
        return DIVERGED_METRICS


def evaluate_jobs(
    jobs: Sequence[EvaluationJob], workers: Workers[EvaluationJob, ResponseMetrics]
) -> list[ResponseMetrics] | ItemFailure:
    """Return the metrics in the order of the jobs, or the first failure of a flight."""
    metrics: dict[int, ResponseMetrics] = {}
    for job, outcome in workers.run(jobs):
        if isinstance(outcome, ItemFailure):
            return outcome
        # Jobs come back as the same objects.
        metrics[id(job)] = outcome
    return [metrics[id(job)] for job in jobs]


def refuse_failure(outcome: Result | ItemFailure) -> Result:
    """Return an outcome; raise `BadInput` if it is a failure."""
    if isinstance(outcome, ItemFailure):
        raise BadInput(
            f'A test flight failed. {outcome.reason} Finished candidates are stored; run the same '
            'command again with --retry-failed to continue.'
        )
    return outcome


@final
@dataclass(frozen=True, slots=True)
class CandidateCosts:
    """The parameter values of one candidate and its cost in each case."""

    numbers: tuple[float, ...]
    costs: list[float]


# Exact floats as keys are right: JSON restores them, and the same seed draws the same candidates.
SEARCH_STORE: Final = StoreFormat(
    'search.jsonl',
    'tune',
    'search',
    TypeAdapter(CandidateCosts),
    find_key=attrgetter('numbers'),
)


FIRST_COMPARISON_SEED = 1000  # first seed of the comparison; the search uses smaller ones


@final
@dataclass(frozen=True, slots=True)
class QuartileSpread:
    """A median with its lower and upper quartile, in the unit of the values."""

    median: float
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True)
class GainEvaluation:
    """Test flights of one set of gains."""

    losses: tuple[float, ...]  # lift lost in each flight [kg]
    reports: tuple[ResponseMetrics, ...]  # metrics of each flight

    @property
    def lost_share(self) -> ShareInterval:
        """Share of flights that lost their altitude, with its 95 % interval."""
        return wilson_interval(sum(report.lost for report in self.reports), len(self.reports))

    @property
    def reached_share(self) -> ShareInterval:
        """Share of missions that reached the goal, with its 95 % interval."""
        return wilson_interval(sum(report.reached for report in self.reports), len(self.reports))

    def settling_share(self, step: int) -> ShareInterval:
        """Return the share of flights in which a step settled, with its 95 % interval."""
        # A step that never settles has an infinite time.
        times = [report.marks[step].settle for report in self.reports if report.marks]
        return wilson_interval(sum(map(math.isfinite, times)), len(self.reports))

    def summarize_step(self, step: int, figure: str) -> QuartileSpread:
        """Return the quartiles of one metric of a step."""
        return compute_quartiles(
            [getattr(report.marks[step], figure) for report in self.reports if report.marks]
        )

    def compute_metric_quartiles(self, figure: str) -> QuartileSpread:
        """Return the quartiles of one metric of the whole flight."""
        return compute_quartiles([getattr(report, figure) for report in self.reports])


def compute_quartiles(values: Sequence[float]) -> QuartileSpread:
    """Return the median and quartiles; infinite values (never settled) stay infinite."""
    ordered = np.sort(np.array(values, dtype=np.float64))
    if not len(ordered):
        return QuartileSpread(math.nan, math.nan, math.nan)
    places = (0.5, 0.25, 0.75)
    # Nearest rank: interpolation between a number and infinity would be infinite.
    middle, low, high = (float(ordered[round(p * (len(ordered) - 1))]) for p in places)
    return QuartileSpread(middle, low, high)


def compare_costs(old: GainEvaluation, new: GainEvaluation) -> MeanInterval:
    """Return the mean of the cost difference new - old over paired draws, with its interval."""
    pairs = zip(old.reports, new.reports, strict=True)
    # Both sides flew the same draws; the pairing removes the variance between draws.
    return student_interval([b.cost - a.cost for a, b in pairs])


def draw_cases(least: float, most: float, count: int, seed: int) -> list[TuningCase]:
    """Draw cases with uniform losses [kg] and seeds that the search did not use."""
    chance = np.random.default_rng(seed)
    losses = chance.uniform(least, most, count).tolist()
    return [TuningCase(loss, FIRST_COMPARISON_SEED + k) for k, loss in enumerate(losses)]


def fly_comparison(
    scene: TuningScene,
    both: tuple[CascadeGains, CascadeGains],
    cases: Sequence[TuningCase],
    workers: Workers[EvaluationJob, ResponseMetrics],
) -> tuple[GainEvaluation, GainEvaluation]:
    """Fly the old and the new gains in the same cases."""
    # One task list for both sides, so that no worker waits between them.
    tasks = [EvaluationJob(scene, gains, case) for gains in both for case in cases]
    reports = refuse_failure(evaluate_jobs(tasks, workers))
    losses = tuple(case.loss for case in cases)
    count = len(cases)
    return GainEvaluation(losses, tuple(reports[:count])), GainEvaluation(
        losses, tuple(reports[count:])
    )


def format_step(step: SetpointStep) -> str:
    """Return the label of a step, for example 'altitude +0.4 m'."""
    change = step.after - step.before
    if step.channel in ('heading', 'course'):
        return f'{step.channel} {math.degrees(change):+.0f} deg'
    return f'{step.channel} {change:+.1f} {"m" if step.channel == "altitude" else "m/s"}'


STEP_NAMES = tuple(format_step(step) for step in SETPOINT_STEPS)
