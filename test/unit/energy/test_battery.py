"""The cell: its curve, its drop, its limits, and that no energy gets lost."""

from types import FunctionType

from hypothesis import given
from hypothesis import strategies as st
from lta_config.vehicle_file import load_vehicle_file
from lta_energy import battery
from lta_energy.books import Books, enter
import numba
import numpy as np
from pydantic import ValidationError
import pytest
from scipy.integrate import quad

CELL = battery.Battery(capacity=900.0, resistance=0.13)
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


@given(charges, charges)
def test_a_fuller_cell_has_more_voltage_and_energy(one, other):
    low, high = sorted((one, other))
    assert battery.open_circuit_voltage(low) <= battery.open_circuit_voltage(high)
    assert battery.stored_energy(low, 900.0) <= battery.stored_energy(high, 900.0)


@pytest.mark.parametrize('charge', [0.0, 0.01, 0.05, 0.33, 0.5, 0.999, 1.0])
def test_stored_energy_is_the_integral_of_voltage(charge):
    knots = [k / 20 for k in range(1, 20) if k / 20 < charge]
    expected = quad(battery.open_circuit_voltage, 0.0, charge, points=knots or None, limit=100)[0]
    assert battery.stored_energy(charge, 900.0) == pytest.approx(900.0 * expected, rel=1e-9)


def test_a_full_cell_holds_about_a_watt_hour():
    # The mean of the chart by trapezoids: (73.43 + (3.27 + 4.20) / 2) V / 20 = 3.85825 V.
    assert battery.stored_energy(1.0, CELL.capacity) == pytest.approx(900.0 * 3.85825, rel=1e-9)


def test_the_cell_of_a_vehicle_file():
    cell = battery.Battery.of(load_vehicle_file('gtmab').energy)
    assert cell.capacity == pytest.approx(250e-3 * 3600.0)
    assert cell.resistance == 0.15


@pytest.mark.parametrize(
    'change', [{'capacity': 0.0}, {'capacity': np.inf}, {'resistance': -0.1}, {'resistance': None}]
)
def test_what_is_no_cell_is_refused(change):
    with pytest.raises(ValidationError, match=next(iter(change))):
        battery.Battery(**{'capacity': 900.0, 'resistance': 0.13, **change})


def test_drawing_one_watt_by_hand():
    # 0.2 I^2 + 4 I = -1: I = -0.25320 A, V = 3.94936 V.
    current = battery.current_at(4.0, -1.0, 0.2)
    assert current == pytest.approx((-4.0 + (16.0 - 0.8) ** 0.5) / 0.4, rel=1e-13)
    assert battery.terminal_voltage(4.0, current, 0.2) == pytest.approx(3.949359, abs=1e-6)


@given(st.floats(3.2, 4.2), st.floats(-15.0, 15.0), st.floats(0.0, 0.2))
def test_the_current_takes_up_the_power(open_circuit, power, resistance):
    current = battery.current_at(open_circuit, power, resistance)
    voltage = battery.terminal_voltage(open_circuit, current, resistance)
    possible = 4.0 * resistance * power > -(open_circuit**2)
    if possible:
        assert voltage * current == pytest.approx(power, rel=1e-9, abs=1e-12)
    else:
        assert voltage == pytest.approx(open_circuit / 2, rel=1e-6)


def test_a_brown_out_halves_the_voltage():
    # 4 V behind 0.2 ohm gives at most 16 / 0.8 = 20 W, at 10 A.
    assert battery.current_at(4.0, -25.0, 0.2) == pytest.approx(-10.0)


def test_counting_by_hand():
    # 0.9 A for 100 s is a tenth of 900 C.
    assert battery.count(0.5, -0.9, 900.0, 100.0) == pytest.approx(0.4, rel=1e-14)
    assert battery.count(0.05, -0.9, 900.0, 100.0) == 0.0
    assert battery.count(0.95, 0.9, 900.0, 100.0) == 1.0


def test_the_energy_books_balance_to_one_in_a_thousand_million():
    charge, books, harvest = 0.9, Books(), 0.4
    capacity, resistance, dt = CELL.capacity, CELL.resistance, 0.01
    begin = battery.stored_energy(charge, capacity)
    for k in range(20000):
        load = 1.5 + np.sin(0.01 * k).item()
        before = battery.stored_energy(charge, capacity)
        charge, _, current = battery.advance(charge, harvest - load, capacity, resistance, dt)
        stored = battery.stored_energy(charge, capacity) - before
        books = enter(books, harvest, load, resistance * current**2, stored, dt)
    assert books.stored == pytest.approx(battery.stored_energy(charge, capacity) - begin, rel=1e-9)
    assert books.stored < -200.0
    assert books.harvested == pytest.approx(80.0, rel=1e-12)
    assert abs(books.imbalance) < 1e-9 * books.consumed


def test_advance_is_of_second_order():
    def after(dt):
        charge = 0.62  # 0.62 to 0.64 lies between two knots of the curve
        for _ in range(round(32.0 / dt)):
            charge = battery.advance(charge, 1.5, 900.0, 0.13, dt)[0]
        return charge

    exact = after(0.125)
    assert (after(8.0) - exact) / (after(4.0) - exact) == pytest.approx(4.0, rel=0.05)


def test_a_constant_power_empties_the_cell_when_its_energy_is_spent():
    charge, time = 1.0, 0.0
    while charge > 0.0:
        charge, _, _ = battery.advance(charge, -1.333, CELL.capacity, 0.0, 1.0)
        time += 1.0
    assert time == pytest.approx(900.0 * 3.85825 / 1.333, abs=1.5)


def test_the_cell_compiles_to_the_same():
    names = ('open_circuit_voltage', 'terminal_voltage', 'current_at', 'count', 'state_of_charge')
    compiled = {name: numba.njit(getattr(battery, name)) for name in (*names, 'stored_energy')}
    code = battery.advance.__code__
    advance = numba.njit(FunctionType(code, {**vars(battery), **compiled}, 'advance'))
    assert advance(0.8, -1.5, 900.0, 0.13, 0.01) == battery.advance(0.8, -1.5, 900.0, 0.13, 0.01)
    assert compiled['state_of_charge'](3.9) == battery.state_of_charge(3.9)
    assert compiled['stored_energy'](0.37, 900.0) == battery.stored_energy(0.37, 900.0)
