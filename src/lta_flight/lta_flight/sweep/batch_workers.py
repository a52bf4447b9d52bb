"""
Fly a sweep as batches of closed or open loops, on all CPU cores or on a GPU.

Batch flights use the same vehicle, sensors, estimator, control and mission as single ones, but
sample the lamp's signal without ADC blocks (`lta_flight.batch`). They agree in distribution, not
seed by seed. Flights that differ only in their seed are built once.
"""

from collections.abc import Iterable, Iterator
from itertools import islice
import math
import time
from typing import Any, final, Self

from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_flight.batch.batch_flight import BatchFlight, build_flight
from lta_flight.batch.flight import RAN_AWAY
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.fly import Device, fly_many
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec
from lta_flight.report.goal import shortest_path_length
from lta_flight.sweep.job_runner import build_failed_row, SweepRow
from lta_flight.sweep.plan import convert_to_si, SweepJob, SweepPlan
from lta_model.model import build_divergence_error
from lta_report.json_value import replace_nonfinite
from lta_sim.kernels.thread import require_cuda
from lta_sim.readings import FlightOutcome
from lta_sim.termination import OUTCOMES
import numpy as np
from numpy.typing import NDArray

# Flights per batch: more use a GPU better, fewer are lost when a sweep is interrupted
BATCH: dict[str, int] = {'cpu-batch': 512, 'gpu': 65_536}


@final
class BatchWorkers:
    """
    Fly jobs in batches.

    `base`: what all flights have in common. `device`: 'cpu-batch' or 'gpu'. `duties`: constant
    duties of the rotors for an open loop; empty for a closed one. Raise `BadInput` if a batch does
    not support the base, or there is no GPU.
    """

    def __init__(self, base: FlightSpec, device: Device, duties: tuple[float, ...] = ()) -> None:
        self._base, self._device, self._duties = base, device, duties
        self._table = load_topic_table()
        # Effects that some flight has, so that one kernel of each strategy serves all batches
        self._on: NDArray[np.uint8] | None = None
        self.lost = 0
        vehicle, *_ = build_vehicle_scenario_stack(base)
        if duties and len(duties) != len(vehicle.rotors):
            raise BadInput(
                f'{len(duties)} duties are given, but {vehicle.file.name} has '
                f'{len(vehicle.rotors)} rotors; give one duty per rotor with --duties.'
            )
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
        flight = build_flight(*build_vehicle_scenario_stack(spec), self._table, self._duties)
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
        results = fly_many(
            flights, seeds, self._device, closed=not self._duties, which=np.array(which),
            on=self._on,
        )  # fmt: skip
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
