# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build a platform, fly it through one manoeuvre, and rate the true motion.

With e = setpoint - response on the rated interval:

    overshoot       largest excess over the goal of a step, as a share of the step
    settling time   after which the error stays within the band; NaN if it does not settle
    steady error    mean of e over the last quarter
    rms             root mean square of e over the whole interval
    ripple          standard deviation of e over the last quarter
    held            settled before the last quarter
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
import math
from typing import Any, final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file, validate_content
from lta_config.parameter_override import parse_value, replace_parameter
from lta_config.schema.comparison_file import Contestant, EntryChange, ManeuverFile
from lta_config.schema.vehicle_file import load_vehicle_content, VehicleFile
from lta_config.settings import Settings
from lta_config.topics import load_topic_table
from lta_control.laws import find_control_law, load_law_gains
from lta_control.laws.protocol import ControlLaw
from lta_control.motion import Setpoint, to_world, up_in_body, wrap_angle, yaw_from_quaternion
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_model.propulsion import select_lifting_rotors
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LAST_QUARTER = 0.75  # share of the interval after which its last quarter begins


class TrackingMetrics(NamedTuple):
    """Metrics of one signal, in its unit and s; the overshoot is a share, NaN for ramps."""

    overshoot: float
    settling_time: float
    steady_error: float
    rms: float
    ripple: float
    held: bool


def compute_tracking_metrics(
    time: Array, setpoint: Array, response: Array, band: float, before: float
) -> TrackingMetrics:
    """
    Compute the metrics of a signal.

    `time`, `setpoint`, `response`, shape (n,): the rated interval, n > 1; angles unwrapped.
    `band`: largest error that counts as settled, in the unit of the signal. `before`: setpoint
    before the interval, where the step starts; there is no step if it is equal.
    """
    error = setpoint - response
    begin, end = float(time[0]), float(time[-1])
    last = time >= begin + LAST_QUARTER * (end - begin)
    outside = np.flatnonzero(~(np.abs(error) <= band))  # NaN counts as outside
    if not len(outside):
        settling = 0.0
    elif outside[-1] + 1 == len(time):
        settling = math.nan
    else:
        settling = float(time[outside[-1] + 1]) - begin
    step = float(setpoint[-1]) - before
    constant = bool(np.all(setpoint == setpoint[0]))
    # Positive beyond the goal, for steps up and down.
    excess = math.copysign(1.0, step) * (response - setpoint)
    overshoot = max(0.0, float(excess.max())) / abs(step) if constant and step else math.nan
    return TrackingMetrics(
        overshoot,
        settling,
        float(error[last].mean()),
        math.sqrt(float(np.mean(error**2))),
        float(error[last].std()),
        # A NaN settling time compares as False: not held.
        bool(settling <= LAST_QUARTER * (end - begin)),
    )


# Columns of the recorded tables; column 0 is the time
ALTITUDE_COLUMN, HEADING_COLUMN, SPEED_COLUMN = 1, 2, 3
COLUMN_OF_SIGNAL = {'altitude': ALTITUDE_COLUMN, 'heading': HEADING_COLUMN, 'speed': SPEED_COLUMN}
# Yaw rate as a speed is first commanded [rad/s]. Without it, a flight in still air from an
# unstable equilibrium would stay there.
YAW_NUDGE = 1e-4
YAW_RATE = 12  # in the state
HEIGHT_BAND = 0.2  # m of height error allowed in heading and speed manoeuvres (assumed)


@final
@dataclass(frozen=True, slots=True)
class Entrant:
    """A platform ready to fly; `release` is the start height [m], None for the floor."""

    vehicle: Vehicle
    law: ControlLaw
    gains: Settings
    release: float | None = None


