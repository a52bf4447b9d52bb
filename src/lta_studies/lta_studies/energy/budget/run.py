# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Measure the power budget of a drone, and the hover of a multirotor for comparison.

Single causes are computed that would raise the hover power to the 1333 mW of the seed paper. They
are extra weight, wind, or less efficient rotors, each with everything else unchanged. The loads
are those of the vehicle file, with rotor power affine in thrust. The paper does not state which of
them applied.

One flight in still air takes off, hovers and flies straight; its rotor power is split by phase.
Other flights navigate to a lamp with each strategy. The power of the electronics is added from the
vehicle file: the radio always, the light board while navigating.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
import math
from typing import Final, final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.topics import load_topic_table
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.electrical.loads import LoadModel, navigation_power
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import Report
from lta_report.request import option, StudyRequest, StudyRun, VEHICLE
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_sim.readings import FlightOutcome
from lta_sim.termination import LIFT_OFF
from lta_studies.energy import paper
from lta_studies.energy.budget.hover import HOVER_STORE, HoverStudy
from lta_studies.energy.course_flight import (
    build_closed_loop,
    build_course,
    FlightTrack,
    fly_until,
    stop_after,
)
from lta_vehicle.figures.thrust_envelope import hover_thrust
from pydantic import TypeAdapter

PUSHING_SHARE = 0.5  # share of the thrust along x above which a rotor counts as a forward one


@final
@dataclass(frozen=True, slots=True)
class PowerCauses:
    """Causes that alone explain a power; NaN where the vehicle's rotors cannot reach it."""

    least: float  # hover power with ideal rotors in still air, radio on [W]
    heaviness: float  # mass minus displaced air [kg]
    wind: float  # wind against which the position is held [m/s]
    factor: float  # factor on the power of the rotors [1]


def explain_hover_power(vehicle: Vehicle, hover: float, goal: float) -> PowerCauses:
    """
    Compute the causes that raise the hover power to a goal.

    `hover`: its hover power in flight, radio on [W]. `goal`: power to explain. [W].
    """
    loads = vehicle.loads
    steady = loads.idle + loads.transmitting
    thrust, count = hover_thrust(vehicle)
    # Rotor power is affine in thrust: offset + slope * thrust, per rotor.
    lifting = count * (loads.rotor_offset + loads.rotor_slope * thrust)
    per_newton = count * thrust / (vehicle.heaviness * STANDARD_GRAVITY)
    # Additional mass [kg] whose lift costs the missing power; the offsets are already paid.
    heavy = (goal - hover) / (loads.rotor_slope * per_newton * STANDARD_GRAVITY)
    return PowerCauses(
        least=steady + lifting,
        heaviness=vehicle.heaviness + heavy,
        wind=_equivalent_wind(vehicle, goal - hover),
        factor=(goal - steady) / (hover - steady),
    )


def _equivalent_wind(vehicle: Vehicle, more: float) -> float:
    """Return the wind whose drag costs the forward rotors that much power [m/s]."""
    pushing = [rotor.column[0] for rotor in vehicle.rotors if rotor.column[0] > PUSHING_SHARE]
    if not pushing:
        return math.nan
    loads, effects = vehicle.loads, vehicle.collect_effects()
    push = sum(pushing) / len(pushing)
    # The forward rotors rest in a hover, so their offsets come first.
    force = (more - len(pushing) * loads.rotor_offset) / loads.rotor_slope * push
    a, b = effects['quadratic_drag']['surge'], effects['linear_drag']['surge']
    if force <= 0.0 or a + b <= 0.0:
        return math.nan
    # Positive root of a v^2 + b v = force.
    return (-b + math.sqrt(b * b + 4.0 * a * force)) / (2.0 * a) if a else force / b


BUDGET_SCENE, LAMP_SCENE = 'hall', 'lamp_room'
COURSE = 'course'
BUDGET_STRATEGIES = ('bag', 'des', 'dga')
HOVER_ALTITUDE = 0.5  # m, seed paper
BUDGET_CRUISE_SPEED = 0.5  # m/s, seed paper
START_TIME, SETTLED_PHASE, BUDGET_DEPARTURE, CRUISING_TIME, FLIGHT_END = (
    5.0,
    30.0,
    60.0,
    70.0,
    100.0,
)  # s, start of each phase
NEAR_ALTITUDE = 0.05  # m below the setpoint, where take-off ends


