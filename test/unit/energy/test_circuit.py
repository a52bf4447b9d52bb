# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Cell, panel and loads in one step: the books balance whatever happens."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy.circuit import add_totals, EnergyTotals, NO_ENERGY, step_circuit
from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import NO_IRRADIANCE
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import ChargerModel, resting_flow, total_stored_energy
from lta_model.electrical.panel import SolarArrayModel
import pytest

ENERGY = load_vehicle_file('gtmab').energy
CELL, CHARGER, PANEL = (
    BatteryModel.from_energy(ENERGY),
    ChargerModel.from_energy(ENERGY),
    SolarArrayModel.from_energy(ENERGY),
)
HARVEST = HarvestCurve(PANEL, 1.1)  # 1.1 W/m2 of sunlight for 1 of a lamp


@given(
    charge=st.floats(0.0, 1.0),
    available=st.floats(0.0, 3.0),
    asked=st.floats(0.0, 3.0),
    steps=st.integers(1, 30),
)
def test_what_is_harvested_is_consumed_lost_or_stored(charge, available, asked, steps):
    store, spent = resting_flow(charge), NO_ENERGY
    begun = total_stored_energy(CELL, store)
    for _ in range(steps):
        store, spent = step_circuit(CELL, CHARGER, store, spent, available, asked, 10.0)
    rest = (
        spent.harvested - spent.consumed - spent.lost - (total_stored_energy(CELL, store) - begun)
    )
    assert abs(rest) <= 1e-6 * max(spent.harvested, spent.consumed, 1.0)
    most = available * CHARGER.tracking * 10.0 * steps
    assert spent.harvested + spent.curtailed <= most + 1e-9
    assert spent.curtailed >= -1e-9
    assert 0.0 <= store.charge <= 1.0


def test_a_flickering_lamp_brings_its_duty_of_its_own_brightness():
    flickering = HARVEST(NO_IRRADIANCE._replace(beacon=200.0, duty=0.5))
    assert flickering == pytest.approx(0.5 * HARVEST.steady_light_power(220.0))
    assert flickering > HARVEST.steady_light_power(
        110.0
    )  # a diode gives more than twice in twice the light
    both = HARVEST(NO_IRRADIANCE._replace(sun=100.0, beacon=200.0, duty=0.25))
    assert both == pytest.approx(
        0.75 * HARVEST.steady_light_power(100.0) + 0.25 * HARVEST.steady_light_power(320.0)
    )


def test_the_books_add_up_entry_by_entry():
    assert NO_ENERGY == (0.0, 0.0, 0.0, 0.0)
    assert add_totals(EnergyTotals(1.0, 2.0, 3.0, 4.0), EnergyTotals(10.0, 20.0, 30.0, 40.0)) == (
        11,
        22,
        33,
        44,
    )
    before = EnergyTotals(1.0, 2.0, 3.0, 4.0)
    store, once = step_circuit(CELL, CHARGER, resting_flow(0.5), NO_ENERGY, 1.0, 0.1, 10.0)
    again, twice = step_circuit(CELL, CHARGER, resting_flow(0.5), before, 1.0, 0.1, 10.0)
    assert again == store
    assert twice == pytest.approx(add_totals(before, once))
