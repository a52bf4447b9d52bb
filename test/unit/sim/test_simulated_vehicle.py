"""A vehicle in its row: what it writes there is what the functions of the kernel return."""

from lta_sim.kernels import kernel
from lta_sim.simulated_vehicle import SimulatedVehicle
import numpy as np
import pytest

from . import flat_balloon as balloon

DUTIES = [0.3, 0.2, -0.1, 0.4]
WIND = [0.3, -0.2, 0.1]


@pytest.fixture
def craft():
    """Return a balloon in motion."""
    generator = np.random.default_rng(2)
    flown = SimulatedVehicle(balloon.model(balloon.EVERYTHING))
    flown.state[:], _, _ = balloon.anywhere(generator)
    flown.command[: len(DUTIES)] = DUTIES
    flown.surroundings[: len(WIND)] = WIND
    return flown


def test_it_moves_in_place_as_the_kernel_says(craft):
    state, model = craft.state, balloon.model(balloon.EVERYTHING)
    later = kernel.advance(state, model, DUTIES, WIND, 2e-3, 20)
    assert not np.array_equal(later, state)
    for _ in range(4):
        craft.advance(2e-3, 5)
    assert craft.state is state
    np.testing.assert_array_equal(state, later)


def test_looking_changes_neither_state_nor_future(craft):
    looked = SimulatedVehicle(balloon.model(balloon.EVERYTHING))
    for name in ('state', 'command', 'surroundings'):
        getattr(looked, name)[:] = getattr(craft, name)
    looked.evaluate_state()
    np.testing.assert_array_equal(looked.state, craft.state)
    for flown in (looked, craft):
        flown.advance(2e-3, 10)
    np.testing.assert_array_equal(looked.state, craft.state)


def test_a_look_is_of_the_present_state_alone(craft):
    model = balloon.model(balloon.EVERYTHING)
    craft.evaluate_state()
    craft.advance(2e-3, 10)
    craft.evaluate_state()
    look = kernel.evaluate_model(craft.state, model, DUTIES, WIND)
    np.testing.assert_array_equal(craft.wrenches, list(look.wrenches.values()))
    np.testing.assert_array_equal(craft.thrusts, look.thrusts)
    np.testing.assert_array_equal(craft.wind, WIND)
    rate = kernel.state_derivative(craft.state, model, DUTIES, WIND)
    np.testing.assert_array_equal(craft.rate, rate)


def test_a_commanded_wrench_accelerates_the_body_and_nothing_else(craft):
    """The inverse of the mass matrix times the wrench; without one, the same flight."""
    model = balloon.model(balloon.EVERYTHING)
    commanded = SimulatedVehicle(model, commanded=True)
    for name in ('state', 'command', 'surroundings'):
        getattr(commanded, name)[:] = getattr(craft, name)
    for flown in (commanded, craft):
        flown.evaluate_state()
    np.testing.assert_array_equal(commanded.rate, craft.rate)
    wrench = np.array([0.02, -0.01, 0.03, 0.001, -0.002, 0.004])
    commanded.commanded_wrench[:] = wrench
    commanded.evaluate_state()
    gained = commanded.rate - craft.rate
    expected = np.reshape(model.inverse, (6, 6)) @ wrench
    np.testing.assert_allclose(gained[7:13], expected, rtol=1e-9)
    assert not gained[:7].any()
    assert not gained[13:].any()