@final
@dataclass(frozen=True, slots=True)
class TaskPower:
    """Power of a task."""

    name: str
    electronics: float  # power of controller, radio, light board and computing, if on [W]
    rotors: float  # rotor power, mean over the flights [W]
    off: float = 0.0  # largest deviation of one flight from that mean [W]
    seconds: float = math.nan  # mean duration of the task [s]
    paper: tuple[float, ...] = ()  # what the paper states, or both ends of its range [W]

    @property
    def power(self) -> float:
        """Total power [W]."""
        return self.electronics + self.rotors


def list_ground_tasks(loads: LoadModel) -> list[TaskPower]:
    """Return the tasks on the ground: motors off, without and with the radio."""
    return [
        TaskPower('idle', loads.idle, 0.0, paper=(paper.IDLE,)),
        TaskPower(
            'transmitting', loads.idle + loads.transmitting, 0.0, paper=(paper.TRANSMITTING,)
        ),
    ]


class BudgetFlight(NamedTuple):
    """One flight of a budget; its text is its key."""

    vehicle: str
    task: str  # `COURSE`, or the strategy by which it navigates to a lamp
    seed: int


BUDGET_STORE: Final = StoreFormat(
    'flights.jsonl', 'budget', 'power budget', TypeAdapter(FlightTrack)
)


def fly_task(flight: BudgetFlight) -> FlightTrack:
    """Fly the course, or to a lamp."""
    if flight.task == COURSE:
        return fly_until(prepare_flight(flight.vehicle, flight.seed), stop_after(FLIGHT_END))
    made_of = load_spec(flight.vehicle, LAMP_SCENE, flight.task, '')
    whole = fly_until(build_closed_loop(made_of, None, flight.seed), is_flight_over)
    # Leave out the rest on the floor, in which the rotors stand still.
    up = whole.time[whole.height > whole.height[0] + LIFT_OFF]
    return whole.crop(float(up[0]) if len(up) else 0.0, math.inf)


def prepare_flight(vehicle: str, seed: int) -> ClosedLoop:
    """Return the closed loop of a flight along the course before its first step."""
    made_of = load_spec(vehicle, BUDGET_SCENE, 'bag', '')
    base = build_vehicle_scenario_stack(made_of)[0].hull_height_on_floor
    course = build_course(base, HOVER_ALTITUDE, START_TIME, BUDGET_DEPARTURE, BUDGET_CRUISE_SPEED)
    return build_closed_loop(made_of, course, seed)


def average_flight_tasks(loads: LoadModel, tracks: Sequence[FlightTrack]) -> list[TaskPower]:
    """Return the mean power of take-off, hovering and flying."""
    steady = loads.idle + loads.transmitting
    parts = {
        'take-off': [select_take_off(each) for each in tracks],
        'hovering': [each.crop(SETTLED_PHASE, BUDGET_DEPARTURE) for each in tracks],
        f'flying at {BUDGET_CRUISE_SPEED:g} m/s': [
            each.crop(CRUISING_TIME, FLIGHT_END) for each in tracks
        ],
    }
    stated = {'hovering': (paper.HOVER,)}
    return [
        average_task_power(name, steady, part, stated.get(name, ()))
        for name, part in parts.items()
    ]


def select_take_off(track: FlightTrack) -> FlightTrack:
    """Return the part from the take-off command until the altitude is nearly reached."""
    there = track.height[0] + HOVER_ALTITUDE - NEAR_ALTITUDE
    arrived = track.time[(track.time > START_TIME) & (track.height >= there)]
    return track.crop(START_TIME, float(arrived[0]) if len(arrived) else SETTLED_PHASE)


def average_task_power(
    name: str, electronics: float, tracks: Sequence[FlightTrack], stated: tuple[float, ...]
) -> TaskPower:
    """Average the power over flight segments, one per seed."""
    means = [float(each.rotors.mean()) for each in tracks]
    mean = math.fsum(means) / len(means)
    seconds = math.fsum(float(each.time[-1] - each.time[0]) for each in tracks) / len(tracks)
    # The spread is the largest deviation of a seed, as a few seeds give no useful interval.
    off = max(abs(one - mean) for one in means)
    return TaskPower(name, electronics, mean, off, seconds, stated)


