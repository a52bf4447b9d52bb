# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A vehicle in its row: a commanded wrench acts on it as the mass matrix says."""

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
