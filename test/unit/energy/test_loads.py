"""What goes out, by hand and against published figures."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.electrical import loads
import numba
import numpy as np
from pydantic import ValidationError
import pytest

ENERGY = load_vehicle_file('gtmab').energy
LOADS = loads.LoadModel.from_energy(ENERGY)


@pytest.mark.parametrize('name', ['idle', 'transmitting', 'rotor_offset', 'rotor_slope'])
def test_no_load_is_negative_or_left_out(name):
    given = LOADS.model_dump()
    with pytest.raises(ValidationError, match=name):
        loads.LoadModel(**{**given, name: -0.1})
    del given[name]
    with pytest.raises(ValidationError, match=name):
        loads.LoadModel(**given)


def test_the_papers_electronics():
    assert loads.power_demand(LOADS, (0.0,) * 4, transmitting=False) == pytest.approx(0.097)
    assert loads.power_demand(LOADS, (0.0,) * 4, transmitting=True) == pytest.approx(0.120)


@pytest.mark.parametrize(
    ('amperes', 'grams', 'volts'),
    [(0.94, 10.9, 3.88), (1.83, 24.4, 3.71), (3.06, 41.7, 3.56), (4.44, 57.9, 3.30)],
)
def test_rotors_against_bitcrazes_bench(amperes, grams, volts):
    idle = 0.24 * 4.01  # the bench's own electronics
    thrust = grams * 9.80665e-3 / 4
    rotors = 4 * loads.rotor_power(thrust, LOADS.rotor_offset, LOADS.rotor_slope)
    assert idle + rotors == pytest.approx(amperes * volts, abs=3 * 0.063)


def test_a_still_rotor_takes_nothing_and_thrust_of_either_sign_the_same():
    assert loads.rotor_power(0.0, 0.027, 23.96) == 0.0
    assert loads.rotor_power(0.1, 0.027, 23.96) == pytest.approx(2.423, rel=1e-12)
    assert loads.rotor_power(-0.1, 0.027, 23.96) == loads.rotor_power(0.1, 0.027, 23.96)


@given(st.lists(st.floats(-0.2, 0.2), max_size=8))
def test_demand_does_not_depend_on_the_order_of_rotors(thrusts):
    forwards = loads.power_demand(LOADS, thrusts, transmitting=True)
    assert forwards == pytest.approx(loads.power_demand(LOADS, thrusts[::-1], True), rel=1e-12)
    spinning = np.count_nonzero(thrusts)
    expected = 0.120 + 0.027 * spinning + 23.96 * np.abs(thrusts).sum()
    assert forwards == pytest.approx(expected, rel=1e-12)


def test_a_rotor_compiles_to_the_same():
    assert numba.njit(loads.rotor_power)(0.1, 0.027, 23.96) == loads.rotor_power(0.1, 0.027, 23.96)
