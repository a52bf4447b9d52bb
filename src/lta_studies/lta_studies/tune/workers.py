"""Fly test flights in parallel worker processes."""

from collections.abc import Sequence
from dataclasses import replace
import math
from operator import itemgetter
from typing import NamedTuple

from lta_config.errors import BadInput
from lta_control.cascade import CascadeGains, Setpoint
from lta_report.worker_pool import WorkerPool
from lta_studies.tune.lamp_flight import fly_to_lamp
from lta_studies.tune.linearization import linearize_loop
from lta_studies.tune.loop_cut import LoopCut
from lta_studies.tune.metrics import compute_response_metrics, LOST, ResponseMetrics, StepMetrics
from lta_studies.tune.stability_margins import ALTITUDE, CRUISE
from lta_studies.tune.step_response import fly_steps, STEPS, TuningCase, TuningScene

CRUISING = Setpoint(ALTITUDE, 0.0, CRUISE)
PLACE = itemgetter(0)
WORST = StepMetrics(math.inf, 1.0, 1.0, 1.0)
BROKEN = ResponseMetrics(
    (WORST,) * len(STEPS), 1.0, 1.0, 0.0, True, LOST
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
            LoopCut(scene.build_true_vehicle(case.loss), scene.nominal_vehicle, gains), CRUISING
        )
        sought = fly_to_lamp(scene, gains, case)
        return replace(
            report, growth=linear.growth_rate, reached=sought.reached, search=sought.time
        )
    # An invalid input must stop the search; only a diverged simulation counts as a cost.
    except BadInput:
        raise
    except (ValueError, ArithmeticError):
        return BROKEN


def create_workers(size: int) -> WorkerPool:
    """Create the worker processes."""
    return WorkerPool(size, '--workers', goes_on=True)


def evaluate_jobs(tasks: Sequence[EvaluationJob], by: WorkerPool) -> list[ResponseMetrics]:
    """Return the metrics in the order of the tasks."""
    return [
        report
        for _, report in sorted(
            by.map_unordered(_evaluate_with_index, list(enumerate(tasks))), key=PLACE
        )
    ]


# At module level because worker processes must be able to pickle it.
def _evaluate_with_index(place: int, task: EvaluationJob) -> tuple[int, ResponseMetrics]:
    """Fly one test flight and return its index with the metrics."""
    return place, evaluate_gains(task)
