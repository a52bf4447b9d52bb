"""Fly one job of a sweep and return its row; errors are stored in the row."""

from collections.abc import Callable
from dataclasses import dataclass, field
from operator import attrgetter
import time
from typing import Any, Final, final

from lta_config.compilation.flat import Array
from lta_config.errors import BadInput
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_loop, FlightSpec
from lta_flight.loop_view import LoopView
from lta_flight.report.results import compute_results
from lta_flight.sweep.plan import convert_to_si, SweepJob
from lta_report.json_value import replace_nonfinite
from lta_report.study_store import StoreFormat, StudyStore
from lta_report.workers import ItemFailure
import numpy as np
from pydantic import TypeAdapter

FAILED = 'failed'
TRACK_PERIOD = 0.5  # s between two poses of a track, enough for a slow blimp


@final
@dataclass(frozen=True, slots=True)
class SweepRow:
    """The stored result of a flight."""

    # Position in the sweep, and seed
    index: int
    seed: int
    values: dict[str, Any]  # varied parameters by path, in SI
    outcome: str  # 'reached', 'timeout', 'escaped', or 'failed' if it could not be flown
    sentence: str  # the outcome in words, or the reason of a failure
    wall: float = 0.0  # computing time [s]
    # `FlightResults` by name; None if unknown
    figures: dict[str, Any] = field(default_factory=dict)
    # Time [s], position [m, map] and attitude x y z w; empty unless the 3-D view shows the flight
    track: list[list[float]] = field(default_factory=list)


# Each line is a row; the row of a failed flight has its values too
SWEEP_STORE: Final[StoreFormat[SweepRow]] = StoreFormat(
    'flights.jsonl',
    'sweep',
    'sweep',
    TypeAdapter(SweepRow),
    find_key=attrgetter('index'),
    is_failed=lambda row: row.outcome == FAILED,
)


def build_failed_row(job: SweepJob, sentence: str, wall: float = 0.0) -> SweepRow:
    """Return the row of a flight that could not be flown."""
    values = {path: convert_to_si(value) for path, value in job.values.items()}
    return SweepRow(job.index, job.seed, values, FAILED, sentence, wall)


def store_row(store: StudyStore[SweepRow], job: SweepJob, outcome: SweepRow | ItemFailure) -> str:
    """Store the row of a job and return its outcome."""
    row = build_failed_row(job, outcome.reason) if isinstance(outcome, ItemFailure) else outcome
    store.add(row.index, row)
    return row.outcome


def fly_job(base: FlightSpec, job: SweepJob) -> SweepRow:
    """Fly one job to its end; see `run_job`."""
    return run_job(job, lambda: build_loop(base.with_values(job.changes), job.seed))


def run_job(job: SweepJob, begin: Callable[[], ClosedLoop]) -> SweepRow:
    """Fly a loop; an error of any kind gives a failed flight and does not stop the sweep."""
    begun = time.monotonic()
    try:
        # Built inside the try, because an invalid combination of values fails here
        loop = begin()
        view = LoopView(loop)
        for _ in loop.iterate_steps():
            view.record_step()
        figures = compute_results(view).to_dict()
    except BadInput as error:
        return build_failed_row(job, str(error), time.monotonic() - begun)
    except Exception as error:  # one flight must not end the others
        reason = f'The simulation failed: {type(error).__name__}: {error}'
        return build_failed_row(job, reason, time.monotonic() - begun)
    outcome = loop.world.outcome
    return SweepRow(
        job.index,
        job.seed,
        {path: convert_to_si(value) for path, value in job.values.items()},
        outcome.name.lower(),
        str(outcome),
        time.monotonic() - begun,
        # JSON has no NaN
        replace_nonfinite(figures),
        thin_track(view.true_poses) if job.tracked else [],
    )


def thin_track(poses: Array) -> list[list[float]]:
    """Return rows of times and poses about `TRACK_PERIOD` apart, and the last."""
    stretches = np.floor(poses[:, 0] / TRACK_PERIOD)
    # The first row of each stretch of time
    index = np.append(np.unique(stretches, return_index=True)[1], len(poses) - 1)
    rows: list[list[float]] = poses[index].round(3).tolist()
    return rows
