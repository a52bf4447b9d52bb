# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Shipped vehicles as numerical objects: what they conserve, and how fast steps converge."""

from itertools import pairwise

from lta_model.effects import initial_memory
from lta_model.mass_properties import rigid_mass_matrix
from lta_model.model import VehicleModel
from lta_model.state import MASS_PLACE, pack_state, RIGID
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

G = 9.80665
CALM = np.zeros(3)
ASKEW = Rotation.from_euler('ZYX', (0.3, -0.2, 0.4)).as_matrix()
OFF_AXIS = np.array([0.01, -0.005, 0.0])
WEIGHED = np.array([0.0, 0.0, -0.2])  # where the moving mass rests
AWAY = np.array([0.04, -0.02, 0.01])  # of the moving mass from where it was weighed
CONSERVATIVE = ('weight_and_buoyancy', 'added_mass', 'added_inertia')


def conservative(name):
    """Return a shipped vehicle without what dissipates, its inertia askew, its mass moved."""
    vehicle = load_vehicle(name)
    given = {effect: vehicle.collect_effects()[effect] for effect in CONSERVATIVE}
    given['moving_mass'] = {'mass': 0.03, 'z': WEIGHED[2]}
    given['net_lift'] = {'force': 0.01}
    body = {
        'mass': vehicle.mass,
        'cg': vehicle.cg + OFF_AXIS,
        'inertia': ASKEW @ vehicle.inertia @ ASKEW.T,
        'displaced': vehicle.displaced_mass,
    }
    body['inertia'] = 0.5 * (body['inertia'] + body['inertia'].T)
    return given, body


def energies(state, given, body):
    """Return kinetic energy, with that of the air, and potential energy."""
    matrix = rigid_mass_matrix(body['mass'], body['cg'], body['inertia'])
    added = [*given['added_mass'].values(), *given['added_inertia'].values()]
    nu, turn = state[7:13], Rotation.from_quat(state[3:7])
    weights = body['mass'] * (state[2] + turn.apply(body['cg'])[2])
    weights += given['moving_mass']['mass'] * turn.apply(AWAY)[2]
    lift = body['displaced'] * G + given['net_lift']['force']
    return 0.5 * nu @ (matrix + np.diag(added)) @ nu, weights * G - lift * state[2]


@pytest.mark.parametrize('name', ['gtmab', 'blimp2b'])
def test_energy_is_conserved_for_a_minute(name):
    given, body = conservative(name)
    model = VehicleModel.build(given, **body)
    command = np.zeros(MASS_PLACE + 3)
    command[MASS_PLACE:] = AWAY + WEIGHED
    start = {'velocity': (0.5, -0.2, 0.1), 'rates': (1.0, -0.6, 0.8)}
    state = pack_state(memory=initial_memory(), **start)
    kinetic, potential = energies(state, given, body)
    for _ in range(6):
        state = kernel.advance(state, model, command, CALM, 2.5e-4, 40_000)
        now = sum(energies(state, given, body))
        assert abs(now - kinetic - potential) <= 1e-9 * kinetic
    assert not np.allclose(
        state[7:13], pack_state(memory=initial_memory(), **start)[7:13], atol=0.1
    )


def realistic():
    """Return GT-MAB with everything that its file has on, in wind, turbulence and light."""
    vehicle = load_vehicle('gtmab')
    added = {
        'steady_wind': {'x': -0.3, 'y': 0.1},
        'wind_gradient': {'x_z': 0.05, 'y_x': -0.03},
        'turbulence': {'along': 0.1, 'across': 0.1, 'up': 0.05}
        | {'along_length': 1.0, 'across_length': 1.0, 'up_length': 0.5},
        'superheat': {'warming': 0.017, 'lag': 70.0, 'slack': 1.0},
        'helium_leak': {'rate': 1e-4},
        'moving_mass': {'mass': 0.03, 'z': -0.3, 'lag': 0.3},
        'ground_effect': {'gain': 1.0, 'radius': 0.0235},
    }
    given = {
        name: values for name, values in added.items() if name not in vehicle.collect_effects()
    }
    body = {
        'mass': vehicle.mass,
        'cg': vehicle.cg,
        'inertia': vehicle.inertia,
        'displaced': vehicle.displaced_mass,
        'rotors': [(rotor.place, rotor.axis) for rotor in vehicle.rotors],
    }
    return VehicleModel.build(vehicle.collect_effects() | given, **body)


@pytest.mark.parametrize('seed', range(3))
def test_steps_converge_with_the_fourth_power(seed):
    generator = np.random.default_rng(seed)
    model = realistic()
    motion = {'velocity': (0.6, 0.25, 0.2), 'rates': (0.25, 0.3, 1.0)}
    start = pack_state((0.0, 0.0, 3.0), memory=initial_memory(), **motion)
    start[13:] += 0.3 * (start[13:] == 0.0)
    duties = generator.uniform(0.5, 0.9, 4)
    command = np.r_[duties, np.zeros(4), 0.05, 0.02, -0.28]
    around = np.r_[0.0, 0.0, 0.0, generator.normal(0.0, 3.0, 3), 400.0, 3.7]
    ends = [kernel.advance(start, model, command, around, 0.2 / n, n) for n in (32, 64, 128)]
    for part in (slice(0, RIGID), slice(RIGID, None)):
        errors = [np.max(abs(a - b)[part]) for a, b in pairwise(ends)]
        assert errors[-1] > 1e-14  # rounding is no convergence
        assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.15)
