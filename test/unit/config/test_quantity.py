# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Quantities: units against their definitions, and one sentence for each way to get one wrong."""

import math
from typing import Annotated

from hypothesis import given
from hypothesis import strategies as st
from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity, SI_UNITS
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


def test_bounds_are_closed():
    assert Part.model_validate({'place': {'value': [-1, 100e-2, 1], 'unit': 'm'}}).mass.si == 1.0
