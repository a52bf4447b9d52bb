# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Manoeuvres and comparisons: what they ask for when."""

from lta_config.files import list_shipped_names
from lta_config.schema.comparison_file import (
    load_comparison,
    ManeuverFile,
)
import pytest
import yaml

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


def made(**changes):
    content = MANOEUVRE | changes
    content.setdefault('band', '0.05 m/s')
    return ManeuverFile.model_validate(content)


def test_between_rows_it_goes_straight_or_jumps():
    ramp, step = made(band='0.1 m/s'), made(band='0.1 m/s', between='step')
    assert ramp.setpoint_at(1.999) == (0.0, 0.0, 0.0)
    assert ramp.setpoint_at(3.0) == pytest.approx((1.5, 3.14159265 / 8, 0.1))
    assert ramp.setpoint_at(60.0) == pytest.approx((3.0, 3.14159265 / 2, 0.4))
    assert step.setpoint_at(5.999) == (1.0, 0.0, 0.0)
    assert step.setpoint_at(6.0) == pytest.approx((3.0, 3.14159265 / 2, 0.4))


def test_the_shipped_comparison_names_what_there_is():
    comparison = load_comparison('platforms')
    asked = {*comparison.manoeuvres}
    for each in comparison.contestants.values():
        asked |= {*(each.manoeuvres or ())}
    for each in comparison.ablations.values():
        asked |= {*each.manoeuvres}
        assert each.why  # an ablation says what it changes
    assert asked <= {*list_shipped_names('manoeuvres')}
    # A vehicle may ship without taking part; a line in the comparison enters it.
    assert {each.vehicle for each in comparison.contestants.values()} <= {
        *list_shipped_names('vehicles')
    }
