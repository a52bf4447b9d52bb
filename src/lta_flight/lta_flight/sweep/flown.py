"""One flight of a sweep, from its job to its row; whatever goes wrong is in the row."""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
import time
from typing import Any, final

from lta_config.errors import BadInput
from lta_flight.ingredients import Ingredients, loop_of
from lta_flight.loop import Loop
from lta_flight.loop_view import LoopView
from lta_flight.report.results import results_of
from lta_flight.sweep.plan import Job, si_of
from lta_report.json_value import finite

FAILED = 'failed'


@final
@dataclass(frozen=True, slots=True)
class Row:
    """
    What is kept of a flight.

    Attributes
    ----------
    index, seed : int
        Its place in the sweep, and its seed.
    values : dict
        What was varied, by path, in SI.
    outcome : str
        'reached', 'timeout', 'escaped', or 'failed' where it could not be flown.
    sentence : str
        The same in words, or why not.
    wall : float
        Time that it took. [s]
    figures : dict
        `Results` by name; None is what the flight does not tell.

    """

    index: int
    seed: int
    values: dict[str, Any]
    outcome: str
    sentence: str
    wall: float = 0.0
    figures: dict[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the row ready for JSON."""
        # Not `asdict`: its deep copy takes as long as a short flight in a batch.
        return {item.name: getattr(self, item.name) for item in fields(self)}


def failed(job: Job, sentence: str, wall: float = 0.0) -> Row:
    """Return the row of a flight that could not be flown."""
    values = {path: si_of(value) for path, value in job.values.items()}
    return Row(job.index, job.seed, values, FAILED, sentence, wall)


def fly_job(base: Ingredients, job: Job) -> Row:
    """Fly one flight to its end; see `flown`."""
    return flown(job, lambda: loop_of(base.with_values(job.changes), job.seed))


def flown(job: Job, begin: Callable[[], Loop]) -> Row:
    """Fly what begins; an error of any kind is a failed flight, not the end of all others."""
    begun = time.monotonic()
    try:
        loop = begin()
        view = LoopView(loop)
        for _ in loop.flight():
            view.take()
        figures = results_of(view).to_dict()
    except BadInput as error:
        return failed(job, str(error), time.monotonic() - begun)
    except Exception as error:  # one flight must not end the others
        reason = f'The flight broke: {type(error).__name__}: {error}'
        return failed(job, reason, time.monotonic() - begun)
    outcome = loop.world.outcome
    return Row(
        job.index,
        job.seed,
        {path: si_of(value) for path, value in job.values.items()},
        outcome.name.lower(),
        str(outcome),
        time.monotonic() - begun,
        finite(figures),
    )
