"""The power budget: every task of a drone and of the multirotor it is compared with."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, final

from lta_model.electrical.loads import Loads
from lta_model.vehicle import load_vehicle
from lta_studies.energy import paper
from lta_studies.energy.budget.tasks import flights, flying, navigating, standing, STRATEGIES, Task
from lta_studies.energy.budget.why import Causes, causes


@final
@dataclass(frozen=True, slots=True)
class Budget:
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
    tasks: Mapping[str, Task]
    hover: Task
    causes: Causes
    loads: Loads

    @property
    def share(self) -> float:
        """What the drone's hover takes of the multirotor's. [1]"""
        return self.tasks['hovering'].power / self.hover.power


def budget(vehicle: str, standard: str, seeds: int, tick: Callable[[], None]) -> Budget:
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
    tasks = [*standing(body.loads), *flying(body.loads, flights(vehicle, seeds, tick))]
    tasks += [navigating(vehicle, name, seeds, tick) for name in STRATEGIES]
    named = {task.name: task for task in tasks}
    hovering = flying(other.loads, flights(standard, seeds, tick))[1]
    found = causes(body, named['hovering'].power, paper.HOVER)
    return Budget(body.file.name, other.file.name, named, hovering, found, body.loads)


def count(seeds: int) -> int:
    """Return how many flights a budget takes."""
    return seeds * (2 + len(STRATEGIES))


def printed(task: Task) -> list[str]:
    """Return what the paper prints of a task. [mW]"""
    low, high = paper.NAVIGATION
    known: dict[str, Sequence[float]] = {
        'idle': [paper.IDLE],
        'transmitting': [paper.TRANSMITTING],
        'hovering': [paper.HOVER],
    }
    found = known.get(task.name, [low, high] if task.name.startswith('navigating') else [])
    return [f'{1e3 * each:.0f}' for each in found]


def plain(found: Budget) -> dict[str, Any]:
    """Return a budget as JSON has it, in SI units."""
    return {
        'vehicle': found.vehicle,
        'standard': found.standard,
        'tasks': {name: _plain(task) for name, task in found.tasks.items()},
        'standard_hover': _plain(found.hover),
        'share_of_standard': found.share,
        'causes': asdict(found.causes),
    }


def _plain(task: Task) -> dict[str, float | None]:
    numbers = {'power': task.power, **asdict(task)}
    del numbers['name']
    return {name: None if value != value else value for name, value in numbers.items()}
