"""Hovering on identical cells, against energy by hand and the figures of the paper."""

from contextlib import redirect_stdout
from io import StringIO
import json

from lta_cli.app import run_command_line
from lta_flight.flight_spec import build_vehicle_scenario_stack
from lta_model.electrical.battery import BatteryModel, stored_energy
from lta_studies.energy import paper
from lta_studies.energy.hover.run import build_hover_spec, simulate_discharge, simulate_paper_hover
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


@pytest.fixture(scope='module')
def found(tmp_path_factory):
    """Return what the verb finds in 40 s."""
    folder = tmp_path_factory.mktemp('hover') / 'found'
    words = ['lta', 'energy', 'hover', '--seconds', '40', '--out', str(folder)]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as told:
        patch.setattr('sys.argv', words)
        assert run_command_line() == 0
    numbers = json.loads((folder / 'hover.json').read_text())
    return {**numbers, 'page': (folder / 'report.html').read_text(), 'told': told.getvalue()}


def test_both_hover_on_the_same_cell_and_one_takes_a_tenth(found):
    drone, other = found['flown']['gtmab'], found['flown']['multirotor']
    assert other['power'] == pytest.approx(7.44, abs=0.05)
    assert found['share'] == pytest.approx(drone['power'] / other['power'])
    assert 0.08 < found['share'] < 0.11
    assert other['drop'] > 5.0 * drone['drop']


def test_what_the_cell_gave_is_what_was_drawn(found):
    other = found['flown']['multirotor']
    # 5 s of electronics, then 35 s of hovering, a little more while it rises.
    assert other['energy'] == pytest.approx(5.0 * 0.983 + 35.0 * other['power'], rel=0.02)


def test_the_page_says_what_the_paper_claims(found):
    assert 'almost a third' in found['page']
