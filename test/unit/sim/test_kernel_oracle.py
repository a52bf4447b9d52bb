"""The kernel and the slow, obvious model agree."""

from lta_sim.effects import EFFECTS
from lta_sim.effects.protocol import WrenchEffect
from lta_sim.kernel import advance, derivative, wrenches
import numpy as np
import pytest

from . import flat_balloon as balloon
from . import oracle

# A CG off every axis and a full inertia: no term of the equations can hide.
CG = (0.03, -0.02, -0.08)
INERTIA = np.array([[0.015, 1e-3, -2e-3], [1e-3, 0.016, 5e-4], [-2e-3, 5e-4, 0.018]])
GIVEN = balloon.EVERYTHING | {
    'added_mass': {'surge': 0.14, 'sway': 0.15, 'heave': 0.37},
    'added_inertia': {'roll': 4e-3, 'pitch': 5e-3, 'yaw': 1e-3},
    'linear_drag': {'surge': 0.01, 'sway': 0.02, 'heave': 0.03},
    'floor_contact': balloon.EVERYTHING['floor_contact'] | {'x': 0.04, 'y': -0.03},
}
VEHICLE = (GIVEN, balloon.MASS, CG, INERTIA, balloon.DISPLACED)
# What the oracle knows of a state: the rigid part and four lagged duties.
KNOWN = np.r_[0:13, balloon.LAG]


@pytest.fixture(scope='module')
def model():
    return balloon.model(GIVEN, CG, INERTIA)


@pytest.mark.parametrize('seed', range(40))
def test_derivative(model, seed):
    state, duty, wind = balloon.anywhere(np.random.default_rng(seed))
    expected = oracle.derivative(state[KNOWN], *VEHICLE, duty, wind)
    actual = derivative(state, model, duty, wind)[KNOWN]
    assert np.max(abs(actual - expected)) <= 1e-12 * np.max(abs(expected))


@pytest.mark.parametrize('seed', range(3))
def test_flight(model, seed):
    state, duty, wind = balloon.anywhere(np.random.default_rng(seed), height=(1.0, 2.0))
    expected = oracle.advance(state[KNOWN], 2e-3, 100, *VEHICLE, duty, wind)
    actual = advance(state, model, duty, wind, 2e-3, 100)[KNOWN]
    assert np.max(abs(actual - expected)) <= 1e-12


def test_each_wrench(model):
    state, duty, wind = balloon.anywhere(np.random.default_rng(1))
    alone = {
        name: wrenches(state, balloon.model({name: GIVEN[name]}, CG, INERTIA), duty, wind)[name]
        for name in ('weight_and_buoyancy', 'linear_drag', 'quadratic_drag', 'floor_contact')
    }
    everything = wrenches(state, model, duty, wind)
    for name, wrench in alone.items():
        np.testing.assert_array_equal(everything[name], wrench)
    expected = oracle.thrust(GIVEN, state[balloon.LAG])
    np.testing.assert_allclose(everything['rotor_thrust'], expected, rtol=0.0, atol=1e-15)
    kinds = {name for name, effect in EFFECTS.items() if isinstance(effect, WrenchEffect)}
    assert set(everything) == kinds


def test_the_floor_is_met_in_some_of_the_random_states(model):
    met = 0
    for seed in range(40):
        state, duty, wind = balloon.anywhere(np.random.default_rng(seed))
        met += bool(np.any(wrenches(state, model, duty, wind)['floor_contact']))
    assert 5 <= met <= 35
