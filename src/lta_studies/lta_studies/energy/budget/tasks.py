"""
Measure the power of each task in closed-loop flights.

One flight in still air takes off, hovers and flies straight; its rotor power is split by phase.
Other flights navigate to a lamp with each strategy. The power of the electronics is added from the
vehicle file: the radio always, the light board while navigating.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_config.topics import load_topic_table
from lta_control.cascade import Setpoint
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.electrical.loads import LoadModel, navigation_power
from lta_model.vehicle import Vehicle
from lta_report.line_log import LogKind
from lta_report.study_store import StoreFormat
from lta_sim.readings import FlightOutcome
from lta_sim.termination import LIFT_OFF
from lta_studies.energy.course_flight import (
    build_closed_loop,
    Course,
    FlightTrack,
    fly_until,
    stop_after,
)
from pydantic import TypeAdapter

SCENE, LAMP_SCENE = 'hall', 'lamp_room'
COURSE = 'course'
STRATEGIES = ('bag', 'des', 'dga')
RISE = 0.5  # m, seed paper
SPEED = 0.5  # m/s, seed paper
GO, SETTLED, AWAY, CRUISING, END = 5.0, 30.0, 60.0, 70.0, 100.0  # s, start of each phase
NEAR = 0.05  # m below the setpoint, where take-off ends


@final
@dataclass(frozen=True, slots=True)
class TaskPower:
    """Power of a task."""

    name: str
    electronics: float  # power of controller, radio, light board and computing, if on [W]
    rotors: float  # rotor power, mean over the flights [W]
    off: float = 0.0  # largest deviation of one flight from that mean [W]
    seconds: float = math.nan  # mean duration of the task [s]

    @property
    def power(self) -> float:
        """Total power. [W]"""
        return self.electronics + self.rotors


def list_ground_tasks(loads: LoadModel) -> list[TaskPower]:
    """Return the tasks on the ground: motors off, without and with the radio."""
    return [
        TaskPower('idle', loads.idle, 0.0),
        TaskPower('transmitting', loads.idle + loads.transmitting, 0.0),
    ]


def build_course(base: float) -> Course:
    """Return the course of take-off, hover and straight flight above a base height. [m]"""

    def setpoint_at(time: float) -> Setpoint:
        rise = RISE if time >= GO else 0.0
        return Setpoint(base + rise, 0.0, SPEED if time >= AWAY else 0.0)

    return setpoint_at


class BudgetFlight(NamedTuple):
    """One flight of a budget; its text is its key."""

    vehicle: str
    task: str  # `COURSE`, or the strategy by which it navigates to a lamp
    seed: int


STORE: Final = StoreFormat(
    LogKind('flights.jsonl', 'budget', 'power budget', '--out'), TypeAdapter(FlightTrack)
)


def fly_task(flight: BudgetFlight) -> FlightTrack:
    """Fly the course, or to a lamp."""
    if flight.task == COURSE:
        return fly_until(prepare_flight(flight.vehicle, flight.seed), stop_after(END))
    made_of = load_spec(flight.vehicle, LAMP_SCENE, flight.task, '')
    whole = fly_until(build_closed_loop(made_of, None, flight.seed), is_flight_over)
    # Leave out the rest on the floor, in which the rotors stand still.
    up = whole.time[whole.height > whole.height[0] + LIFT_OFF]
    return whole.crop(float(up[0]) if len(up) else 0.0, math.inf)


def prepare_flight(vehicle: str, seed: int) -> ClosedLoop:
    """Return the closed loop of a flight along the course before its first step."""
    made_of = load_spec(vehicle, SCENE, 'bag', '')
    base = build_vehicle_scenario_stack(made_of)[0].hull_height_on_floor
    return build_closed_loop(made_of, build_course(base), seed)


def average_flight_tasks(loads: LoadModel, tracks: Sequence[FlightTrack]) -> list[TaskPower]:
    """Return the mean power of take-off, hovering and flying."""
    steady = loads.idle + loads.transmitting
    parts = {
        'take-off': [select_take_off(each) for each in tracks],
        'hovering': [each.crop(SETTLED, AWAY) for each in tracks],
        f'flying at {SPEED:g} m/s': [each.crop(CRUISING, END) for each in tracks],
    }
    return [average_task_power(name, steady, part) for name, part in parts.items()]


def select_take_off(track: FlightTrack) -> FlightTrack:
    """Return the part from the take-off command until the altitude is nearly reached."""
    there = track.height[0] + RISE - NEAR
    arrived = track.time[(track.time > GO) & (track.height >= there)]
    return track.crop(GO, float(arrived[0]) if len(arrived) else SETTLED)


def average_task_power(name: str, electronics: float, tracks: Sequence[FlightTrack]) -> TaskPower:
    """Average the power over flight segments, one per seed."""
    means = [float(each.rotors.mean()) for each in tracks]
    mean = math.fsum(means) / len(means)
    seconds = math.fsum(float(each.time[-1] - each.time[0]) for each in tracks) / len(tracks)
    # The spread is the largest deviation of a seed, as a few seeds give no useful interval.
    return TaskPower(name, electronics, mean, max(abs(one - mean) for one in means), seconds)


def average_navigation(
    vehicle: Vehicle, strategy: str, tracks: Sequence[FlightTrack]
) -> TaskPower:
    """Return the power of navigating to a lamp with a strategy, from lift-off to the end."""
    loads = vehicle.loads
    electronics = loads.idle + loads.transmitting
    electronics += navigation_power(vehicle.file.energy, strategy)
    return average_task_power(f'navigating, {strategy.upper()}', electronics, tracks)


def is_flight_over(loop: ClosedLoop) -> bool:
    """Return whether a flight to a lamp is over."""
    ended = loop.world.outcome is not FlightOutcome.FLYING
    return ended and load_topic_table().is_settled(loop.world.stamp_ns)
