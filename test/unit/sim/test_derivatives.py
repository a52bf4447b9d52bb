# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Finite differences: the energy against the power of the wrenches, and small motions."""

from lta_model.effects import EFFECTS
from lta_model.effects.protocol import KernelEffect
from lta_model.mass_properties import rigid_mass_matrix
from lta_model.state import RIGID
from lta_sim.kernels import kernel
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from . import crowded

CALM = np.zeros(8)


def energy(state, body, given):
    """Return kinetic energy, air included, and the potential of weight and buoyancy."""
    matrix = rigid_mass_matrix(body['mass'], np.asarray(body['cg']), body['inertia'])
    added = {**given['added_mass'], **given['added_inertia']}
    matrix = matrix + np.diag([added[axis] for axis in crowded.AXES])
    nu, g = state[7:13], given['weight_and_buoyancy']['gravity']
    height = state[2] + Rotation.from_quat(state[3:7]).apply(body['cg'])[2]
    potential = g * (body['mass'] * height - body['displaced'] * state[2])
    return 0.5 * nu @ matrix @ nu + potential


KERNEL = [name for name, effect in EFFECTS.items() if isinstance(effect, KernelEffect)]
INSIDE = ['weight_and_buoyancy', 'added_mass', 'added_inertia']
WINDS = {'steady_wind', 'wind_profile', 'wind_gradient', 'turbulence', 'gusts'}


@pytest.mark.parametrize('seed', range(10))
def test_energy_changes_by_the_power_of_the_wrenches(seed):
    """Gradient of the energy along the rate, against wrench times velocity, in still air."""
    generator = np.random.default_rng(seed)
    names = [name for name in (*KERNEL, *INSIDE) if name not in WINDS]
    given, body, model = crowded.vehicle(generator, names)
    state, command, _ = crowded.anywhere(generator)
    state[:3] = (0.0, 0.0, 1.0)
    rate = kernel.state_derivative(state, model, command, CALM)
    wrenches = kernel.effect_wrenches(state, model, command, CALM)
    outside = sum(wrench for name, wrench in wrenches.items() if name not in INSIDE)
    h = 1e-4

    def along(step):
        moved = state + step * rate
        return energy(moved, body, given)

    # The energy is quadratic in the velocity and nearly linear in the pose: fourth order will do.
    change = (8.0 * (along(h) - along(-h)) - along(2.0 * h) + along(-2.0 * h)) / (12.0 * h)
    power = outside @ state[7:13]
    scale = sum(abs(wrench) for wrench in wrenches.values()) @ abs(state[7:13])
    assert change == pytest.approx(power, abs=1e-11 * scale)


def jacobian(state, model, h=1e-5):
    """Return the slope of the rate in the state, by central differences of fourth order."""
    columns = []
    for unit in np.eye(RIGID, state.size):
        near, far = (
            kernel.state_derivative(state + s * h * unit, model, np.zeros(4))
            - kernel.state_derivative(state - s * h * unit, model, np.zeros(4))
            for s in (1.0, 2.0)
        )
        columns.append((8.0 * near - far)[:RIGID] / (12.0 * h))
    return np.transpose(columns)


def test_about_rest_a_vehicle_without_dissipation_only_swings():
    """The Jacobian at rest has two swings, of the closed form; nothing grows or decays."""
    given = crowded.everything(np.random.default_rng(0), INSIDE)
    mass, depth, inertia = 0.36, 0.08, (0.02, 0.021, 0.025)
    body = {'mass': mass, 'cg': (0.0, 0.0, -depth), 'inertia': np.diag(inertia)}
    model = kernel.VehicleModel.build(given, displaced=mass, **body)
    state = np.zeros(SIM_LAYOUT.size)
    state[6] = 1.0
    rates = np.linalg.eigvals(jacobian(state, model))
    g = given['weight_and_buoyancy']['gravity']
    added, turning = given['added_mass'], given['added_inertia']
    expected = []
    for push, turn, own in (('surge', 'pitch', 0.021), ('sway', 'roll', 0.02)):
        free = own + turning[turn] + mass * depth**2
        free -= (mass * depth) ** 2 / (mass + added[push])
        expected.append(np.sqrt(mass * g * depth / free))
    swings = sorted(rates.imag[rates.imag > 0.1])
    np.testing.assert_allclose(swings, sorted(expected), rtol=1e-8)
    # Drifting and turning freely are eigenvalues of zero, several times over: of these rounding
    # leaves its square root.
    assert np.max(abs(rates.real)) < 1e-4
