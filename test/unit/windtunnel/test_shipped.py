# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The sweeps that are shipped: of these shapes, and the aero files beside them are their fits."""

from decimal import Decimal
import re

from lta_config.files import share_folder
from lta_config.schema.vehicle_aero import load_aero_file
from lta_model.vehicle import load_vehicle
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.flow_plan import MIDDLE_SPEED
from lta_windtunnel.reduce import (
    AVERAGED_ITERATIONS,
    MAX_IMBALANCE,
    MAX_MEAN_ERROR,
    MAX_SPREAD,
    MIN_DISK_CELLS,
    MIN_LENGTHS,
)
from lta_windtunnel.sweep_table import read_sweep
from lta_windtunnel.tunnel_model import load_tunnel_model
import pytest

FOLDER = share_folder() / 'aero'
NAMES = sorted(path.name.removesuffix('.sweep.json') for path in FOLDER.glob('*.sweep.json'))
NUMBER = re.compile(r'-?\d+(?:\.\d+)?(?:e-?\d+)?')
WINDS = {'surge', 'sway', 'heave'}
each_sweep = pytest.mark.parametrize('name', NAMES)


def sweep_of(name):
    return read_sweep(FOLDER / f'{name}.sweep.json')


def test_five_vehicles_stood_in_the_tunnel():
    assert NAMES == ['beavis', 'blimp2b', 'gtmab', 'gtmab_reference', 'sblimp', 'skye']
    assert {sweep_of(name).vehicle for name in NAMES} == set(NAMES) - {'gtmab_reference'}


@each_sweep
def test_the_aero_file_is_the_fit_of_its_sweep(name):
    shipped, fitted = (FOLDER / f'{name}.aero.yaml').read_text(), format_aero_file(sweep_of(name))
    assert NUMBER.split(shipped) == NUMBER.split(fitted)
    for ours, theirs in zip(
        map(Decimal, NUMBER.findall(shipped)), NUMBER.findall(fitted), strict=True
    ):
        # Processors add in different orders: what lies between two roundings may fall to either.
        assert abs(ours - Decimal(theirs)) <= Decimal(1).scaleb(ours.as_tuple().exponent)


@each_sweep
def test_the_sweep_is_of_the_shape_that_is_shipped(name):
    sweep = sweep_of(name)
    assert sweep.geometry == load_tunnel_model(sweep.vehicle).fingerprint


@each_sweep
def test_the_vehicle_of_the_sweep_has_its_rotors(name):
    sweep, aero = sweep_of(name), load_aero_file(name).aero
    rotors = load_vehicle(sweep.vehicle).file.rotors
    assert aero.thrust_allocation.keys() <= rotors.keys()
    assert sweep.rotors.keys() in (rotors.keys(), set())


@pytest.mark.parametrize('name', ['beavis', 'sblimp'])
def test_a_vehicle_flies_with_the_columns_of_its_rotors(name):
    flown, found = load_vehicle(name).file.aero, load_aero_file(name).aero
    for rotor, column in found.thrust_allocation.items():
        own = flown.thrust_allocation[rotor]
        assert (own.force.vector, own.moment.vector) == (column.force.vector, column.moment.vector)
    assert (flown.coupling is None) == (found.coupling is None)
    if found.coupling:
        own, both = flown.coupling, found.coupling
        assert (own.rotors, own.force.vector) == (both.rotors, both.force.vector)
        assert own.moment.vector == both.moment.vector


@pytest.mark.parametrize(
    ('k', 'axis', 'within'), [(0, 'surge', 0.03), (1, 'sway', 0.03), (2, 'heave', 0.12)]
)
def test_gtmab_flies_with_the_drag_of_transient_flows(k, axis, within):
    aero = load_vehicle('gtmab').file.aero
    flown = aero.linear_drag.force.vector[k] + aero.quadratic_drag.force.vector[k]
    solved = {point.speed: -point.force[k] for point in sweep_of('gtmab_reference').axes[axis]}
    assert flown == pytest.approx(solved[MIDDLE_SPEED], rel=within)


def test_gtmab_flies_with_the_columns_of_its_rotors():
    flown, found = load_vehicle('gtmab').file.aero, load_aero_file('gtmab').aero
    for rotor, column in found.thrust_allocation.items():
        own = flown.thrust_allocation[rotor]
        assert own.force.vector == pytest.approx(column.force.vector, abs=0.005)
        assert own.moment.vector == pytest.approx(column.moment.vector, abs=0.005)


def is_of_a_steady_flow(evidence, is_balanced=True):
    """Hold evidence to its gates; where the air turns along, nobody sums its momentum."""
    assert evidence.spread <= MAX_SPREAD
    assert evidence.window == AVERAGED_ITERATIONS
    if is_balanced:
        assert evidence.balance is not None
        assert evidence.balance <= MAX_IMBALANCE
    else:
        assert evidence.balance is None


def is_of_a_transient(evidence, length):
    """Hold the evidence of a mean to its gates: the air comes with 1 m/s, and is not summed."""
    assert evidence.spread <= MAX_MEAN_ERROR
    assert evidence.window >= MIN_LENGTHS * length
    assert evidence.balance is None


@each_sweep
def test_whatever_is_solved_has_passed_its_gates(name):
    sweep = sweep_of(name)
    assert sweep.refused.keys() == ({'heave at 1.5'} if name == 'skye' else set())
    assert sweep.axes.keys() & WINDS
    assert sweep.axes.keys() - WINDS
    assert sweep.blows or not sweep.rotors
    for axis, points in sweep.axes.items():
        assert points, axis
        for point in points:
            if sweep.fidelity == 'reference' and axis in WINDS and point.speed == MIDDLE_SPEED:
                is_of_a_transient(point.evidence, sweep.length)
            else:
                is_of_a_steady_flow(point.evidence, is_balanced=axis in WINDS)
    for point in sweep.coarse.values():
        is_of_a_steady_flow(point.evidence)
    for blow in sweep.blows.values():
        is_of_a_steady_flow(blow.evidence)
        assert blow.zones.keys() == blow.shares.keys()
        assert min(blow.zones.values()) >= MIN_DISK_CELLS
