# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The cell: its curve, its drop, its relaxation, its age, and that no energy gets lost."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.quantity import Quantity
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.electrical import battery
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

CELL = battery.BatteryModel(capacity=900.0, resistance=0.13)
PAIR = battery.BatteryModel(
    capacity=900.0, resistance=0.15, relaxation_resistance=0.09, relaxation_time=33.0
)
charges = st.floats(0.0, 1.0)


@pytest.mark.parametrize(
    ('charge', 'voltage'),
    [(0.0, 3.27), (0.05, 3.61), (0.025, 3.44), (0.5, 3.84), (0.975, 4.175), (1.0, 4.20)],
)
def test_the_resting_voltage_by_hand(charge, voltage):
    assert battery.open_circuit_voltage(charge) == pytest.approx(voltage, abs=1e-12)


def test_the_curve_is_clipped_at_empty_and_full():
    assert battery.open_circuit_voltage(-0.1) == 3.27
    assert battery.open_circuit_voltage(1.1) == 4.20
    assert battery.state_of_charge(2.0) == 0.0
    assert battery.state_of_charge(5.0) == 1.0


@given(charges)
def test_state_of_charge_is_the_inverse(charge):
    voltage = battery.open_circuit_voltage(charge)
    assert battery.state_of_charge(voltage) == pytest.approx(charge, abs=1e-12)


@pytest.mark.parametrize('charge', [0.0, 0.01, 0.05, 0.33, 0.5, 0.999, 1.0])
def test_stored_energy_is_the_integral_of_voltage(charge):
    knots = [k / 20 for k in range(1, 20) if k / 20 < charge]
    expected = quad(battery.open_circuit_voltage, 0.0, charge, points=knots or None, limit=100)[0]
    assert battery.stored_energy(charge, 900.0) == pytest.approx(900.0 * expected, rel=1e-9)


@given(st.floats(3.2, 4.2), st.floats(-15.0, 15.0), st.floats(0.0, 0.2))
def test_the_current_takes_up_the_power(open_circuit, power, resistance):
    current = battery.current_for_power(open_circuit, power, resistance)
    voltage = battery.terminal_voltage(open_circuit, current, resistance)
    possible = 4.0 * resistance * power > -(open_circuit**2)
    if possible:
        assert voltage * current == pytest.approx(power, rel=1e-9, abs=1e-12)
    else:
        assert voltage == pytest.approx(open_circuit / 2, rel=1e-6)


def test_a_brown_out_halves_the_voltage():
    # 4 V behind 0.2 ohm gives at most 16 / 0.8 = 20 W, at 10 A.
    assert battery.current_for_power(4.0, -25.0, 0.2) == pytest.approx(-10.0)


@pytest.mark.parametrize(('celsius', 'ratio'), [(25.0, 1.0), (0.0, 2.0), (45.0, 0.62)])
def test_cold_raises_the_resistance(celsius, ratio):
    # 18.8 kJ/mol: twice at 0 degC; exp(2261.2 K (1 / 318.15 K - 1 / 298.15 K)) at 45 degC.
    assert battery.resistance_factor(celsius) == pytest.approx(ratio, rel=0.01)


def test_a_worn_and_cold_cell_by_hand():
    file = load_vehicle_file('gtmab').energy
    worn = Quantity(value=20.0, unit='%', source='test')
    cold = Quantity(value=0.0, unit='degC', source='test')
    data = file.battery.model_copy(update={'age': worn, 'temperature': cold})
    cell = battery.BatteryModel.from_energy(file.model_copy(update={'battery': data}))
    assert cell.capacity == pytest.approx(900.0 * 0.8 * 0.85)
    assert cell.resistance == pytest.approx(0.15 * 2.0 * 2.0, rel=0.01)
    assert cell.relaxation_resistance / cell.resistance == pytest.approx(0.627, rel=1e-3)


@pytest.mark.parametrize('power', [-1.333, 0.9])
def test_ten_minutes_are_those_of_an_ordinary_differential_equation(power):
    """Scipy solves the circuit from its equations, with the current from their roots."""

    def rates(_, state):
        charge, relaxation = state
        open_ = np.interp(charge, np.linspace(0.0, 1.0, 21), battery.OPEN_CIRCUIT) + relaxation
        roots = np.roots([0.15, open_, -power])
        current = roots[np.argmin(np.abs(roots))].real
        return current / 900.0, (0.09 * current - relaxation) / 33.0

    exact = solve_ivp(rates, (0.0, 600.0), (0.5, 0.0), rtol=1e-9, atol=1e-12, max_step=5.0).y[
        :, -1
    ]
    charge, relaxation = 0.5, 0.0
    for _ in range(600):
        charge, relaxation, *_ = battery.advance_cell(PAIR, charge, relaxation, power, 1.0)
    assert charge == pytest.approx(exact[0], abs=1e-6)
    assert relaxation == pytest.approx(exact[1], abs=1e-6)


def test_a_cell_of_two_numbers_relaxes_at_once_and_has_the_limits_of_lithium_polymer():
    assert CELL.model_dump() == {
        'capacity': 900.0, 'resistance': 0.13, 'relaxation_resistance': 0.0,
        'relaxation_time': 1.0, 'discharge_cutoff': 3.0, 'charge_cutoff': 4.2,
        'charge_current': 1000.0,
    }  # fmt: skip
    assert battery.relax_voltage(CELL, 0.0, -1.0, 5.0) == (0.0, 0.0)
    assert battery.relaxation_energy(CELL, 0.0) == 0.0
    # 33 s / 0.09 ohm are 366.7 F; 30 mV on them 0.165 J.
    assert battery.relaxation_energy(PAIR, -0.03) == pytest.approx(0.165)
    assert battery.resistive_heat(CELL, 0.0, -2.0, 5.0) == pytest.approx(0.52)
    shipped = battery.BatteryModel.from_energy(load_vehicle_file('gtmab').energy)
    assert (shipped.relaxation_resistance, shipped.relaxation_time) == (0.09405, 33.0)
    assert (shipped.discharge_cutoff, shipped.charge_cutoff, shipped.charge_current) == (
        3.0, 4.2, 0.25,
    )  # fmt: skip


def test_warmth_adds_no_capacity_and_cold_takes_six_thousandths_a_kelvin():
    told = [battery.capacity_factor(celsius) for celsius in (45.0, 25.0, 24.0, -15.0)]
    assert told == pytest.approx([1.0, 1.0, 0.994, 0.76])


def test_the_mean_voltage_between_two_charges_by_hand():
    """
    Between two knots the mean is the middle (3.83 V); across a knot it is weighted (3.845 V).
    """
    assert battery.mean_open_circuit_voltage(0.51, 0.53) == pytest.approx(3.844)
    assert battery.mean_open_circuit_voltage(0.52, 0.52) == pytest.approx(3.844)
    assert battery.mean_open_circuit_voltage(0.45, 0.55) == pytest.approx((3.83 + 3.845) / 2.0)
