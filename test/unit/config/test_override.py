# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Single parameters of files, replaced by path: found, and of the right kind and unit."""

from lta_config.errors import BadInput
from lta_config.parameter_override import (
    get_parameter,
    OVERRIDE_SOURCE,
    parse_assignment,
    parse_value,
    replace_parameter,
)
from lta_config.schema.spectrum_file import luminous_efficacy
import pytest

FILE = {
    'trim': {'heaviness': {'value': 2, 'unit': 'g', 'source': 'scale'}},
    'air': {'wind': {'value': [0, 1, 2], 'unit': 'm/s'}, 'temperature': '20 degC'},
    'room': {'albedo': 0.5},
    'lamp': {'efficacy': 'white_led'},
    'diodes': {'count': 8},
    'rotor': {'reversible': False},
    'effects': {'motor_lag': {'up': {'value': 72, 'unit': 'ms', 'source': 'paper'}}},
}


def changed(text):
    path, value = parse_assignment(text)
    return get_parameter(replace_parameter(FILE, path, value, 'vehicle'), path, 'vehicle')


@pytest.mark.parametrize(
    ('text', 'found'),
    [
        ('trim.heaviness=4 g', {'value': 4.0, 'unit': 'g', 'source': OVERRIDE_SOURCE}),
        ('trim.heaviness=0.004 kg', {'value': 0.004, 'unit': 'kg', 'source': OVERRIDE_SOURCE}),
        (
            'air.wind=[1, 0, -0.5] m/s',
            {'value': [1, 0, -0.5], 'unit': 'm/s', 'source': OVERRIDE_SOURCE},
        ),
        ('air.temperature = 25 degC', {'value': 25.0, 'unit': 'degC', 'source': OVERRIDE_SOURCE}),
        ('room.albedo=0.25', 0.25),
        ('room.albedo=1', 1.0),
        ('room.albedo=1e-05', 1e-5),
        (
            'air.wind=[1e-05, 0, 0] m/s',
            {'value': [1e-5, 0, 0], 'unit': 'm/s', 'source': OVERRIDE_SOURCE},
        ),
        ('diodes.count=4', 4),
        ('lamp.efficacy=300 lm/W', {'value': 300.0, 'unit': 'lm/W', 'source': OVERRIDE_SOURCE}),
        (
            'lamp.efficacy=sun',
            {'value': luminous_efficacy('sun'), 'unit': 'lm/W', 'source': OVERRIDE_SOURCE},
        ),
        ('rotor.reversible=true', True),
        ('effects.motor_lag.up=0 ms', {'value': 0.0, 'unit': 'ms', 'source': OVERRIDE_SOURCE}),
        ('effects.leak.rate=1 g', {'value': 1.0, 'unit': 'g', 'source': OVERRIDE_SOURCE}),
    ],
)
def test_a_value_is_replaced(text, found):
    assert changed(text) == found


@pytest.mark.parametrize('path', ['effects.leak', 'effects.leak.rate', 'effects.motor_lag.down'])
def test_what_a_file_leaves_out_of_its_effects_is_nothing_yet(path):
    assert get_parameter(FILE, path, 'vehicle') is None


def test_one_of_several_numbers_leaves_the_others():
    given = replace_parameter(FILE, 'air.wind.1', parse_value('0.5 m/s', ''), 'scenario')
    assert given['air']['wind']['value'] == [0, 0.5, 2]
    assert get_parameter(given, 'air.wind.1', 'scenario') == {'value': 0.5, 'unit': 'm/s'}


def test_a_number_in_another_unit_is_put_into_that_of_its_neighbours():
    file = {'size': {'value': [1.0, 2.0], 'unit': 'cm'}}
    given = replace_parameter(file, 'size.0', parse_value('30 mm', ''), 'vehicle')
    assert given['size']['value'] == pytest.approx([3.0, 2.0], rel=1e-15)


def test_what_was_read_stays_as_it_was():
    before = str(FILE)
    changed('trim.heaviness=4 g')
    changed('air.wind.0=4 m/s')
    assert str(FILE) == before


def test_a_named_aero_file_takes_the_place_of_the_block():
    content = {'aero': {'linear_drag': {}}, 'trim': {'heaviness': '1 g'}}
    assert replace_parameter(content, 'aero', 'gtmab', 'vehicle') == {**content, 'aero': 'gtmab'}
    with pytest.raises(BadInput, match='is a group of parameters; set one of its keys: heaviness'):
        replace_parameter(content, 'trim', 'gtmab', 'vehicle')
