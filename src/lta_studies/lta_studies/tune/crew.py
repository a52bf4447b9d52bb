"""Examinations flown side by side, one a process."""

from collections.abc import Sequence
from dataclasses import replace
import math
from operator import itemgetter
from typing import NamedTuple

from lta_config.errors import BadInput
from lta_control.cascade import CascadeGains, Setpoint
from lta_report.children import Children
from lta_studies.tune.cut import Cut
from lta_studies.tune.exam import Case, fly, Scene, STEPS
from lta_studies.tune.linear import linearised
from lta_studies.tune.marks import LOST, Mark, Report, report_of
from lta_studies.tune.mission import seek
from lta_studies.tune.steadiness import ALTITUDE, CRUISE

CRUISING = Setpoint(ALTITUDE, 0.0, CRUISE)
PLACE = itemgetter(0)
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


def crew(size: int) -> Children:
    """Return processes that fly examinations."""
    return Children(size, '--workers', goes_on=True)


def fly_all(tasks: Sequence[Task], by: Children) -> list[Report]:
    """Return the reports in the order of the tasks."""
    return [report for _, report in sorted(by.do(_placed, list(enumerate(tasks))), key=PLACE)]


def _placed(place: int, task: Task) -> tuple[int, Report]:
    """Fly one examination, and say which it was."""
    return place, examine(task)
