"""Compare old and new gains on the same random draws of helium loss and seed."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_control.cascade import CascadeGains
from lta_flight.sweep.statistics import ShareInterval, wilson_interval
from lta_report.workers import Workers
from lta_studies.tune.evaluation import evaluate_jobs, EvaluationJob, refuse_failure
from lta_studies.tune.metrics import ResponseMetrics
from lta_studies.tune.step_response import SetpointStep, STEPS, TuningCase, TuningScene
import numpy as np
from scipy.special import stdtrit

FRESH = 1000  # first seed of the comparison; the search uses smaller ones


@final
@dataclass(frozen=True, slots=True)
class QuartileSpread:
    """A median with its lower and upper quartile, in the unit of the values."""

    median: float
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True)
class CostDifference:
    """Mean of the cost difference new - old over paired draws, with its 95 % interval."""

    mean: float
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


def compare_costs(old: GainEvaluation, new: GainEvaluation) -> CostDifference:
    """Return the mean paired cost difference with Student's 95 % interval."""
    pairs = zip(old.reports, new.reports, strict=True)
    # Both sides flew the same draws; the pairing removes the variance between draws.
    gaps = np.array([b.cost - a.cost for a, b in pairs])
    count = len(gaps)
    # One draw gives no spread, hence an infinite interval.
    half = math.inf
    if count > 1:
        quantile = float(stdtrit(count - 1, 0.975))
        half = quantile * float(gaps.std(ddof=1)) / math.sqrt(count)
    mean = float(gaps.mean())
    return CostDifference(mean, mean - half, mean + half)


def draw_cases(least: float, most: float, count: int, seed: int) -> list[TuningCase]:
    """Draw cases with uniform losses [kg] and seeds that the search did not use."""
    chance = np.random.default_rng(seed)
    losses = chance.uniform(least, most, count).tolist()
    return [TuningCase(loss, FRESH + k) for k, loss in enumerate(losses)]


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


NAMES = tuple(format_step(step) for step in STEPS)
