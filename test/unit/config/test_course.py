# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Courses and manoeuvres: what is asked for between and at their rows."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_config.course import Course, hashed_uniform
from lta_config.files import list_shipped_names
from lta_config.schema.comparison_file import (
    load_comparison,
    ManeuverFile,
)
import numpy as np
import pytest
import yaml

ROWS = [
    {'at': '2 s', 'altitude': '1 m', 'heading': '0 deg', 'speed': '0 m/s'},
    {'at': '6 s', 'altitude': '3 m', 'heading': '90 deg', 'speed': '0.4 m/s'},
    {'at': '8 s', 'altitude': '0 m', 'heading': '90 deg', 'speed': '0 m/s'},
]
SHAKE = {'duty': '20 %', 'hold': '0.5 s'}


def made(**changes):
    return Course.model_validate({'between': 'step', 'rows': ROWS, 'shake': SHAKE} | changes)


def test_it_stays_down_until_its_first_row_and_then_jumps_or_goes_straight():
    step, ramp = made(), made(between='ramp')
    assert step.setpoint_at(1.99) == (0.0, 0.0, 0.0)
    assert step.setpoint_at(5.99) == (1.0, 0.0, 0.0)
    assert step.setpoint_at(6.0) == pytest.approx((3.0, math.pi / 2, 0.4))
    assert ramp.setpoint_at(3.0) == pytest.approx((1.5, math.pi / 8, 0.1))
    assert ramp.setpoint_at(99.0) == pytest.approx((0.0, math.pi / 2, 0.0))


def test_motors_are_shaken_between_the_rows_alone_and_never_started():
    course, duties = made(), (0.5, 0.5)
    assert course.excite_duties(1.99, duties, (False, False)) == duties
    assert course.excite_duties(8.0, duties, (False, False)) == duties
    assert course.excite_duties(3.0, (0.0, 0.0), (False, False)) == (0.0, 0.0)
    assert made(shake=None).excite_duties(3.0, duties, (False, False)) == duties
    first, second = course.excite_duties(3.0, duties, (False, False))
    assert first == 0.5 + 0.2 * hashed_uniform(6, 0)  # the seventh hold of half a second
    assert second == 0.5 + 0.2 * hashed_uniform(6, 1)  # of 3.309 s
    assert course.excite_duties(3.49, duties, (False, False))[0] == first


@given(st.floats(0.0, 10.0), st.floats(-1.0, 1.0), st.booleans(), st.floats(0.01, 0.5))
def test_no_duty_leaves_what_a_rotor_can(time, duty, reversible, size):
    if not reversible:
        duty = abs(duty)
    shake = {'duty': {'value': size, 'unit': '1'}, 'hold': '0.3 s'}
    (got,) = made(shake=shake).excite_duties(time, (duty,), (reversible,))
    assert (-1.0 if reversible else 0.0) <= got <= 1.0
    assert abs(got - duty) <= size + 1e-12


def test_the_numbers_are_even():
    drawn = np.array([[hashed_uniform(i, k) for i in range(2000)] for k in range(4)])
    assert np.abs(drawn).max() < 1.0
    assert np.abs(drawn.mean(axis=1)).max() < 4.0 / math.sqrt(3.0 * 2000)
    assert drawn.std(axis=1) == pytest.approx(1.0 / math.sqrt(3.0), rel=0.05)
    assert np.abs(np.corrcoef(drawn) - np.eye(4)).max() < 4.0 / math.sqrt(2000)


MANOEUVRE = yaml.safe_load(
    """
schema: 1
name: test
about: A test.
judge: speed
from: 4 s
until: 10 s
band: 5 cm
between: ramp
course:
  - {at: 2 s, rise: 1 m, heading: 0 deg, speed: 0 m/s}
  - {at: 6 s, rise: 3 m, heading: 90 deg, speed: 0.4 m/s}
"""
)


def made_manoeuvre(**changes):
    content = MANOEUVRE | changes
    content.setdefault('band', '0.05 m/s')
    return ManeuverFile.model_validate(content)


def test_between_rows_it_goes_straight_or_jumps():
    ramp, step = made_manoeuvre(band='0.1 m/s'), made_manoeuvre(band='0.1 m/s', between='step')
    assert ramp.setpoint_at(1.999) == (0.0, 0.0, 0.0)
    assert ramp.setpoint_at(3.0) == pytest.approx((1.5, 3.14159265 / 8, 0.1))
    assert ramp.setpoint_at(60.0) == pytest.approx((3.0, 3.14159265 / 2, 0.4))
    assert step.setpoint_at(5.999) == (1.0, 0.0, 0.0)
    assert step.setpoint_at(6.0) == pytest.approx((3.0, 3.14159265 / 2, 0.4))


def test_the_shipped_comparison_names_what_there_is():
    comparison = load_comparison('platforms')
    flown = {each.manoeuvre for each in comparison.limits.values()}
    assert flown <= {*list_shipped_names('manoeuvres')}
    # A vehicle may ship without taking part; a line in the comparison enters it.
    assert {each.vehicle for each in comparison.contestants.values()} <= {
        *list_shipped_names('vehicles')
    }
