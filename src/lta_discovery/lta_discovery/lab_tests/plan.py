"""
Choose the tests that a vehicle needs: rehearse each, and see which parameters it informs.

A rehearsal flies the test with the model of the vehicle file and computes what its poses would
teach, with the filter of a calibration. A test is needed if it teaches something much better than
all shorter ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import ALL_CHANNELS, GRID_PERIOD, MeasuredFlight, Stream
from lta_discovery.lab_tests.design import (
    LabTest,
    LEAST_STEP,
    list_designed_tests,
    list_step_variants,
    LONGEST_WAY,
    rest_duties,
    scale_step,
    step_duties,
    STEP_REST,
)
from lta_discovery.model.calibration_parameters import (
    list_calibration_parameters,
    list_reversed_rotors,
    list_wrench_laws,
    set_references,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.planning.rehearsal import measure_information, POSE_NOISE, TURN_NOISE
from lta_discovery.replay.replay import FlightReplay, STEPS_PER_PERIOD
from lta_model.effects.protocol import AXES
from lta_model.state import ACTUATORS
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Commands = Literal['rotors', 'wrench']

PILOT_HOLD_TIMES: Final = (0.4, 1.6)  # s; shortest and mean time for which a pilot holds a command
MORE: Final = 2.0  # times the information of any shorter test; a test that has it is needed
NO_WRENCH: Final = np.zeros((0, len(AXES)))  # no commanded wrench
UNTAUGHT_SHARE: Final = 0.8  # of the deviation before; a larger one means that no test teaches it
LAW_TERMS: Final = {'smaller': 'exponent', 'reverse': 'reverse'}  # that a variant shows
HIGH: Final = 100.0  # m; rehearsals never meet the floor
FREE_FLIGHT_SEED: Final = 37  # of the commands of the free flight


@final
@dataclass(frozen=True, slots=True)
class PlannedTest:
    """A test with what it teaches."""

    test: LabTest
    # Parameters that it teaches alone, with the remaining share of their deviation; first those
    # that other tests teach less well
    informs: tuple[tuple[str, float], ...]
    best_for: tuple[str, ...]  # parameters that it teaches much better than all shorter tests
    room: tuple[float, float]  # largest horizontal and vertical extent of its path [m]
    is_needed: bool  # whether it belongs to the afternoon


@final
@dataclass(frozen=True, slots=True)
class LabPlan:
    """The tests of an afternoon."""

    vehicle: str
    commands: Commands  # 'rotors' or 'wrench'
    tests: tuple[PlannedTest, ...]  # all that the vehicle can do, needed or not
    unknown: tuple[str, ...]  # parameters that no test teaches, not even all together
    weight: float  # weight that nothing carries while the rotors are off [N]


def plan_lab_tests(
    vehicle: Vehicle, name: str, commands: Commands = 'rotors', room: float = LONGEST_WAY
) -> LabPlan:
    """
    Plan the tests of an afternoon for a vehicle.

    `commands`: what the vehicle is commanded by: the duty of each rotor, or force and moment.
    `room`: longest way of a test [m]. Raise `BadInput` if the vehicle does not float, or cannot
    move.
    """
    nominal = NominalVehicle.from_vehicle(vehicle)
    tests = _fit_steps(vehicle, nominal, list_designed_tests(vehicle, room), commands, room)
    # Without the free flight, whose sizes are those of the pilot
    orders = [_build_commands(vehicle, test, commands, 0.0) for test in tests[:-1]]
    duties = [each.values for each, _ in orders]
    wrench = np.concatenate([each.values for _, each in orders if each is not None] or [NO_WRENCH])
    nominal = set_references(nominal, wrench)
    axes = [test.axis for test in tests if test.kind == 'step']
    commanded = [commands == 'wrench' and axis in axes for axis in AXES]
    # One afternoon has one gas filling: its lift is a number of the vehicle
    knobs = [
        replace(knob, per_flight=False)
        for knob in list_calibration_parameters(
            nominal,
            commanded,
            True,
            list_reversed_rotors(duties, vehicle.reversible) if commands == 'rotors' else (),
            list_wrench_laws(wrench),
        )
    ]
    flights = [rehearse_test(vehicle, nominal, test, commands) for test in tests]
    gains, remaining = _measure_tests(vehicle, nominal, flights, knobs, _list_partners(tests))
    before = np.array([knob.tolerance**-2.0 for knob in knobs])
    alone = np.sqrt(before / (before + gains))
    planned = []
    drilled = [k for k, test in enumerate(tests) if test.kind != 'free_flight']
    for k, (test, flight) in enumerate(zip(tests, flights, strict=True)):
        shorter = [i for i in drilled if tests[i].seconds < test.seconds and not tests[i].variant]
        others = [i for i in drilled if i != k]
        lead = gains[k] / np.maximum(gains[others].max(axis=0), 1e-9 * before)
        # First what it teaches and others do not
        order = [j for j in np.argsort(-lead) if alone[k, j] < UNTAUGHT_SHARE]
        best = [j for j in order if gains[k, j] > MORE * gains[shorter, j].max(initial=0.0)]
        if test.variant:
            # Whatever the other tests say: the lift of a flight in between can hide a law of heave
            order = best = [j for j, knob in enumerate(knobs) if _shows_law(test, knob.name)]
        planned.append(
            PlannedTest(
                test,
                tuple((knobs[j].name, float(alone[k, j])) for j in order),
                tuple(knobs[j].name for j in best) if k in drilled else (),
                _path_extent(flight),
                k not in drilled or bool(best),
            )
        )
    unknown = tuple(knobs[j].name for j in np.flatnonzero(remaining > UNTAUGHT_SHARE))
    weight = vehicle.heaviness * STANDARD_GRAVITY
    return LabPlan(name, commands, tuple(planned), unknown, weight)


def is_thrust_law(name: str) -> bool:
    """Return whether a parameter is an exponent or a share in reverse, which one step hides."""
    return name.startswith('wrench_gain.exponent_') or 'reverse' in name.partition('.')[2]


def _shows_law(test: LabTest, name: str) -> bool:
    """Return whether a variant of a step, beside it, shows a parameter."""
    if name.startswith('rotor_'):
        return test.variant == 'reverse' and is_thrust_law(name) and test.axis != 'yaw'
    return name == f'wrench_gain.{LAW_TERMS[test.variant]}_{test.axis}' if test.variant else False


def _fit_steps(
    vehicle: Vehicle,
    nominal: NominalVehicle,
    tests: Sequence[LabTest],
    commands: Commands,
    room: float,
) -> list[LabTest]:
    """
    Return the tests with steps whose rehearsed way, on all axes, fits the room. [m]

    Each is followed by its variants. A vehicle that is commanded by duties has no smaller one:
    its file has the curve of each rotor.
    """

    def fit(test: LabTest) -> LabTest:
        while test.share > LEAST_STEP:
            if max(_path_extent(rehearse_test(vehicle, nominal, test, commands))) <= room:
                break
            test = scale_step(vehicle, test)
        return test

    out: list[LabTest] = []
    steps: list[LabTest] = []
    for test in tests:
        if test.kind == 'free_flight':
            out.append(replace(test, parts=tuple(steps)))
        elif test.kind != 'step':
            out.append(test)
        else:
            steps.append(fit(test))
            others = list_step_variants(vehicle, steps[-1])
            out += [steps[-1], *(fit(one) for one in others
                                 if one.variant != 'smaller' or commands == 'wrench')]  # fmt: skip
    return out


def _list_partners(tests: Sequence[LabTest]) -> list[int | None]:
    """Return for each test the step that a variant is compared with, by index."""
    steps = {
        test.axis: k for k, test in enumerate(tests) if test.kind == 'step' and not test.variant
    }
    return [steps[test.axis] if test.variant else None for test in tests]


def _measure_tests(
    vehicle: Vehicle,
    nominal: NominalVehicle,
    flights: Sequence[MeasuredFlight],
    knobs: Sequence[FreeParameter],
    partners: Sequence[int | None],
) -> tuple[Array, Array]:
    """
    Return the information of each test alone, shape (F, K), and the deviation after all.

    That of a test with a partner is of both together. The deviation, shape (K,), is relative to
    that before.
    """
    each = [measure_information(one, vehicle, nominal, knobs) for one in flights]
    gains = np.array([
        _add_information(each[k] + (0.0 if other is None else each[other]), knobs)
        for k, other in enumerate(partners)
    ])  # fmt: skip
    before = np.array([knob.tolerance**-2.0 for knob in knobs])
    remaining: Array = np.sqrt(before / (before + _add_information(np.sum(each, axis=0), knobs)))
    return gains, remaining


def _add_information(information: Array, knobs: Sequence[FreeParameter]) -> Array:
    """
    Return what some flights add to the inverse variance of each parameter, shape (K,).

    With all other parameters free within their tolerances. `information`: shape (K, K).
    """
    before = np.array([knob.tolerance**-2.0 for knob in knobs])
    after = np.diag(np.linalg.inv(information + np.diag(before)))
    gain: Array = np.maximum(1.0 / after - before, 0.0)
    return gain


def rehearse_test(
    vehicle: Vehicle, nominal: NominalVehicle, test: LabTest, commands: Commands
) -> MeasuredFlight:
    """Return the flight of a test with the model of the vehicle file, as a tracker sees it."""
    count = round(test.seconds / GRID_PERIOD)
    time = GRID_PERIOD * np.arange(count + 1, dtype=np.float64)
    weight = vehicle.heaviness * STANDARD_GRAVITY
    if test.is_neutral:
        nominal = nominal.with_value('net_lift', 'force', weight)
    duties, wrench = _build_commands(vehicle, test, commands, weight)
    blank = MeasuredFlight(
        time,
        np.zeros((count + 1, 3)),
        np.tile([0.0, 0.0, 0.0, 1.0], (count + 1, 1)),
        np.full((count + 1, 8), np.nan),
        np.array([POSE_NOISE] * 3 + [TURN_NOISE] * 3 + [np.inf] * (len(ALL_CHANNELS) - 6)),
        np.ones(count + 1, dtype=np.bool_),
        duties,
        np.full(count + 1, np.nan),
        wrench,
    )
    start = _release_state(test)[None]
    replay = FlightReplay(blank, np.array([0]), count, vehicle.pack_command(()))
    rows = replay.build_replay_rows(nominal)
    none = np.zeros((1, replay.span, len(AXES)))
    inputs = replay.compute_body_inputs(rows)
    states = replay.integrate_pieces(rows, inputs, start, none)[0, ::STEPS_PER_PERIOD]
    return replace(blank, position=states[:, :3].copy(), quaternion=states[:, 3:7].copy())


def _release_state(test: LabTest) -> Array:
    """Return the state in which a vehicle is let go."""
    state = np.zeros(13)
    state[2] = HIGH
    state[6] = np.cos(0.5 * test.tilt)
    if test.tilt:
        state[3 + ('roll', 'pitch', 'yaw').index(test.axis)] = np.sin(0.5 * test.tilt)
    state[12] = test.rate
    return state


def _build_commands(
    vehicle: Vehicle, test: LabTest, commands: Commands, weight: float
) -> tuple[Stream, Stream | None]:
    """Return the duties and the commanded wrench of a test."""
    time, levels = _list_levels(test)
    duties = np.zeros((len(time), len(vehicle.rotors)))
    if commands == 'wrench':
        wrench = np.zeros((len(time), len(AXES)))
        for step, level in levels:
            wrench[:, AXES.index(step.axis)] = step.size * level
        if not test.is_neutral:
            wrench[:, AXES.index('heave')] += weight
        return Stream(time[:1], duties[:1, :ACTUATORS]), Stream(time, wrench)
    if not test.is_neutral:
        rest = np.array(rest_duties(vehicle))
        duties += rest
        for step, level in levels:
            duties += level[:, None] * (np.array(step_duties(vehicle, step)) - rest)
    lowest = [-1.0 if rotor.reversible else 0.0 for rotor in vehicle.rotors]
    return Stream(time, np.clip(duties, lowest, 1.0)[:, :ACTUATORS]), None


def _list_levels(test: LabTest) -> tuple[Array, list[tuple[LabTest, Array]]]:
    """Return times [s], and the level of each step: 1 is the whole of it."""
    if test.kind == 'step':
        return np.array([0.0, STEP_REST]), [(test, np.array([0.0, 1.0]))]
    if test.kind != 'free_flight':
        return np.zeros(1), []
    draw = np.random.default_rng(FREE_FLIGHT_SEED)
    time = np.arange(0.0, test.seconds, PILOT_HOLD_TIMES[0])
    levels = []
    for step in test.parts:
        # A pilot holds each command for a while, on each axis by itself
        held = np.cumsum(draw.random(len(time)) < PILOT_HOLD_TIMES[0] / PILOT_HOLD_TIMES[1])
        levels.append((step, draw.choice([-1.0, 0.0, 1.0], len(time))[held - held[0]]))
    return time, levels


def _path_extent(flight: MeasuredFlight) -> tuple[float, float]:
    """Return the horizontal and the vertical extent of a path. [m]"""
    x, y, z = np.ptp(flight.position, axis=0)
    return float(np.hypot(x, y)), float(z)
