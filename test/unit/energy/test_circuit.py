"""Cell, panel and loads in one step: the books balance whatever happens."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.vehicle_file import load_vehicle_file
from lta_energy.battery import Battery
from lta_energy.circuit import browned_out, fed, held, NO_FLOW, resting
from lta_energy.harvest import harvest
from lta_energy.light_of_days import DARK
from lta_energy.panel import Panel
import pytest

ENERGY = load_vehicle_file('gtmab').energy
CELL, PANEL = Battery.of(ENERGY), Panel.of(ENERGY)


@given(
    charge=st.floats(0.0, 1.0),
    income=st.floats(0.0, 3.0),
    asked=st.floats(0.0, 3.0),
    steps=st.integers(1, 60),
)
def test_what_is_harvested_is_consumed_lost_or_stored(charge, income, asked, steps):
    store, flow = resting(charge), NO_FLOW
    begun = held(CELL, store)
    for _ in range(steps):
        store, flow = fed(CELL, store, flow, income, asked, 10.0)
    rest = flow.harvested - flow.consumed - flow.lost - (held(CELL, store) - begun)
    assert abs(rest) <= 1e-3 * max(flow.harvested, flow.consumed, 1.0)
    assert flow.harvested + flow.curtailed == pytest.approx(income * 10.0 * steps)
    assert 0.0 <= store.charge <= 1.0
    assert flow.consumed <= asked * 10.0 * steps * (1.0 + 1e-9) + 1e-9


def test_a_full_cell_leaves_the_light_unharvested():
    store, flow = fed(CELL, resting(1.0), NO_FLOW, 1.0, 0.1, 60.0)
    assert store.charge == 1.0
    assert flow.harvested == pytest.approx(6.0)
    assert flow.curtailed == pytest.approx(54.0)


def test_an_empty_cell_goes_out():
    store, flow = resting(0.001), NO_FLOW
    for _ in range(10):
        store, flow = fed(CELL, store, flow, 0.0, 1.5, 1.0)
    assert browned_out(store)
    assert flow.consumed < 15.0


def test_a_flickering_lamp_brings_its_duty_of_a_steady_one():
    steady = harvest(PANEL, DARK._replace(lamps=200.0))
    flickering = harvest(PANEL, DARK._replace(beacon=200.0, duty=0.5))
    assert flickering == pytest.approx(0.5 * steady)
    both = harvest(PANEL, DARK._replace(sun=100.0, beacon=200.0, duty=0.25))
    dim, bright = (harvest(PANEL, DARK._replace(sun=each)) for each in (100.0, 300.0))
    assert both == pytest.approx(0.75 * dim + 0.25 * bright)
