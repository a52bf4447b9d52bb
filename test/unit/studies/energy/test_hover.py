# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hovering on identical cells, against energy by hand and the figures of the paper."""

from lta_flight.flight_spec import build_vehicle_scenario_stack
from lta_model.electrical.battery import BatteryModel, stored_energy
from lta_studies.energy import paper
from lta_studies.energy.budget.hover import (
    build_hover_spec,
    simulate_discharge,
    simulate_paper_hover,
)
import numpy as np
import pytest

CELL = build_vehicle_scenario_stack(build_hover_spec('gtmab'))[0].battery
IDEAL = BatteryModel(capacity=900.0, resistance=0.0)


def test_a_cell_without_resistance_gives_exactly_what_it_holds():
    found = simulate_discharge(IDEAL, 1.0, 2.0, 600.0)
    gone = stored_energy(1.0, 900.0) - stored_energy(float(found.charge[-1]), 900.0)
    assert gone == pytest.approx(2.0 * 600.0, rel=1e-5)
    assert found.failed is None


def test_a_real_cell_loses_the_heat_of_its_resistances_on_top():
    found = simulate_discharge(CELL, 1.0, 4.0, 400.0)
    capacity = CELL.capacity
    gone = stored_energy(1.0, capacity) - stored_energy(float(found.charge[-1]), capacity)
    current = 4.0 / found.voltage
    heat = float(np.sum(current**2) * 0.1) * (CELL.resistance + CELL.relaxation_resistance)
    assert gone == pytest.approx(1600.0 + heat, rel=0.01)


def test_it_fails_at_the_cells_own_cut_off():
    found = simulate_discharge(CELL, 0.3, 7.4, 600.0)
    assert found.failed is not None
    assert found.time[-1] < found.failed
    assert found.voltage[-1] == pytest.approx(CELL.discharge_cutoff, abs=0.02)


def test_the_papers_hover_takes_18_percent_of_the_cell():
    traces = simulate_paper_hover(CELL, paper.HOVER_TIME)
    (drone, standard) = traces.values()
    assert list(traces) == ['paper, 1333 mW', 'paper, 3999 mW']
    # 600 J of the 3330 J that the cell holds nominally.
    assert 1.0 - drone.charge[-1] == pytest.approx(0.18, abs=0.03)
    assert standard.voltage_drop > 2.5 * drone.voltage_drop
