"""The model against what is known in closed form."""

import math

from lta_model.state import POSITION, QUATERNION, RATES, VELOCITY
from lta_sim.kernels.kernel import advance, effect_wrenches, state_derivative
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from . import flat_balloon as balloon

OFF = np.zeros(4)
CALM = np.zeros(3)


def test_angular_momentum_about_the_vertical_is_conserved():
    cg = np.array(balloon.CG)
    model = balloon.model(balloon.NEUTRAL, displaced=balloon.MASS)

    def vertical(state):
        turn = Rotation.from_quat(state[QUATERNION])
        velocity = turn.apply(state[VELOCITY] + np.cross(state[RATES], cg))
        spin = turn.apply(balloon.INERTIA @ state[RATES])
        place = state[POSITION] + turn.apply(cg)
        return spin[2] + balloon.MASS * np.cross(place, velocity)[2]

    state = balloon.at(velocity=(0.5, -0.2, 0.1), rates=(2.0, -1.0, 1.5))
    later = advance(state, model, OFF, CALM, 1e-3, 10_000)
    assert vertical(later) == pytest.approx(vertical(state), rel=1e-10)


def test_pendulum_period():
    model = balloon.model(balloon.NEUTRAL | balloon.ADDED, displaced=balloon.MASS)
    m, h = balloon.MASS, -balloon.CG[2]
    # Free to drift, the hull swings about a point below it: the coupled inertia is smaller.
    inertia = 0.015 + m * h**2 + 4.7e-3 - (m * h) ** 2 / (m + 0.146)
    amplitude = 1e-3
    expected = 2 * math.pi * math.sqrt(inertia / (m * balloon.G * h)) * (1 + amplitude**2 / 16)
    state = balloon.at()
    state[QUATERNION] = (0.0, math.sin(0.5 * amplitude), 0.0, math.cos(0.5 * amplitude))
    dt, crossings = 1e-3, []
    for k in range(20_000):
        later = advance(state, model, OFF, CALM, dt, 1)
        if state[4] < 0.0 <= later[4]:
            crossings.append((k - state[4] / (later[4] - state[4])) * dt)
        state = later
    assert len(crossings) >= 10
    assert np.diff(crossings).mean() == pytest.approx(expected, rel=1e-6)


def test_steps_add_up_to_the_bit():
    model = balloon.model(balloon.EVERYTHING)
    state, duty, wind = balloon.anywhere(np.random.default_rng(3))
    half = advance(state, model, duty, wind, 2e-3, 50)
    np.testing.assert_array_equal(
        advance(half, model, duty, wind, 2e-3, 50), advance(state, model, duty, wind, 2e-3, 100)
    )


def test_motor_follows_its_time_constants():
    model = balloon.model({'motor_lag': {'up': 0.072, 'down': 0.15}})
    state = advance(balloon.at(), model, (0.5, -0.5, 1.0, 0.0), CALM, 1e-3, 72)
    risen = 1.0 - math.exp(-1.0)
    expected = np.array([0.5, -0.5, 1.0, 0.0]) * risen
    np.testing.assert_allclose(state[balloon.LAG], expected, rtol=1e-9, atol=0.0)
    later = advance(state, model, OFF, CALM, 1e-3, 150)
    np.testing.assert_allclose(later[balloon.LAG], expected * math.exp(-1.0), rtol=1e-9, atol=0.0)


def test_it_stands_on_the_floor_and_takes_off():
    model = balloon.model(balloon.EVERYTHING)
    sunk = 0.002 * balloon.G / 100.0
    state = balloon.at((0.0, 0.0, balloon.HEIGHT + 0.1), heading=0.3, velocity=(0.1, 0.0, 0.0))
    state = advance(state, model, OFF, CALM, 2e-3, 60_000)
    assert state[2] == pytest.approx(balloon.HEIGHT - sunk, abs=1e-6)
    assert np.max(abs(state[7:13])) < 1e-6
    place = state[POSITION]
    state = advance(state, model, OFF, CALM, 2e-3, 30_000)
    np.testing.assert_allclose(state[POSITION], place, atol=1e-6)
    state = advance(state, model, (0.6, 0.6, 0.0, 0.0), CALM, 2e-3, 1500)
    assert state[2] > balloon.HEIGHT + 0.3


@pytest.mark.parametrize(
    ('state', 'duty', 'wind', 'words'),
    [
        (np.zeros(13), OFF, CALM, rf'state has the shape \(13,\); it must be \({LAYOUT.size},\)'),
        (np.zeros(LAYOUT.size), np.zeros(12), CALM, r'command has the shape \(12,\)'),
        (np.zeros(LAYOUT.size), OFF, np.zeros((3, 1)), r'surroundings has the shape \(3, 1\)'),
    ],
)
@pytest.mark.parametrize('function', [state_derivative, effect_wrenches])
def test_wrong_shapes_are_refused(function, state, duty, wind, words):
    with pytest.raises(ValueError, match=words):
        function(state, balloon.model({}), duty, wind)
