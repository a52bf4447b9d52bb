# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly a sweep as batches, on all CPU cores or on a GPU.

Batch flights use the same vehicle, sensors, estimator, control and mission as single ones, but
sample the lamp's signal without ADC blocks (`lta_flight.batch`). They agree in distribution, not
seed by seed. Flights that differ only in their seed are built once.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
import math
from operator import attrgetter
import time
from typing import Any, Final, final, Self

from lta_config.compilation.flat import Array
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_flight.batch.batch_flight import BatchFlight, build_flight
from lta_flight.batch.flight import RAN_AWAY
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.fly import Device, fly_many
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_loop, build_vehicle_scenario_stack, FlightSpec
from lta_flight.loop_view import LoopView
from lta_flight.report.goal import shortest_path_length
from lta_flight.report.results import compute_results
from lta_flight.sweep.plan import convert_to_si, SweepJob, SweepPlan
from lta_model.model import build_divergence_error
from lta_report.json_value import replace_nonfinite
from lta_report.study_store import StoreFormat, StudyStore
from lta_report.workers import ItemFailure
from lta_sim.kernels.thread import require_cuda
from lta_sim.readings import FlightOutcome
from lta_sim.termination import OUTCOMES
import numpy as np
from numpy.typing import NDArray
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


# Flights per batch: more use a GPU better, fewer are lost when a sweep is interrupted
BATCH: dict[str, int] = {'cpu-batch': 512, 'gpu': 65_536}


@final
class BatchWorkers:
    """
    Fly jobs in batches.

    `base`: what all flights have in common. `device`: 'cpu-batch' or 'gpu'. Raise `BadInput` if
    there is no GPU.
    """

    def __init__(self, base: FlightSpec, device: Device) -> None:
        self._base, self._device = base, device
        self._table = load_topic_table()
        # Effects that some flight has, so that one kernel of each strategy serves all batches
        self._on: NDArray[np.uint8] | None = None
        self.lost = 0
        if device == 'gpu':
            require_cuda()

    def check(self, plan: SweepPlan) -> None:
        """Raise `BadInput` if a value of the sweep needs what a batch does not support."""
        plan.check(lambda spec, _: self._build_flight(spec))

    def __enter__(self) -> Self:
        """Return this object."""
        return self

    def __exit__(self, *_: object) -> None:
        """Do nothing; there are no processes to stop."""

    def run(self, items: Iterable[SweepJob]) -> Iterator[tuple[SweepJob, SweepRow]]:
        """Yield all jobs with their rows, batch by batch."""
        jobs = iter(items)
        while batch := list(islice(jobs, BATCH[self._device])):
            yield from self._fly_batch(batch)

    def _build_flight(self, spec: FlightSpec) -> BatchFlight:
        flight = build_flight(*build_vehicle_scenario_stack(spec), self._table)
        on = flight.model.on
        self._on = on if self._on is None else np.maximum(self._on, on)
        return flight

    def _fly_batch(self, jobs: list[SweepJob]) -> Iterator[tuple[SweepJob, SweepRow]]:
        """Yield the jobs of one batch with their rows; those that cannot be built have failed."""
        begun = time.monotonic()
        places: dict[str, int | str] = {}
        flights: list[BatchFlight] = []
        which, seeds, flyable = [], [], []
        for job in jobs:
            # Jobs that differ only in their seed have equal changes
            name = repr(job.changes)
            if name not in places:
                try:
                    flights.append(self._build_flight(self._base.with_values(job.changes)))
                    places[name] = len(flights) - 1
                except BadInput as error:
                    places[name] = str(error)
            place = places[name]
            # The stored reason why this kind of flight cannot be built
            if isinstance(place, str):
                yield job, build_failed_row(job, place)
                continue
            which.append(place)
            seeds.append(job.seed)
            flyable.append(job)
        if not flyable:
            return
        results = fly_many(flights, seeds, self._device, which=np.array(which), on=self._on)
        # All flights run at once, so each gets an equal share of the time
        wall = (time.monotonic() - begun) / len(jobs)
        for job, place, numbers in zip(flyable, which, results.tolist(), strict=True):
            outputs = dict(zip(FIGURES, numbers, strict=True))
            yield job, build_sweep_row(job, flights[place], outputs, wall)


def build_sweep_row(
    job: SweepJob, flight: BatchFlight, outputs: dict[str, float], wall: float
) -> SweepRow:
    """Return the row of a flight from its outputs; a failed one if the integration diverged."""
    if int(outputs['outcome']) == RAN_AWAY:
        return build_failed_row(job, str(build_divergence_error(flight.name, outputs['end'])))
    outcome = OUTCOMES[int(outputs['outcome'])]
    values = {path: convert_to_si(value) for path, value in job.values.items()}
    return SweepRow(
        job.index, job.seed, values, outcome.name.lower(), str(outcome), wall,
        compute_figures(flight, outputs, success=outcome is FlightOutcome.REACHED),
    )  # fmt: skip


def compute_figures(
    flight: BatchFlight, outputs: dict[str, float], *, success: bool
) -> dict[str, Any]:
    """Return the `FlightResults` that a batch computes; None for NaN."""
    goal, (x, y, _) = flight.craft.goal, flight.craft.place
    # Times to the goal exist only for successful flights
    end = outputs['end'] if success else math.nan
    aloft = outputs['end'] - outputs['lift_off']
    numbers = {
        **{name: outputs[name] for name in ('lift_off', 'search_start', 'end')},
        'flight_time': end - outputs['lift_off'],
        'search_time': end - outputs['search_start'],
        'path_length': outputs['path_length'],
        'straight_length': shortest_path_length(
            (x, y), [stop[:2] for stop in goal.stops], goal.radius
        ),
        'closest_horizontal': outputs['closest'],
        'lamp_error': divide_or_nan(outputs['squares'], outputs['bearings']) ** 0.5,
        'lamp_share': divide_or_nan(outputs['bearings'], outputs['blocks']),
        'energy': outputs['energy'] if aloft > 0.0 else math.nan,
        'power': divide_or_nan(outputs['energy'], aloft),
    }
    return {'success': success, **replace_nonfinite(numbers)}


def divide_or_nan(a: float, b: float) -> float:
    """Return a / b; NaN unless b is positive."""
    return a / b if b > 0.0 else math.nan
