# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Choose the tests that a vehicle needs: rehearse each, and see which parameters it informs.

A rehearsal flies the test with the model of the vehicle file and computes what its poses would
teach, with the filter of a calibration. A test is needed if it teaches something much better than
all shorter ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.lab_tests.design import (
    LabTest,
    LEAST_STEP,
    list_designed_tests,
    list_step_variants,
    LONGEST_WAY,
    scale_step,
)
from lta_discovery.lab_tests.rehearsal import (
    build_commands,
    Commands,
    measure_information,
    path_extent,
    rehearse_test,
)
from lta_discovery.model.calibration_parameters import (
    list_calibration_parameters,
    list_reversed_rotors,
    list_wrench_laws,
    set_references,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MORE: Final = 2.0  # times the information of any shorter test; a test that has it is needed
NO_WRENCH: Final = np.zeros((0, len(AXES)))  # no commanded wrench
UNTAUGHT_SHARE: Final = 0.8  # of the deviation before; a larger one means that no test teaches it
LAW_TERMS: Final = {'smaller': 'exponent', 'reverse': 'reverse'}  # that a variant shows


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
    tests = list_fitting_tests(vehicle, nominal, commands, room)
    # Without the free flight, whose sizes are those of the pilot
    orders = [build_commands(vehicle, test, commands, 0.0) for test in tests[:-1]]
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
                path_extent(flight),
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


def list_fitting_tests(
    vehicle: Vehicle, nominal: NominalVehicle, commands: Commands, room: float
) -> list[LabTest]:
    """
    Return the tests of a vehicle, with steps whose rehearsed way, on all axes, fits the room [m].

    Each is followed by its variants. A vehicle that is commanded by duties has no smaller one:
    its file has the curve of each rotor.
    """

    def fit(test: LabTest) -> LabTest:
        while test.share > LEAST_STEP:
            if max(path_extent(rehearse_test(vehicle, nominal, test, commands))) <= room:
                break
            test = scale_step(vehicle, test)
        return test

    out: list[LabTest] = []
    steps: list[LabTest] = []
    for test in list_designed_tests(vehicle, room):
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