@final
@dataclass(frozen=True, slots=True)
class ManeuverFlight:
    """Result of one flight."""

    # Metrics of the rated signal, and of the altitude
    metrics: TrackingMetrics
    height: TrackingMetrics
    tilt: float  # largest tilt in the rated interval [rad]
    lost: str  # why the flight failed; '' if it did not
    # Setpoint and true motion: time [s], altitude [m], heading [rad, unwrapped] and speed along
    # the course, shape (n, 4) [m/s]
    asked: Array
    flown: Array
    duties: Array  # duties of the rotors, shape (n, rotors)

    @property
    def is_successful(self) -> bool:
        """Whether the flight followed its setpoint and held its height."""
        return not self.lost and self.metrics.held and self.height.held


def build_course(manoeuvre: ManeuverFile, base: float) -> Callable[[float], Setpoint]:
    """Return the setpoint as a function of time, relative to a base height [m]."""

    def setpoint_at(time: float) -> Setpoint:
        target = manoeuvre.setpoint_at(time)
        return Setpoint(base + target.rise, target.heading, target.speed)

    return setpoint_at


def prepare_flight(
    entrant: Entrant, scenario: Scenario, manoeuvre: ManeuverFile, seed: int
) -> ClosedLoop:
    """Return the closed loop of a flight before its first step."""
    table, vehicle = load_topic_table(), entrant.vehicle
    world = World(vehicle, scenario, table, seed)
    base = vehicle.hull_height_on_floor
    if entrant.release is not None:
        # State 2 is the height; rises of the course count from the release.
        base = world.state[2] = entrant.release
    course = build_course(manoeuvre, base)
    policy = FlightStack(
        find_navigation_strategy('bag'), entrant.gains, law=entrant.law, course=course
    )
    return ClosedLoop(world, table, policy)


def fly_maneuver(
    entrant: Entrant, scenario: Scenario, manoeuvre: ManeuverFile, seed: int
) -> ManeuverFlight:
    """Fly a manoeuvre and rate it."""
    loop = prepare_flight(entrant, scenario, manoeuvre, seed)
    world = loop.world
    course = build_course(manoeuvre, world.state.item(2))
    states, duties, tilts = [], [], []
    nudged = False
    # Record the state between decision and command, when both refer to the same time.
    for _ in loop.iterate_until(lambda: world.elapsed > manoeuvre.until.si):
        if not nudged and course(world.elapsed).speed > 0.0:
            world.state[YAW_RATE] += YAW_NUDGE
            nudged = True
        state = world.state.tolist()
        states.append((world.elapsed, *_read_truth(state, course(world.elapsed).heading)))
        # Clamped, because rounding can leave the cosine outside [-1, 1].
        tilts.append(math.acos(max(-1.0, min(1.0, up_in_body(_extract_quaternion(state))[2]))))
        duties.append(loop.duties)
    response, stopped = np.array(states), loop.autopilot.stopped
    return _evaluate_flight(
        manoeuvre, course, response, np.array(duties), np.array(tilts), stopped
    )


def _extract_quaternion(state: list[float]) -> tuple[float, float, float, float]:
    x, y, z, w = state[3:7]
    return x, y, z, w


def _read_truth(state: list[float], course: float) -> tuple[float, float, float]:
    """Return the true height, heading and ground speed along a course."""
    # States 7 to 9: velocity in the body frame
    attitude, (u, v, w) = _extract_quaternion(state), state[7:10]
    x, y, _ = to_world(attitude, (u, v, w))
    return state[2], yaw_from_quaternion(attitude), math.cos(course) * x + math.sin(course) * y


