"""The sweeps that are shipped: of these shapes, and the aero files beside them are their fits."""

from pathlib import Path

from lta_config.aero_file import load_aero_file
from lta_config.files import share
from lta_sim.cfd.aero_text import aero_text
from lta_sim.cfd.gates import BALANCE, SPREAD, ZONE
from lta_sim.cfd.model import model_of
from lta_sim.cfd.sweep_table import read_sweep
from lta_sim.vehicle import load_vehicle
import pytest

FOLDER = share() / 'aero'
NAMES = sorted(path.name.removesuffix('.sweep.json') for path in FOLDER.glob('*.sweep.json'))
each_sweep = pytest.mark.parametrize('name', NAMES)


def sweep_of(name):
    return read_sweep(FOLDER / f'{name}.sweep.json')


def test_five_vehicles_stood_in_the_tunnel():
    assert NAMES == ['beavis', 'blimp2b', 'gtmab', 'sblimp', 'skye']


@each_sweep
def test_the_aero_file_is_the_fit_of_its_sweep(name):
    assert Path(FOLDER / f'{name}.aero.yaml').read_text() == aero_text(sweep_of(name))


@each_sweep
def test_the_sweep_is_of_the_shape_that_is_shipped(name):
    assert sweep_of(name).geometry == model_of(name).fingerprint


@each_sweep
def test_the_vehicle_of_the_sweep_has_its_rotors(name):
    sweep, aero = sweep_of(name), load_aero_file(name).aero
    rotors = load_vehicle(sweep.vehicle).file.rotors
    assert aero.thrust_allocation.keys() <= rotors.keys()
    assert sweep.rotors.keys() in (rotors.keys(), set())


@each_sweep
def test_whatever_is_shipped_has_passed_its_gates(name):
    sweep = sweep_of(name)
    for point in (point for axis in sweep.axes.values() for point in axis):
        assert point.evidence.spread <= SPREAD
        assert (point.evidence.balance or 0.0) <= BALANCE
    for blow in sweep.blows.values():
        assert (blow.evidence.balance or 0.0) <= BALANCE
        assert min(blow.zones.values()) >= ZONE