def average_navigation(
    vehicle: Vehicle, strategy: str, tracks: Sequence[FlightTrack]
) -> TaskPower:
    """Return the power of navigating to a lamp with a strategy, from lift-off to the end."""
    loads = vehicle.loads
    electronics = loads.idle + loads.transmitting
    electronics += navigation_power(vehicle.file.energy, strategy)
    name = f'navigating, {strategy.upper()}'
    return average_task_power(name, electronics, tracks, paper.NAVIGATION)


def is_flight_over(loop: ClosedLoop) -> bool:
    """Return whether a flight to a lamp is over."""
    ended = loop.world.outcome is not FlightOutcome.FLYING
    return ended and load_topic_table().is_settled(loop.world.stamp_ns)


@final
class BudgetRequest(StudyRequest, command='energy budget', quick={'seeds': 1, 'seconds': 60}):
    """
    Measure the power of each task: standing, take-off, hovering, flying, finding a lamp.

    Simulated flights give the power of rotors and electronics separately, compared with the seed
    paper and a hovering multirotor. Where the paper differs, the study computes what would explain
    it: more weight, a draught, less efficient rotors. Rotor power by duty and voltage is compared
    with Bitcraze's bench measurements.

    Then both hover on the vehicle's own battery cell, full at the start. The cell voltage is
    compared with the same cell under the powers that the paper states: 1333 mW, and three times
    that for a standard drone. A drone drops out when its supply fails.

    Exit status 0: done. 2: bad input.

    Example: lta energy budget --seeds 1
    """

    vehicle: str = VEHICLE
    multirotor: str = option(
        'Multirotor to compare with, name or file.', default='multirotor', name='beside'
    )
    seeds: int = option('Number of flights of each vehicle.', default=3, low=1, high=100)
    seconds: float = option(
        'Duration of the hover on one cell in seconds.', default=paper.HOVER_TIME, low=1.0,
        high=7200.0,
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of all flights."""
        from lta_studies.energy.budget.report import build_report

        scenes = [
            load_spec(self.vehicle, scene, 'bag', '') for scene in (BUDGET_SCENE, LAMP_SCENE)
        ]
        specs = [*scenes, load_spec(self.multirotor, BUDGET_SCENE, 'bag', '')]
        identity = hash_inputs(*(spec.contents for spec in specs))
        fly_all = partial(run.run_study, Study(fly_task, str, BUDGET_STORE, 'flights'), identity)
        budget = measure_budget(self.vehicle, self.multirotor, self.seeds, fly_all)
        hover = HoverStudy(self.vehicle, self.multirotor, self.seconds)
        hover_identity = hash_inputs(
            self.seconds, *(spec.contents for spec in hover.build_specs())
        )
        hovers = run.run_study(
            Study(hover.fly, str, HOVER_STORE, 'hovers'), hover_identity, range(2)
        )
        return build_report(budget, hover.compare(hovers))


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
        """Hover power of the drone relative to the multirotor [1]."""
        return self.tasks['hovering'].power / self.hover.power


FLY_TASKS_HERE: Final = partial(map, fly_task)


def measure_budget(
    vehicle: str,
    standard: str,
    seeds: int,
    fly_all: Callable[[Sequence[BudgetFlight]], Iterable[FlightTrack]] = FLY_TASKS_HERE,
) -> PowerBudget:
    """Measure the budget; `fly_all` flies all flights, in this process or in workers."""
    body, other = load_vehicle(vehicle), load_vehicle(standard)
    kinds = [
        (vehicle, COURSE),
        *((vehicle, name) for name in BUDGET_STRATEGIES),
        (standard, COURSE),
    ]
    flights = [BudgetFlight(*kind, seed) for kind in kinds for seed in range(1, seeds + 1)]
    results = list(fly_all(flights))
    course, *navigated, multirotor = (
        results[k : k + seeds] for k in range(0, len(results), seeds)
    )
    tasks = [*list_ground_tasks(body.loads), *average_flight_tasks(body.loads, course)]
    tasks += [
        average_navigation(body, name, tracks)
        for name, tracks in zip(BUDGET_STRATEGIES, navigated, strict=True)
    ]
    named = {task.name: task for task in tasks}
    # Index 1 is the hover, between take-off and flying.
    hovering = replace(
        average_flight_tasks(other.loads, multirotor)[1],
        name=f'{other.file.name}, hovering',
        paper=(paper.STANDARD,),
    )
    causes = explain_hover_power(body, named['hovering'].power, paper.HOVER)
    return PowerBudget(body.file.name, other.file.name, named, hovering, causes, body.loads)
