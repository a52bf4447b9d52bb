# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the test that tells two effects of a vehicle apart, or what to measure instead.

Each test is rehearsed with the model of the vehicle file. How much its poses favour the true
effect follows from what they teach about both, with all other numbers free within their
tolerances.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput, unknown_name_error
from lta_discovery.formatting import format_number, format_parameter
from lta_discovery.lab_tests.design import LabTest, LONGEST_WAY
from lta_discovery.lab_tests.plan import list_fitting_tests
from lta_discovery.lab_tests.rehearsal import Commands, measure_information, rehearse_test
from lta_discovery.lab_tests.words import format_instruction
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.settings import LEAST_GAIN
from lta_model.vehicle import Vehicle
from lta_report.report import Report, TextTable
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ASSUMED_SIZE: Final = 2.0  # typical sizes of an effect, or of three tolerances if that is more
# Of the evidence that a name needs; what is found scatters about what is expected
MARGIN: Final = 2.0
MEASURE: Final = (
    (
        {'net_lift', 'payload', 'ballast', 'gas_purity'},
        'each acts as a constant force; weigh the vehicle on a scale, without and with gas',
    ),
    (
        {'tracker_delay', 'clock_offset', 'command_delay'},
        'each is a delay; tap the vehicle and compare when its IMU and the tracker record it',
    ),
    (
        {'added_mass', 'cg_height', 'thrust_scale', 'added_inertia', 'motor_lag'},
        'they scale the response alike; measure the thrust on a scale, or fly a known payload',
    ),
    (
        {'rotor_misalignment', 'rotor_fault', 'cg_offset', 'tracker_misalignment'},
        'check the rotors, level the tracker, and measure one of these effects on its own',
    ),
    (
        {'linear_drag', 'quadratic_drag', 'cross_flow'},
        'tow the vehicle at two known speeds, or let it glide to rest with its motors off',
    ),
)  # effects that flights confuse, and the measurement that separates them
OTHERWISE: Final = 'measure one of these effects on its own'


@final
class SeparatingTest(NamedTuple):
    """A test, and how much it favours the true one of two effects."""

    test: LabTest
    nats: float  # expected logarithm of the Bayes factor, of the effect that it shows less


def rate_tests(
    vehicle: Vehicle,
    first: str,
    second: str,
    commands: Commands = 'rotors',
    room: float = LONGEST_WAY,
) -> list[SeparatingTest]:
    """
    Return the tests of a vehicle with what each tells of two effects.

    `first`, `second`: of parameters: 'linear_drag.surge', 'quadratic_drag.surge'. Others as in
    `plan_lab_tests`. Raise `BadInput` for an unknown effect, or a vehicle without tests.
    """
    nominal = NominalVehicle.from_vehicle(vehicle)
    parameters = list_free_parameters(nominal, commands == 'wrench')
    names = [one.name for one in parameters]
    for name in (first, second):
        if name not in names:
            names = [one.name for one in parameters if one.typical > 0.0]
            raise unknown_name_error('effect', name, names)
    if first == second:
        raise BadInput(f"'{first}' is given twice; name two different effects.")
    a, b = names.index(first), names.index(second)
    out = []
    for test in list_fitting_tests(vehicle, nominal, commands, room):
        flight = rehearse_test(vehicle, nominal, test, commands)
        information = measure_information(flight, vehicle, nominal, parameters)
        # Either may be the true one
        pairs = ((a, b), (b, a))
        nats = min(predict_evidence(information, parameters, *pair) for pair in pairs)
        out.append(SeparatingTest(test, nats))
    return out


def predict_evidence(
    information: Array, parameters: Sequence[FreeParameter], true: int, other: int
) -> float:
    """
    Return the expected log Bayes factor of a true effect over another one [nats].

    A lower bound, because the other one may take its best-fitting value. `information`: of a test
    about the parameters, shape (K, K).
    """
    tolerance = np.array([one.tolerance for one in parameters])
    own = np.array([one.per_flight for one in parameters], dtype=np.bool_)
    shared = ~own & (tolerance > 0.0)
    shared[[true, other]] = False
    # What a flight has of its own adds to the shared value of the same parameter
    for which in (own & (tolerance > 0.0), shared):
        at = np.flatnonzero(which)
        inner = information[np.ix_(at, at)] + np.diag(tolerance[at] ** -2.0)
        information = information - information[:, at] @ np.linalg.solve(inner, information[at])
    alone, both, rival = (
        information[true, true],
        information[true, other],
        information[other, other],
    )
    # What the other one explains by a change of its value
    explained = both**2 / rival if rival > 0.0 else 0.0
    one = parameters[true]
    size = ASSUMED_SIZE * max(one.typical, 3.0 * one.tolerance)
    return 0.5 * size**2 * max(0.0, float(alone - explained))


def build_separation_report(
    vehicle: str, pair: tuple[str, str], rated: Sequence[SeparatingTest]
) -> Report:
    """Return the report of the tests that tell two effects apart, the shortest first."""
    first, second = map(format_parameter, pair)
    limit = MARGIN * LEAST_GAIN
    ranked = sorted(rated, key=lambda one: (one.nats < limit, one.test.seconds, -one.nats))
    best = ranked[0]
    decides = best.nats >= limit
    headline = (
        f'To tell {first} from {second}, {format_instruction(best.test)}.'
        if decides
        else f'No test tells {first} from {second}: {suggest_measurement(pair)}.'
    )
    rows = [
        [one.test.name, format_instruction(one.test), format_number(one.nats, 2)]
        for one in sorted(rated, key=lambda one: -one.nats)
    ]
    note = (
        f'Expected evidence for the true effect by the poses of the test, in nats; a name needs '
        f'{LEAST_GAIN:.1f}, and a test is proposed from {limit:.1f} on. Each effect has '
        f'{ASSUMED_SIZE:g} typical sizes.'
    )
    return Report(
        command='tests between',
        subject=', '.join(pair),
        headline=headline,
        introduction=f'Each test was rehearsed with the vehicle file {vehicle}.',
        tiles=[],
        blocks=(TextTable('Tests', ('test', 'how', 'evidence'), rows, note),),
        data={
            'test': best.test.name if decides else None,
            'advice': headline,
            'tests': [
                {'test': one.test.name, 'seconds': one.test.seconds, 'expected_nats': one.nats}
                for one in rated
            ],
        },
    )


def suggest_measurement(pair: tuple[str, str]) -> str:
    """Return how to separate effects that no flight separates."""
    effects = {one.partition('.')[0] for one in pair}
    return next((what for group, what in MEASURE if effects <= group), OTHERWISE)
