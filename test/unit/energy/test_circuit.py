# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Cell, panel and loads in one step: the books balance whatever happens."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy.circuit import NO_ENERGY, step_circuit
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import ChargerModel, resting_flow, total_stored_energy
from lta_model.electrical.panel import SolarArrayModel

ENERGY = load_vehicle_file('gtmab').energy
CELL, CHARGER, PANEL = (
    BatteryModel.from_energy(ENERGY),
    ChargerModel.from_energy(ENERGY),
    SolarArrayModel.from_energy(ENERGY),
)


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
