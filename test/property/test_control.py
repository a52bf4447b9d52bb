# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Laws of the control cores over what they may be asked."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_control.allocation import (
    allocate,
    create_working_array,
    DUTY_SCRATCH,
    EQUAL_WEIGHTS,
    NO_ROTORS,
    pad_to_slots,
    RIDGE,
    Rotors,
    thrusts_to_duties,
    WEIGHTS,
)
from lta_control.laws import load_gains
from lta_control.laws.cascade import (
    CascadeLawConstants,
    CascadeLawMemory,
    control_step,
    pid_step,
    PidGains,
    steer_to_course,
)
from lta_control.motion import CascadeMeasurement, Setpoint, wrap_angle
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.optimize import lsq_linear

ROTORS = build_rotors(load_vehicle('gtmab'))
REVERSIBLE = ROTORS._replace(low=tuple(-x for x in ROTORS.high))
ROOT = np.sqrt(np.array(WEIGHTS))[:, None]
FULL = ROTORS.high[0]

force = st.floats(-0.5, 0.5)
moment = st.floats(-0.05, 0.05)
thrust = st.floats(0.0, FULL)
number = st.floats(-10.0, 10.0)
angle = st.floats(-4.0, 4.0)


def any_rotors(number):
    """Return rotors that point anywhere, each with its own limits; every second one reverses."""
    generator = np.random.default_rng(number)
    axes = generator.normal(size=(number, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    columns = np.hstack([axes, np.cross(generator.uniform(-0.4, 0.4, (number, 3)), axes)])
    a, b = generator.uniform(0.01, 0.2, (2, number)).tolist()
    high = [p + q for p, q in zip(a, b, strict=True)]
    low = [-full if index % 2 else 0.0 for index, full in enumerate(high)]
    empty = ((0.0,) * 6,) * (8 - number)
    return Rotors(
        number,
        (*map(tuple, columns.tolist()), *empty),
        pad_to_slots(low),
        pad_to_slots(high),
        0.0,
        pad_to_slots(a),
        pad_to_slots(b),
    )


FELT = np.count_nonzero(WEIGHTS)  # axes; more rotors have a choice, and stay where they are
FLEET = {'forward only': ROTORS, 'reversible': REVERSIBLE}
FLEET |= {f'{number} anywhere': any_rotors(number) for number in range(1, 9)}


@pytest.mark.parametrize('rotors', FLEET.values(), ids=FLEET.keys())
@settings(max_examples=60)
@given(
    st.tuples(force, force, force, moment, moment, moment),
    st.tuples(*(thrust,) * 8),
)
def test_allocation_is_the_bounded_least_squares_solution(rotors, wrench, start):
    wanted, used = np.array(wrench), slice(rotors.number)
    matrix = np.array(rotors.allocation[used]).T

    def objective(thrusts):
        return float(np.sum((ROOT[:, 0] * (matrix @ thrusts - wanted)) ** 2))

    ridge = RIDGE * float(np.mean(np.sum((ROOT * matrix) ** 2, axis=0)))
    limits = (np.array(rotors.low[used]), np.array(rotors.high[used]))
    best = lsq_linear(ROOT * matrix, ROOT[:, 0] * wanted, limits, 'bvls', tol=1e-15)
    least = objective(best.x)
    asked = objective(np.zeros(rotors.number))  # what is at stake
    for begin in NO_ROTORS, start, pad_to_slots(best.x.tolist()):
        thrusts, delivered = allocate(rotors, wrench, begin, create_working_array())
        # With the ridge it is the least of objective + ridge |t - begin|^2.
        away = best.x - np.clip(begin[used], *limits)
        kept = ridge * float(away @ away) if rotors.number > FELT else 0.0
        assert objective(thrusts[used]) - least <= kept + 1e-9 * asked + 1e-15
        assert all(
            low <= t <= high for low, t, high in zip(rotors.low, thrusts, rotors.high, strict=True)
        )
        np.testing.assert_allclose(delivered, matrix @ thrusts[used], atol=1e-12)


def test_the_scratch_numbers_do_not_matter():
    wrench, start = (0.3, 0.0, 0.2, 0.0, 0.0, 0.01), pad_to_slots((0.1, 0.0, 0.05))
    spoiled = [math.nan] * DUTY_SCRATCH
    for rotors in FLEET.values():
        once = allocate(rotors, wrench, start, create_working_array())
        assert allocate(rotors, wrench, start, spoiled) == once
        assert allocate(rotors, wrench, start, spoiled) == once


@given(st.floats(-5.0, 5.0), st.floats(0.0, 1.0), st.floats(0.01, 1.0))
def test_duty_inverts_any_curve(size, a, b):
    rotors = ROTORS._replace(number=2, a=(a,) * 8, b=(b,) * 8, reverse=EQUAL_WEIGHTS)
    thrusts = pad_to_slots((size, -size))
    u, opposite, *unused = thrusts_to_duties(rotors, thrusts, create_working_array())
    assert (a * abs(u) + b) * u == pytest.approx(size, rel=1e-12, abs=1e-300)
    assert opposite == -u
    assert unused == [0.0] * 6


@given(st.tuples(number, number, number, number), number, st.floats(0.001, 0.1))
def test_pid_stays_within_its_limits(signals, limit, dt):
    integral, error, rate, shortfall = signals
    gains = PidGains.model_construct(kp=1.0, ki=0.5, kd=0.2, limit=abs(limit))
    output, _ = pid_step(gains, integral, error, rate, shortfall, dt)
    assert abs(output) <= abs(limit)


@given(angle, angle, number, number, st.floats(0.0, 3.0))
def test_course_never_asks_for_more_than_the_setpoint(nose, wanted, surge, sway, speed):
    gains = load_gains('gtmab')
    measured = CascadeMeasurement(0.5, 0.0, nose, 0.0, surge, sway, 0.0)
    turn, asked, along, _ = steer_to_course(gains, measured, Setpoint(0.5, wanted, speed))
    assert 0.0 <= asked <= speed
    assert abs(wrap_angle(nose + turn - wanted)) <= gains.drift_limit + 1e-12
    assert abs(along) <= math.hypot(surge, sway) + 1e-12


@given(angle, angle, number, number, st.floats(0.0, 3.0))
def test_course_is_the_same_mirrored(nose, wanted, surge, sway, speed):
    gains = load_gains('gtmab')
    left = steer_to_course(
        gains,
        CascadeMeasurement(0.5, 0.0, nose, 0.0, surge, sway, 0.0),
        Setpoint(0.5, wanted, speed),
    )
    right = steer_to_course(
        gains,
        CascadeMeasurement(0.5, 0.0, -nose, 0.0, surge, -sway, 0.0),
        Setpoint(0.5, -wanted, speed),
    )
    assert right == pytest.approx((-left[0], left[1], left[2], left[3]), abs=1e-12)


@given(
    st.tuples(st.floats(-1.0, 5.0), number, angle, number, number, number, number),
    st.tuples(st.floats(0.0, 5.0), angle, st.floats(0.0, 3.0)),
)
def test_duties_are_what_the_rotors_accept(measured, setpoint):
    gains = load_gains('gtmab')
    memory, constants = CascadeLawMemory(), CascadeLawConstants(gains, ROTORS, (0.0, 0.092))
    for _ in range(3):
        memory = control_step(
            constants,
            memory,
            CascadeMeasurement(*measured),
            Setpoint(*setpoint),
            0.01,
            create_working_array(),
        )
        assert all(0.0 <= u <= 1.0 + 1e-12 for u in memory.command.duties)
        assert all(map(math.isfinite, (*memory.cascade[:3], *memory.thrusts, *memory.shortfall)))
