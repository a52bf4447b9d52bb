# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The model against what is known in closed form."""

from lta_model.state import POSITION, QUATERNION, RATES, VELOCITY
from lta_sim.kernels.kernel import advance
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


def test_steps_add_up_to_the_bit():
    model = balloon.model(balloon.EVERYTHING)
    state, duty, wind = balloon.anywhere(np.random.default_rng(3))
    half = advance(state, model, duty, wind, 2e-3, 50)
    np.testing.assert_array_equal(
        advance(half, model, duty, wind, 2e-3, 50), advance(state, model, duty, wind, 2e-3, 100)
    )
