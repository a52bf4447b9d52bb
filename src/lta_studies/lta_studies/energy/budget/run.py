"""The power budget: every task of a drone and of the multirotor it is compared with."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, final

from lta_model.electrical.loads import LoadModel
from lta_model.vehicle import load_vehicle
from lta_studies.energy import paper
from lta_studies.energy.budget.power_causes import explain_hover_power, PowerCauses
from lta_studies.energy.budget.tasks import (
    average_flight_tasks,
    fly_course,
    list_ground_tasks,
    measure_navigation,
    STRATEGIES,
    TaskPower,
)


@final
@dataclass(frozen=True, slots=True)
class PowerBudget:
    """
    What everything takes.

    Attributes
    ----------
    vehicle, standard : str
        The drone, and the multirotor that it is compared with.
    tasks : mapping of str to Task
        Of the drone, by name.
    hover : Task
        Of the multirotor in hover.
    causes : Causes
        What would make the paper's hover of the drone's.
    loads : Loads
        Of the drone.

    """

    vehicle: str
    standard: str
    tasks: Mapping[str, TaskPower]
    hover: TaskPower
    causes: PowerCauses
    loads: LoadModel

    @property
    def hover_share(self) -> float:
        """What the drone's hover takes of the multirotor's. [1]"""
        return self.tasks['hovering'].power / self.hover.power


def measure_budget(
    vehicle: str, standard: str, seeds: int, tick: Callable[[], None]
) -> PowerBudget:
    """
    Return what everything takes, flown with some seeds; `tick` is called after each flight.

    Parameters
    ----------
    vehicle, standard : str
        Shipped names or files.
    seeds : int
        Flights of each.
    tick : callable
        Of the progress.

    """
    body, other = load_vehicle(vehicle), load_vehicle(standard)
    tasks = [
        *list_ground_tasks(body.loads),
        *average_flight_tasks(body.loads, fly_course(vehicle, seeds, tick)),
    ]
    tasks += [measure_navigation(vehicle, name, seeds, tick) for name in STRATEGIES]
    named = {task.name: task for task in tasks}
    hovering = average_flight_tasks(other.loads, fly_course(standard, seeds, tick))[1]
    found = explain_hover_power(body, named['hovering'].power, paper.HOVER)
    return PowerBudget(body.file.name, other.file.name, named, hovering, found, body.loads)


def count_flights(seeds: int) -> int:
    """Return how many flights a budget takes."""
    return seeds * (2 + len(STRATEGIES))


def format_paper_values(task: TaskPower) -> list[str]:
    """Return what the paper prints of a task. [mW]"""
    low, high = paper.NAVIGATION
    known: dict[str, Sequence[float]] = {
        'idle': [paper.IDLE],
        'transmitting': [paper.TRANSMITTING],
        'hovering': [paper.HOVER],
    }
    found = known.get(task.name, [low, high] if task.name.startswith('navigating') else [])
    return [f'{1e3 * each:.0f}' for each in found]


def to_json(result: PowerBudget) -> dict[str, Any]:
    """Return a budget as JSON has it, in SI units."""
    return {
        'vehicle': result.vehicle,
        'standard': result.standard,
        'tasks': {name: _task_to_json(task) for name, task in result.tasks.items()},
        'standard_hover': _task_to_json(result.hover),
        'share_of_standard': result.hover_share,
        'causes': asdict(result.causes),
    }


def _task_to_json(task: TaskPower) -> dict[str, float | None]:
    numbers = {'power': task.power, **asdict(task)}
    del numbers['name']
    return {name: None if value != value else value for name, value in numbers.items()}