def _evaluate_flight(
    manoeuvre: ManeuverFile,
    course: Callable[[float], Setpoint],
    response: Array,
    duties: Array,
    tilts: Array,
    stopped: bool,
) -> ManeuverFlight:
    """Compute the metrics of a flight."""
    setpoints = np.array([(time, *course(time)) for time in response[:, 0].tolist()])
    setpoints[:, HEADING_COLUMN] = np.unwrap(setpoints[:, HEADING_COLUMN])
    response[:, HEADING_COLUMN] = np.unwrap(response[:, HEADING_COLUMN])
    begin = manoeuvre.judged_from.si
    # 1e-9 s absorbs rounding of the recorded times.
    part = response[:, 0] >= begin - 1e-9
    column = COLUMN_OF_SIGNAL[manoeuvre.judge]
    # The setpoint just before the rated interval: the step starts from there.
    before = course(begin - 1e-6)
    first = Setpoint(before.altitude, wrap_angle(before.heading), before.speed)[column - 1]
    time = response[part, 0]
    metrics = compute_tracking_metrics(
        time, setpoints[part, column], response[part, column], manoeuvre.band.si, first
    )
    rising = manoeuvre.judge == 'altitude'
    # An altitude manoeuvre is rated by its height already.
    height = metrics if rising else compute_tracking_metrics(
        time, setpoints[part, ALTITUDE_COLUMN], response[part, ALTITUDE_COLUMN], HEIGHT_BAND,
        before.altitude
    )  # fmt: skip
    lost = 'turned over' if stopped else ''
    return ManeuverFlight(
        metrics, height, float(tilts[part].max()), lost, setpoints, response, duties
    )


def compute_lift_margin(vehicle: Vehicle) -> tuple[float, float]:
    """Return the lift at full thrust and the weight it must carry [N]."""
    own, per_newton = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    # The lifting rotors share the load, so the weakest limits all.
    full = min((rotor.full_thrust for rotor in own), default=0.0)
    return full * per_newton, vehicle.heaviness * STANDARD_GRAVITY


CHANGE_ROOTS = ('vehicle', 'gains')


def build_entrant(
    contestant: Contestant, air_density: float, change: EntryChange | None = None
) -> Entrant:
    """
    Build a contestant, optionally with an ablation or a limit applied.

    `contestant`: entry of the comparison file. `air_density`: air density of the scenario [kg/m3].
    `change`: ablation or limit of the contestant. Raise `BadInput` if it cannot be built, or its
    control law cannot fly it.
    """
    # An ablation builds on the changes of its contestant, in this order.
    steps: list[EntryChange] = [contestant] if change is None else [contestant, change]
    content = load_vehicle_content(find_file('vehicle', contestant.vehicle))
    for step in steps:
        content = _apply_changes(content, step.changes, 'vehicle')
    where = f'{find_file("vehicle", contestant.vehicle)} with the changes of the comparison'
    file = validate_content(VehicleFile, content, where)
    named = _select_law(file, steps)
    gains = load_law_gains(find_control_law(named[0]).gains, named[1])
    values = gains.model_dump()
    for step in steps:
        values = _apply_changes(values, step.changes, 'gains')
    gains = validate_content(
        type(gains), values, f'{find_file("gains", named[1])} with the changes of the comparison'
    )
    vehicle = Vehicle(file, air_density)
    law = find_control_law(named[0])
    law.build_constants(gains, vehicle)  # raises if the law cannot fly the vehicle
    release = contestant.release.si if contestant.release else None
    return Entrant(vehicle, law, gains, release)


def _select_law(file: VehicleFile, steps: list[EntryChange]) -> tuple[str, str]:
    """Return the law and gains that the last step sets; by default those of the vehicle."""
    name = file.control.law if file.control else 'cascade'
    gains = file.control.gains if file.control else None
    for step in steps:
        name, gains = step.law or name, step.gains or gains
    if gains is None:
        raise BadInput(
            f'{file.name} names no gains in its control block; add a line "gains: NAME".'
        )
    return name, gains


def _apply_changes(content: Any, changes: Mapping[str, Any], root: str) -> Any:
    """Apply the changes under `root` to the content of a file."""
    for path, value in changes.items():
        begin, _, below = path.partition('.')
        # Checked for every path, also one that belongs to the other root.
        if begin not in CHANGE_ROOTS or not below:
            raise unknown_name_error('parameter', path, [f'{name}. ...' for name in CHANGE_ROOTS])
        if begin == root:
            content = replace_parameter(content, below, parse_value(value, path), root)
    return content
