"""Processes that fly examinations, one each, and are gone when they are not needed."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
import math
from multiprocessing import get_context
import os
from types import TracebackType
from typing import final, NamedTuple, Self

from lta_analysis.children import begin
from lta_analysis.tune.cut import Cut
from lta_analysis.tune.exam import Case, fly, Scene, STEPS
from lta_analysis.tune.linear import linearised
from lta_analysis.tune.marks import LOST, Mark, Report, report_of
from lta_analysis.tune.mission import seek
from lta_analysis.tune.steadiness import ALTITUDE, CRUISE
from lta_config.errors import BadInput
from lta_control.cascade import CascadeGains, Setpoint

CRUISING = Setpoint(ALTITUDE, 0.0, CRUISE)
WORST = Mark(math.inf, 1.0, 1.0, 1.0)
BROKEN = Report(
    (WORST,) * len(STEPS), 1.0, 1.0, 0.0, True, LOST
)  # of a flight that ended in no numbers


class Task(NamedTuple):
    """One examination to fly."""

    scene: Scene
    gains: CascadeGains
    case: Case


def examine(task: Task) -> Report:
    """Fly one examination and one mission; say how they went, and whether a swing would grow."""
    scene, gains, case = task
    try:
        report = report_of(fly(scene, gains, case))
        linear = linearised(Cut(scene.true(case.loss), scene.known, gains), CRUISING)
        sought = seek(scene, gains, case)
        return replace(report, growth=linear.growth, reached=sought.reached, search=sought.time)
    except BadInput:
        raise
    except (ValueError, ArithmeticError):
        return BROKEN


@final
class Crew:
    """
    Some processes; with one, everything is flown in this one.

    Parameters
    ----------
    size : int
        How many.

    """

    def __init__(self, size: int) -> None:
        for name in ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS'):
            os.environ.setdefault(name, '1')
        self._pool = ProcessPoolExecutor(size, get_context('spawn'), begin) if size > 1 else None

    def fly(self, tasks: Sequence[Task]) -> list[Report]:
        """Return the reports in the order of the tasks."""
        if self._pool is None:
            return [examine(task) for task in tasks]
        try:
            return list(self._pool.map(examine, tasks))
        except BrokenProcessPool:
            raise BadInput(
                'A process that flew examinations died; see whether memory is short, or use '
                '--workers 1. What was flown is kept: give the same command again to go on.'
            ) from None

    def __enter__(self) -> Self:
        """Be ready."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nobody behind."""
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
