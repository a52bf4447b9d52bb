"""Quantities: units against their definitions, and one sentence for each way to get one wrong."""

import math
from typing import Annotated

from hypothesis import given
from hypothesis import strategies as st
from lta_config import quantity as quantity_module
from lta_config.files import format_error, StrictModel
from lta_config.quantity import Quantity, si_quantity, SI_UNITS
from pydantic import ValidationError
import pytest

SI = {'1', 'm', 'm2', 'kg', 's', 'Hz', 'rad', 'N', 'Pa', 'V', 'A', 'ohm', 'W', 'C', 'lx', 'lm'}


@pytest.mark.parametrize(
    ('text', 'unit', 'value'),
    [
        ('7 m', 'm', 7.0),
        ('-8 cm', 'm', -0.08),
        ('25mm2', 'm2', 25e-6),
        ('.5 g', 'kg', 0.0005),
        ('180 deg', 'rad', math.pi),
        ('360 deg/s', 'rad/s', 2 * math.pi),
        ('2 min', 's', 120.0),
        ('1e2 Hz', 'Hz', 100.0),
        ('10. kHz', 'Hz', 1e4),
        ('1013.25 hPa', 'Pa', 101325.0),
        ('250 mA h', 'C', 900.0),  # 0.25 A for an hour
        ('1 A h', 'C', 3600.0),
        ('50 %', '1', 0.5),
        ('3 N s2/m2', 'N s2/m2', 3.0),
        ('20 degC', 'degC', 20.0),
        ('0.34 g/cm2', 'kg/m2', 3.4),  # 0.34e-3 kg on 1e-4 m2
        ('0.089 s/cm2', 's/m2', 890.0),
        ('0.05 %/K', '1/K', 5e-4),
    ],
)
def test_text_is_read_into_si(text, unit, value):
    quantity = Quantity.model_validate(text)
    assert quantity.dimension == unit
    assert quantity.si == pytest.approx(value, rel=1e-15)
    assert quantity.vector == (quantity.si,)


def test_a_vector_keeps_unit_and_source():
    quantity = Quantity.model_validate({'value': [0, 1.5, -8], 'unit': 'cm', 'source': 'scale'})
    assert quantity.vector == pytest.approx((0.0, 0.015, -0.08), rel=1e-15)
    assert (quantity.unit, quantity.source) == ('cm', 'scale')


@given(
    st.floats(allow_nan=False, allow_infinity=False, min_value=-1e200, max_value=1e200),
    st.sampled_from(sorted(SI_UNITS)),
)
def test_every_number_and_unit_survives_writing(number, unit):
    read = Quantity.model_validate(f'{number!r} {unit}')
    assert (read.value, read.unit) == (number, unit)
    assert read.si == number * SI_UNITS[unit][1]


def test_units_convert_to_units_that_convert_to_themselves():
    for unit, (base, factor) in SI_UNITS.items():
        assert factor > 0.0, unit
        if base in SI_UNITS:
            assert SI_UNITS[base] == (base, 1.0), unit
        else:
            assert base in SI, unit


class Part(StrictModel):
    mass: Annotated[Quantity, si_quantity('kg', above=0.0, high=5.0, sourced=True)] = Quantity(
        value=1.0, unit='kg', source='assumed'
    )
    place: Annotated[Quantity, si_quantity('m', low=-1.0, high=1.0, length=3)] = Quantity(
        value=(0.0, 0.0, 0.0), unit='m'
    )


@pytest.mark.parametrize(
    ('given', 'message'),
    [
        ({'mass': 1}, 'mass is 1 and has no unit; write for example "1 kg".'),
        ({'mass': True}, 'mass is True and has no unit; add one, as in "7 m".'),
        ({'mass': 'kg'}, 'mass is "kg", but must be a number and a unit, such as "7 m".'),
        ({'mass': '7'}, 'mass is "7", but must be a number and a unit, such as "7 m".'),
        ({'mass': 'nan kg'}, 'mass is "nan kg", but must be a number and a unit, such as'),
        ({'mass': '\u0661 kg'}, 'mass is "\u0661 kg", but must be a number and a unit,'),
        ({'mass': '1e999 kg'}, 'mass is inf, which is not a finite number.'),
        ({'mass': {'value': math.nan, 'unit': 'kg'}}, 'mass is nan, which is not a finite number'),
        ({'mass': {'value': 10**400, 'unit': 'kg'}}, 'mass has a number that is too large;'),
        ({'mass': {'value': 1}}, 'mass has no unit; add one, as in "unit: m".'),
        ({'mass': {'unit': 'kg'}}, "the key 'mass.value' is missing; add it."),
        ({'mass': {'value': 'x', 'unit': 'kg'}}, "mass has the value 'x', but must be a number"),
        ({'mass': {'value': True, 'unit': 'kg'}}, 'mass has the value True, but must be a number'),
        (
            {'mass': {'value': [[1]], 'unit': 'kg'}},
            'mass has the value [[1]], but must be a number',
        ),
        ({'mass': {'value': 1, 'unit': 'kg', 'sorce': 'x'}}, "the key 'mass.sorce' is not known;"),
        ({'mass': '1 lb'}, 'mass has the unknown unit "lb"; known: 1, %, m, cm'),
        ({'mass': '1 m'}, 'mass is in m, but must be in kg or a compatible unit.'),
        ({'mass': '0 g'}, 'mass is 0 g, but must be above 0 and at most 5000 g.'),
        ({'mass': '-3 g'}, 'mass is -3 g, but must be above 0 and at most 5000 g.'),
        ({'mass': '5001 g'}, 'mass is 5001 g, but must be above 0 and at most 5000 g.'),
        ({'mass': '1 g'}, 'mass has no source; state where the value comes from, as in'),
        ({'place': '1 m'}, 'place has 1 number, but needs 3.'),
        ({'place': {'value': [], 'unit': 'm'}}, 'place has 0 numbers, but needs 3.'),
        (
            {'place': {'value': [0, 0, 1.1], 'unit': 'm'}},
            'is [0, 0, 1.1] m, but must be from -1 to 1 m.',
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(given, message):
    with pytest.raises(ValidationError) as caught:
        Part.model_validate(given)
    assert message in format_error(caught.value)


def test_a_number_that_is_finite_only_outside_si_is_refused():
    with pytest.raises(ValidationError, match='not a finite number'):
        Quantity.model_validate('1e307 kHz')


def test_bounds_are_closed():
    assert Part.model_validate({'place': {'value': [-1, 100e-2, 1], 'unit': 'm'}}).mass.si == 1.0


def test_a_number_that_yaml_takes_for_text():
    for text, told in (('1e-9', 'with a decimal point, as in 1.0e-3'), ('many', 'numbers')):
        with pytest.raises(ValueError, match=r'must be a number') as caught:
            quantity_module._parse_numbers(text)
        assert str(caught.value).endswith(told)
