"""
A sweep flown as one batch: closed or open loops by the thousand, on all cores or on a GPU.

The flights are those of `lta_flight.fleet`: the same vehicle, sensors, estimator, control and
mission as one by one, with the lamp heard from geometry and noise instead of ADC blocks. They
agree with the others in distribution, not seed by seed. Flights that differ by their seed alone
are built once.
"""

from collections.abc import Iterator
from itertools import islice
import math
import time
from types import TracebackType
from typing import Any, final, Self

from lta_config.errors import BadInput
from lta_config.topics import topic_table
from lta_flight.fleet.craft import Made, made_of
from lta_flight.fleet.flight import RAN_AWAY
from lta_flight.fleet.fly import Device, fly_many
from lta_flight.fleet.text import FIGURES
from lta_flight.ingredients import Ingredients, parts_of
from lta_flight.sweep.flown import failed, Row
from lta_flight.sweep.plan import Job, si_of
from lta_model.stiffness import ran_away
from lta_report.json_value import finite
from lta_sim.kernels.gpu import cuda_here
from lta_sim.readings import Outcome
import numpy as np

# Flights kept together as they end: more fill a GPU, fewer are lost with a batch.
BATCH: dict[str, int] = {'cpu-batch': 512, 'gpu': 65_536}
OUTCOMES = tuple(Outcome)


@final
class FleetCrew:
    """
    Fly jobs in batches.

    Parameters
    ----------
    base : Ingredients
        What all flights have in common.
    device : str
        'cpu-batch' or 'gpu'.
    duties : tuple of float
        Of each rotor in an open loop; empty where the drone decides.

    Raises
    ------
    BadInput
        If the base is nothing that a batch can fly, or there is no GPU.

    """

    def __init__(self, base: Ingredients, device: Device, duties: tuple[float, ...] = ()) -> None:
        self._base, self._device, self._duties = base, device, duties
        self._table = topic_table()
        self.deaths = 0
        vehicle, *_ = parts_of(base)
        if duties and len(duties) != len(vehicle.rotors):
            raise BadInput(
                f'{len(duties)} duties are given, but {vehicle.file.name} has '
                f'{len(vehicle.rotors)} rotors; give one for each.'
            )
        if device == 'gpu':
            cuda_here()
        self._make({})

    def __enter__(self) -> Self:
        """Be ready."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nobody behind: there is nobody."""

    def fly(self, jobs: Iterator[Job]) -> Iterator[Row]:
        """Yield the rows of all jobs, batch by batch."""
        while batch := list(islice(jobs, BATCH[self._device])):
            yield from self._batch(batch)

    def _make(self, values: dict[str, Any]) -> Made:
        parts = parts_of(self._base.with_values(values))
        return made_of(*parts, self._table, self._duties)

    def _batch(self, jobs: list[Job]) -> Iterator[Row]:
        """Yield the rows of one batch; what cannot be built is a failed flight."""
        begun = time.monotonic()
        places: dict[str, int | str] = {}
        made: list[Made] = []
        which, seeds, flyable = [], [], []
        for job in jobs:
            name = repr(job.changes)
            if name not in places:
                try:
                    made.append(self._make(job.changes))
                    places[name] = len(made) - 1
                except BadInput as error:
                    places[name] = str(error)
            place = places[name]
            if isinstance(place, str):
                yield failed(job, place)
                continue
            which.append(place)
            seeds.append(job.seed)
            flyable.append(job)
        if not flyable:
            return
        flown = fly_many(made, seeds, self._device, closed=not self._duties, which=np.array(which))
        wall = (time.monotonic() - begun) / len(jobs)
        for job, place, numbers in zip(flyable, which, flown.tolist(), strict=True):
            yield row_of(job, made[place], dict(zip(FIGURES, numbers, strict=True)), wall)


def row_of(job: Job, made: Made, told: dict[str, float], wall: float) -> Row:
    """Return the row of a flight from what it came to; a failed one if its numbers ran away."""
    if int(told['outcome']) == RAN_AWAY:
        return failed(job, str(ran_away(made.name, told['end'])))
    outcome = OUTCOMES[int(told['outcome'])]
    values = {path: si_of(value) for path, value in job.values.items()}
    return Row(
        job.index, job.seed, values, outcome.name.lower(), str(outcome), wall,
        figures_of(made, told, success=outcome is Outcome.REACHED),
    )  # fmt: skip


def figures_of(made: Made, told: dict[str, float], *, success: bool) -> dict[str, Any]:
    """Return what a batch knows of `Results`, None where it does not or nothing happened."""
    goal, (x, y, _) = made.craft.goal, made.craft.place
    end = told['end'] if success else math.nan
    aloft = told['end'] - told['lift_off']
    numbers = {
        **{name: told[name] for name in ('lift_off', 'search_start', 'end')},
        'flight_time': end - told['lift_off'],
        'search_time': end - told['search_start'],
        'path_length': told['path_length'],
        'straight_length': math.hypot(goal.x - x, goal.y - y) - goal.radius,
        'closest': told['closest'],
        'lamp_error': ratio(told['squares'], told['bearings']) ** 0.5,
        'lamp_share': ratio(told['bearings'], told['blocks']),
        'energy': told['energy'] if aloft > 0.0 else math.nan,
        'power': ratio(told['energy'], aloft),
    }
    return {'success': success, **finite(numbers)}


def ratio(a: float, b: float) -> float:
    """Return a / b, NaN where b is not above 0."""
    return a / b if b > 0.0 else math.nan
