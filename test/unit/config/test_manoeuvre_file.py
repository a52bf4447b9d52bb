"""Manoeuvres and comparisons: what they ask for when, and what they refuse."""

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.comparison_file import (
    ComparisonFile,
    load_comparison,
    load_maneuver_file,
    ManeuverFile,
)
from pydantic import ValidationError
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


@pytest.mark.parametrize(
    ('changes', 'sentence'),
    [
        ({}, 'has a tolerance band of 5 cm; give one above 0 in m/s'),
        ({'band': '0 m/s'}, 'has a tolerance band of 0 m/s'),
        ({'band': '0.1 m/s', 'until': '3 s'}, 'has "from" at 4 s and "until" at 3 s'),
        ({'band': '0.1 m/s', 'course': MANOEUVRE['course'][::-1]}, 'sort the rows by time'),
        ({'band': '0.1 m/s', 'wind': '1 m/s'}, 'wind'),
    ],
)
def test_what_cannot_be_is_refused(changes, sentence):
    with pytest.raises(ValidationError, match=sentence):
        ManeuverFile.model_validate(MANOEUVRE | changes)


@pytest.mark.parametrize('name', list_shipped_names('manoeuvres'))
def test_shipped_manoeuvres_are_what_their_files_are_called(name):
    assert load_maneuver_file(name).name == name


def test_an_unknown_manoeuvre_lists_the_known():
    with pytest.raises(BadInput, match='climb'):
        load_maneuver_file('climbing')


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


def test_an_ablation_of_nobody_is_refused():
    content = load_yaml(find_file('comparison', 'platforms'))
    content['ablations']['beavis_neutral']['of'] = 'beaver'
    with pytest.raises(ValidationError, match='beaver", which is not the name of a contestant'):
        ComparisonFile.model_validate(content)


def test_speeds_that_do_not_rise_are_refused():
    content = load_yaml(find_file('comparison', 'platforms'))
    content['limits']['sblimp']['speeds'] = {'value': [0.5, 0.4], 'unit': 'm/s'}
    with pytest.raises(ValidationError, match=r'invalid "speeds" in limits\.sblimp'):
        ComparisonFile.model_validate(content)
