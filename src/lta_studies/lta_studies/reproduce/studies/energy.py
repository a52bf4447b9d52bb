"""What flights cost: the power budget, 450 s of hovering on one cell, and an hour of light."""

from collections.abc import Mapping
import math
from pathlib import Path
from typing import Final

from lta_config.typed import typed
from lta_energy.breakeven import income, LAMPS
from lta_energy.harvest import Harvest
from lta_model.vehicle import load_vehicle
from lta_studies.energy import paper
from lta_studies.energy.budget.page import table, TASKS, tasks_picture, why
from lta_studies.energy.budget.run import Budget, budget
from lta_studies.energy.budget.tasks import begun as along
from lta_studies.energy.budget.tasks import END, Task
from lta_studies.energy.flown import for_seconds
from lta_studies.energy.hover.page import CAPTION, picture
from lta_studies.energy.hover.run import begun, compare, Comparison, ingredients
from lta_studies.reproduce.found import Asked, Found, Picture, Value
from lta_studies.reproduce.recorded import record, way

VEHICLE, STANDARD = 'gtmab', 'multirotor'
LUX: Final = 80e3  # seed paper
HOUR: Final = 3600.0  # s
NAMES: Final = {'white LED': 'led', 'flickering LED': 'flicker', 'sun': 'sun'}
TASK: Final = {
    'take-off': 'take_off', 'hovering': 'hover', 'flying at 0.5 m/s': 'fly',
    'navigating, BAG': 'bag', 'navigating, DES': 'des', 'navigating, DGA': 'dga',
}  # fmt: skip


def study(asked: Asked) -> Found:
    """Return budget, voltage and charging."""
    found = budget(VEHICLE, STANDARD, asked.seeds, lambda: None)
    values = {**tasks(found, asked.seeds), **causes(found)}
    values |= charging(found)
    pictures = [
        Picture('tasks', 'Power by task', TASKS, tasks_picture(found),
                typed('energy', 'budget', '--seeds', str(asked.seeds)),
                '' if asked.quick else recorded(asked.folder / 'tasks'))
    ]  # fmt: skip
    if asked.quick:
        return Found(values, pictures, [table(found), why(found)])
    beside = compare(VEHICLE, STANDARD, paper.HOVER_TIME, lambda _: None)
    values |= hovering(beside)
    place = asked.folder / 'voltage'
    record(begun(ingredients(VEHICLE)), for_seconds(paper.HOVER_TIME), place / VEHICLE)
    pictures.append(
        Picture('voltage', 'Voltage of the cell while hovering', CAPTION,
                picture(beside, 'voltage'), typed('energy', 'hover'), way(place))
    )  # fmt: skip
    return Found(values, pictures, [table(found), why(found)])


def recorded(folder: Path) -> str:
    """Record take-off, hover and straight flight of both drones, seed 1."""
    for name in (VEHICLE, STANDARD):
        record(along(name, 1), for_seconds(END), folder / name)
    return way(folder)


def tasks(found: Budget, seeds: int) -> dict[str, Value]:
    """Return the power of every task."""
    values = {name: power(found.tasks[told], seeds) for told, name in TASK.items()}
    hover = found.tasks['hovering'].power
    return {
        **values,
        'standard': power(found.hover, seeds),
        'share': Value(hover / found.hover.power, seeds=seeds),
        'fly_share': Value(found.tasks['flying at 0.5 m/s'].power / found.hover.power),
        'paper_share': Value(paper.HOVER / found.hover.power),
        'strategies_apart': Value(
            max(found.tasks[f'navigating, {each}'].power for each in ('BAG', 'DES', 'DGA'))
            - min(found.tasks[f'navigating, {each}'].power for each in ('BAG', 'DES', 'DGA'))
        ),
    }


def power(task: Task, seeds: int) -> Value:
    """Return what a task takes, with how far single flights are off. [W]"""
    if seeds == 1:
        return Value(task.power)
    return Value(task.power, task.power - task.off, task.power + task.off, seeds)


def causes(found: Budget) -> dict[str, Value]:
    """Return what would make the paper's hover of ours, and what each makes of navigation."""
    cause, bag = found.causes, found.tasks['navigating, BAG']
    return {
        'bag_if_heavy': Value(bag.power + paper.HOVER - found.tasks['hovering'].power),
        'bag_if_worse': Value(bag.electronics + cause.factor * bag.rotors),
        'ideal_hover': Value(cause.least),
        'heavy': Value(cause.heaviness),
        'draught': Value(cause.wind),
        'worse_rotors': Value(cause.factor),
    }


def hovering(found: Comparison) -> dict[str, Value]:
    """Return how voltages fall on identical cells."""
    first, second = found.first.trace, found.second.trace
    lasted = found.seconds if second.failed is None else second.failed
    while_both = float(first.voltage[0] - first.voltage[first.time <= lasted][-1])
    return {
        'drop': Value(first.drop),
        'drop_share': Value(while_both / second.drop),
        'standard_lasts': Value(lasted),
        'charge_used': Value(1.0 - float(first.charge[-1])),
    }


def charging(found: Budget) -> dict[str, Value]:
    """Return how long an hour of flight must be charged for in 80 klux, by kind of light."""
    body = load_vehicle(VEHICLE)
    harvest, idle = Harvest(body.panel), body.loads.idle
    net = {
        NAMES[name]: income(harvest, body.charger, lamp, LUX) - idle
        for name, lamp in LAMPS.items()
    }
    values = {f'net_{name}': Value(each) for name, each in net.items()}
    powers = {
        'paper_fly': sum(paper.NAVIGATION) / 2.0, 'paper_hover': paper.HOVER,
        'fly': found.tasks['navigating, BAG'].power, 'hover': found.tasks['hovering'].power,
    }  # fmt: skip
    values |= ratios(net, powers)
    return values


def ratios(net: Mapping[str, float], powers: Mapping[str, float]) -> dict[str, Value]:
    """Return charge to flight, and minutes of it by hour of charging."""
    values = {}
    for light, watts in net.items():
        for task, drawn in powers.items():
            ratio = drawn / watts if watts > 0.0 else math.inf
            values[f'ratio_{task}_{light}'] = Value(ratio)
        mixed = (powers['paper_fly'] + 2.0 * powers['paper_hover']) / 3.0
        values[f'minutes_{light}'] = Value(HOUR * watts / mixed)
    return values
