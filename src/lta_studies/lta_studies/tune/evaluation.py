"""Fly the test flights of gains by workers, and store their costs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import hashlib
import json
import math
from operator import attrgetter
from typing import Any, Final, final, NamedTuple, TypeVar

from lta_config.errors import BadInput
from lta_control.cascade import CascadeGains, Setpoint
from lta_report.line_log import LogKind
from lta_report.study_store import StoreFormat
from lta_report.workers import ItemFailure, Workers
from lta_studies.tune.lamp_flight import fly_to_lamp
from lta_studies.tune.linearization import linearize_loop
from lta_studies.tune.loop_cut import LoopCut
from lta_studies.tune.metrics import compute_response_metrics, LOST, ResponseMetrics, StepMetrics
from lta_studies.tune.stability_margins import ALTITUDE, CRUISE
from lta_studies.tune.step_response import fly_steps, STEPS, TuningCase, TuningScene
from pydantic import TypeAdapter

Result = TypeVar('Result')
CRUISING = Setpoint(ALTITUDE, 0.0, CRUISE)
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
STORE: Final = StoreFormat(
    LogKind('search.jsonl', 'tune', 'search', '--out'),
    TypeAdapter(CandidateCosts),
    find_key=attrgetter('numbers'),
)


def hash_search(content: Any) -> str:  # noqa: ANN401 - what JSON holds
    """Return a hash that identifies a search by its inputs."""
    # Sorted keys: the hash must not depend on the order in which the inputs were built.
    text = json.dumps(content, sort_keys=True)
    # 64 bits are enough to tell the searches of one folder apart.
    return hashlib.sha256(text.encode()).hexdigest()[:16]
