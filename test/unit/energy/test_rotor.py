"""A rotor by duty and voltage, against every row of Bitcraze's bench."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.electrical import loads
import numba
import numpy as np
import pytest

LOADS = loads.LoadModel.from_energy(load_vehicle_file('gtmab').energy)
IDLE = loads.BENCH[0].power
DUTY = st.floats(0.01, 1.0)
VOLTAGE = st.floats(3.0, 4.2)


def test_the_bench_is_the_table_of_16_rows_that_is_published():
    assert len(loads.BENCH) == 16
    assert loads.BENCH[8].power == pytest.approx(1.83 * 3.71)
    assert loads.BENCH[8].thrust == pytest.approx(24.4e-3 * 9.80665 / 4)


@pytest.mark.parametrize('row', loads.BENCH, ids=lambda row: f'{100 * row.duty:g}%')
def test_each_row_by_duty_and_voltage(row):
    assert loads.thrust_at_duty(row.duty, row.voltage) == pytest.approx(row.thrust, abs=8e-3)
    power = 4 * loads.power_at_duty(row.duty, row.voltage, LOADS.rotor_offset, LOADS.rotor_slope)
    assert IDLE + power == pytest.approx(row.power, rel=0.09)


def test_the_fit_is_the_least_squares_one():
    rows = loads.BENCH
    mean = np.array([row.duty * row.voltage for row in rows])
    thrust = np.array([row.thrust for row in rows])
    (a, b), *_ = np.linalg.lstsq(np.c_[mean**2, mean], thrust, rcond=None)
    assert (a, b) == pytest.approx((loads.THRUST_BY_SQUARE, loads.THRUST_BY_VOLTAGE), rel=1e-5)
    rms = np.sqrt(
        np.mean((loads.THRUST_BY_SQUARE * mean**2 + loads.THRUST_BY_VOLTAGE * mean - thrust) ** 2)
    )
    assert rms == pytest.approx(2.84e-3, abs=0.01e-3)


def test_the_files_line_through_power_and_thrust_is_the_least_squares_one():
    lift = np.array([4 * row.thrust for row in loads.BENCH])
    power = np.array([row.power for row in loads.BENCH])
    slope, offset = np.polyfit(lift, power, 1)
    assert LOADS.rotor_slope == pytest.approx(slope, rel=1e-3)
    assert 4 * LOADS.rotor_offset == pytest.approx(offset - IDLE, abs=2e-3)


@given(DUTY, VOLTAGE, VOLTAGE)
def test_less_voltage_is_less_power_at_a_duty_and_the_same_at_a_thrust(duty, one, other):
    low, high = sorted((one, other))
    numbers = LOADS.rotor_offset, LOADS.rotor_slope
    assert loads.power_at_duty(duty, low, *numbers) <= loads.power_at_duty(duty, high, *numbers)
    less = duty * low / high  # the same mean voltage
    assert loads.thrust_at_duty(less, high) == pytest.approx(
        loads.thrust_at_duty(duty, low), rel=1e-9
    )
    again = loads.power_at_duty(less, high, *numbers)
    assert again == pytest.approx(loads.power_at_duty(duty, low, *numbers), rel=1e-9)


def test_it_compiles_to_the_same():
    assert numba.njit(loads.thrust_at_duty)(0.4, 3.7) == loads.thrust_at_duty(0.4, 3.7)


def test_a_rotor_turns_either_way_by_hand():
    """A duty of 0.25 at 4 V is 1 V, so that the terms are A + B."""
    assert loads.thrust_at_duty(0.25, 4.0) == pytest.approx(8.64139e-3 + 1.665601e-2)
    assert loads.thrust_at_duty(-0.5, 4.0) == pytest.approx(-(4 * 8.64139e-3 + 2 * 1.665601e-2))
    assert loads.power_at_duty(-0.25, 4.0, 0.5, 10.0) == pytest.approx(0.5 + 0.2529740)
    assert loads.power_at_duty(0.0, 4.0, 0.5, 10.0) == 0.0
