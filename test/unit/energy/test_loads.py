# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What goes out, by hand, against the paper and against every row of Bitcraze's bench."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_model.electrical import loads
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.world import World
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


def test_a_rotor_turns_either_way_by_hand():
    """A duty of 0.25 at 4 V is 1 V, so that the terms are A + B."""
    assert loads.thrust_at_duty(0.25, 4.0) == pytest.approx(8.64139e-3 + 1.665601e-2)
    assert loads.thrust_at_duty(-0.5, 4.0) == pytest.approx(-(4 * 8.64139e-3 + 2 * 1.665601e-2))
    assert loads.power_at_duty(-0.25, 4.0, 0.5, 10.0) == pytest.approx(0.5 + 0.2529740)
    assert loads.power_at_duty(0.0, 4.0, 0.5, 10.0) == 0.0


def test_navigation_takes_what_the_paper_prints_beyond_hovering():
    """1523 to 1544 mW of BAG, DES and DGA, less 1333 mW of hovering."""
    beyond = [loads.navigation_power(ENERGY, name) for name in ('bag', 'des', 'dga')]
    assert beyond == pytest.approx([0.190, 0.2005, 0.211])


def test_who_does_not_look_takes_nothing_and_an_unknown_strategy_senses_alone():
    assert loads.navigation_power(ENERGY, '') == 0.0
    assert loads.navigation_power(ENERGY, 'mine') == pytest.approx(0.190)
    assert loads.navigation_power(load_vehicle_file('multirotor').energy, 'bag') == 0.0


@pytest.mark.parametrize('strategy', ['', 'bag', 'dga'])
def test_the_cell_of_a_flight_feeds_what_lamps_are_found_with(strategy):
    world = World(
        load_vehicle('gtmab'), load_scenario('lamp_room'), load_topic_table(), 1, strategy
    )
    for _ in range(100):
        world.advance((0.0,) * 4)
    assert world.supply.energy_totals.consumed == pytest.approx(
        0.120 + loads.navigation_power(ENERGY, strategy), rel=1e-6
    )
