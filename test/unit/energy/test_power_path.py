# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The power path: losses by hand, charging to the end, brown-out, and books that balance."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import (
    advance_power_path,
    charge_power_limit,
    charger_output,
    ChargerModel,
    resting_flow,
    total_stored_energy,
)
import pytest

ENERGY = load_vehicle_file('gtmab').energy
CELL, CHARGER = BatteryModel.from_energy(ENERGY), ChargerModel.from_energy(ENERGY)
POWERS = st.floats(0.0, 4.0)


def follow(flow, steps, dt, available=0.0, asked=0.0, cell=CELL, charger=CHARGER):
    """Return flow and energies [J] after so many steps."""
    begun, harvested, consumed, lost = total_stored_energy(cell, flow), 0.0, 0.0, 0.0
    for _ in range(steps):
        flow = advance_power_path(cell, charger, flow, available, asked, dt)
        harvested += flow.harvested * dt
        consumed += flow.consumed * dt
        lost += flow.lost * dt
    return flow, harvested, consumed, lost, total_stored_energy(cell, flow) - begun


def test_the_charger_by_hand():
    # (1 W * 0.95 - 22 mW) * 0.85; below 22 mW / 0.95 = 23.2 mW it is off.
    assert charger_output(CHARGER, 1.0) == pytest.approx(0.7888)
    assert charger_output(CHARGER, 0.0232) == pytest.approx(0.00004 * 0.85)
    assert charger_output(CHARGER, 0.0231) == 0.0
    flow = advance_power_path(CELL, CHARGER, resting_flow(0.5), 1.0, 0.12, 0.01)
    assert flow.harvested == pytest.approx(0.95)
    assert flow.consumed == pytest.approx(0.12, rel=1e-6)
    assert flow.voltage * flow.current == pytest.approx(0.7888 - 0.12, rel=1e-6)
    # All that the array gives beyond the cell and the loads is heat
    assert flow.lost == pytest.approx(0.95 - 0.7888 + 0.244 * flow.current**2, rel=0.05)
    dim = advance_power_path(CELL, CHARGER, resting_flow(0.5), 0.0231, 0.12, 0.01)
    assert (dim.harvested, dim.consumed) == (0.0, pytest.approx(0.12))


@given(
    st.lists(st.tuples(POWERS, POWERS), min_size=1, max_size=12),
    st.floats(0.0, 1.0),
    st.sampled_from([0.01, 1.0, 60.0]),
)
def test_the_books_balance(minutes, charge, dt):
    begun, flow, came, went = (
        total_stored_energy(CELL, resting_flow(charge)),
        resting_flow(charge),
        0.0,
        0.0,
    )
    for available, asked in minutes:
        flow = advance_power_path(CELL, CHARGER, flow, available, asked, dt)
        came += flow.harvested * dt
        went += (flow.consumed + flow.lost) * dt
    stored = total_stored_energy(CELL, flow) - begun
    assert abs(came - went - stored) <= 1e-9 * (came + went) + 1e-9


def test_without_an_array_nothing_is_harvested():
    none = ChargerModel.from_energy(load_vehicle_file('sblimp').energy)
    _, harvested, consumed, lost, stored = follow(
        resting_flow(0.5), 100, 1.0, available=5.0, asked=0.12, charger=none
    )
    assert harvested == 0.0
    assert consumed == pytest.approx(12.0)
    assert stored == pytest.approx(-12.0 - lost, rel=1e-4)


def test_a_cell_at_rest_and_one_that_is_empty():
    assert resting_flow(0.5) == (0.5, 0.0, 3.84, 0.0, 0.0, 0.0, 0.0, True)
    assert resting_flow(0.0) == (0.0, 0.0, 3.27, 0.0, 0.0, 0.0, 0.0, False)
    none = ChargerModel.from_energy(load_vehicle_file('sblimp').energy)
    assert (none.tracking, none.conversion, none.idle) == (0.0, 0.0, 0.0)


def test_what_a_cell_may_take_by_hand():
    """The limit is 0.25 A, 4.2 V or a full cell; the cell rests at 3.84 V with 0.15 ohm."""
    cell = BatteryModel(capacity=900.0, resistance=0.15, charge_current=0.25)
    assert charge_power_limit(cell, 0.5, 0.01, 1.0) == pytest.approx((3.85 + 0.0375) * 0.25)
    # 4.19 V of rest and 10 mV of room: 66.7 mA up to 4.2 V.
    assert charge_power_limit(cell, 0.99, 0.0, 1.0) == pytest.approx(4.2 * (4.2 - 4.19) / 0.15)
    # A tenth of 900 C in 900 s are 0.1 A.
    assert charge_power_limit(cell, 0.9, 0.0, 900.0) == pytest.approx((4.11 + 0.015) * 0.1)
    assert charge_power_limit(cell, 0.99, 0.1, 1.0) == 0.0
    stiff = cell.model_copy(update={'resistance': 0.0})
    assert charge_power_limit(stiff, 0.5, 0.0, 1.0) == pytest.approx(3.84 * 0.25)
    assert charge_power_limit(stiff, 0.99, 0.1, 1.0) == 0.0


def test_a_failed_supply_comes_back_at_a_twentieth_while_it_is_charged():
    cell = BatteryModel(capacity=900.0, resistance=0.15)
    off = resting_flow(0.0)
    for charge, available, fed in ((0.05, 1.0, True), (0.0499, 1.0, False), (0.06, 0.0, False)):
        flow = advance_power_path(cell, CHARGER, off._replace(charge=charge), available, 0.1, 1e-6)
        assert flow.fed is fed
        assert flow.consumed == pytest.approx(0.0, abs=1e-12)


def test_a_supply_fails_below_its_cut_off_and_not_at_it():
    cell = BatteryModel(capacity=900.0, resistance=0.0)
    begin = advance_power_path(cell, CHARGER, resting_flow(0.5), 0.0, 1.0, 1.0)
    at = cell.model_copy(update={'discharge_cutoff': begin.voltage})
    assert advance_power_path(at, CHARGER, resting_flow(0.5), 0.0, 1.0, 1.0).fed
    above = cell.model_copy(update={'discharge_cutoff': begin.voltage + 1e-9})
    assert not advance_power_path(above, CHARGER, resting_flow(0.5), 0.0, 1.0, 1.0).fed
