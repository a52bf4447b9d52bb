"""Measure the power budget of a drone, and the hover of a multirotor for comparison."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, Final, final

from lta_flight.flight_spec import load_spec
from lta_model.electrical.loads import LoadModel
from lta_model.vehicle import load_vehicle
from lta_report.report import Report
from lta_report.request import option, StudyRequest, StudyRun, VEHICLE
from lta_report.study import hash_inputs, Study
from lta_studies.energy import paper
from lta_studies.energy.budget.power_causes import explain_hover_power, PowerCauses
from lta_studies.energy.budget.tasks import (
    average_flight_tasks,
    average_navigation,
    BudgetFlight,
    COURSE,
    fly_task,
    LAMP_SCENE,
    list_ground_tasks,
    SCENE,
    STORE,
    STRATEGIES,
    TaskPower,
)
from lta_studies.energy.course_flight import FlightTrack


@final
class BudgetRequest(StudyRequest, command='energy budget', quick={'seeds': 1}):
    """
    Measure the power of each task: standing, take-off, hovering, flying, finding a lamp.

    Simulated flights give the power of rotors and electronics separately, compared with the seed
    paper and a hovering multirotor. Where the paper differs, the study computes what would explain
    it: more weight, a draught, less efficient rotors. Rotor power by duty and voltage is compared
    with Bitcraze's bench measurements.

    Exit status 0: done. 2: bad input.

    Example: lta energy budget --seeds 1
    """

    vehicle: str = VEHICLE
    multirotor: str = option(
        'Multirotor to compare with, name or file.', default='multirotor', name='beside'
    )
    seeds: int = option('Number of flights of each vehicle.', default=3, low=1, high=100)

    def run(self, run: StudyRun) -> Report:
        """Return the report of all flights."""
        from lta_studies.energy.budget.report import build_report

        scenes = [load_spec(self.vehicle, scene, 'bag', '') for scene in (SCENE, LAMP_SCENE)]
        specs = [*scenes, load_spec(self.multirotor, SCENE, 'bag', '')]
        identity = hash_inputs(*(spec.contents for spec in specs))
        fly_all = partial(run.run_study, Study(fly_task, str, STORE, 'flights'), identity)
        return build_report(measure_budget(self.vehicle, self.multirotor, self.seeds, fly_all))


@final
@dataclass(frozen=True, slots=True)
class PowerBudget:
    """Power budget of a drone."""

    # The drone, and the multirotor for comparison
    vehicle: str
    standard: str
    tasks: Mapping[str, TaskPower]  # tasks of the drone, by name
    hover: TaskPower  # hover of the multirotor
    causes: PowerCauses  # possible causes of the paper's hover power
    loads: LoadModel  # loads of the drone

    @property
    def hover_power_ratio(self) -> float:
        """Hover power of the drone relative to the multirotor. [1]"""
        return self.tasks['hovering'].power / self.hover.power


FLY_HERE: Final = partial(map, fly_task)


def measure_budget(
    vehicle: str,
    standard: str,
    seeds: int,
    fly_all: Callable[[Sequence[BudgetFlight]], Iterable[FlightTrack]] = FLY_HERE,
) -> PowerBudget:
    """Measure the budget; `fly_all` flies all flights, in this process or in workers."""
    body, other = load_vehicle(vehicle), load_vehicle(standard)
    kinds = [(vehicle, COURSE), *((vehicle, name) for name in STRATEGIES), (standard, COURSE)]
    flights = [BudgetFlight(*kind, seed) for kind in kinds for seed in range(1, seeds + 1)]
    results = list(fly_all(flights))
    course, *navigated, multirotor = (
        results[k : k + seeds] for k in range(0, len(results), seeds)
    )
    tasks = [*list_ground_tasks(body.loads), *average_flight_tasks(body.loads, course)]
    tasks += [
        average_navigation(body, name, tracks)
        for name, tracks in zip(STRATEGIES, navigated, strict=True)
    ]
    named = {task.name: task for task in tasks}
    # Index 1 is the hover, between take-off and flying.
    hovering = average_flight_tasks(other.loads, multirotor)[1]
    causes = explain_hover_power(body, named['hovering'].power, paper.HOVER)
    return PowerBudget(body.file.name, other.file.name, named, hovering, causes, body.loads)


def format_paper_values(task: TaskPower) -> list[str]:
    """Format the paper's values for a task. [mW]"""
    low, high = paper.NAVIGATION
    values_by_task: dict[str, Sequence[float]] = {
        'idle': [paper.IDLE],
        'transmitting': [paper.TRANSMITTING],
        'hovering': [paper.HOVER],
    }
    values = values_by_task.get(
        task.name, [low, high] if task.name.startswith('navigating') else []
    )
    return [f'{1e3 * each:.0f}' for each in values]


def to_json(result: PowerBudget) -> dict[str, Any]:
    """Convert a budget to JSON, in SI units."""
    return {
        'vehicle': result.vehicle,
        'standard': result.standard,
        'tasks': {name: _task_to_json(task) for name, task in result.tasks.items()},
        'standard_hover': _task_to_json(result.hover),
        'share_of_standard': result.hover_power_ratio,
        'causes': asdict(result.causes),
    }


def _task_to_json(task: TaskPower) -> dict[str, float | None]:
    numbers = {'power': task.power, **asdict(task)}
    del numbers['name']
    # NaN, which differs from itself, becomes null.
    return {name: None if value != value else value for name, value in numbers.items()}
