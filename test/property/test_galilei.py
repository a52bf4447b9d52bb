# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Galileo's law: what flies in a steady uniform wind flies as in calm, carried along with it."""

from hypothesis import given
from hypothesis import strategies as st
from lta_model.effects import EFFECTS, initial_memory
from lta_model.effects.protocol import WrenchEffect
from lta_model.model import VehicleModel
from lta_model.state import pack_state, POSITION, QUATERNION, RIGID, VELOCITY
from lta_sim.kernels.kernel import advance
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .test_effects import kind, laws, memories, motions, of, parameters, thrusts, vectors

# The floor has no heading, so that its contact counts as free of places; but it stands still.
GROUNDED = {'floor_contact'}
FREE = [e for e in kind(WrenchEffect) if not e.placed and e.name not in GROUNDED]

WIND = np.array([1.3, -0.7, 0.2])
COMMAND = np.array([0.5, 0.4, 0.3, -0.2, *[0.0] * 7])
ROTORS = [((0.3, 0.1, 0.0), (0.0, 0.0, 1.0)), ((0.1, -0.3, 0.1), (1.0, 0.0, 0.0))]
BODY = {
    'added_mass': {'surge': 0.1, 'sway': 0.15, 'heave': 0.3},
    'added_inertia': {'roll': 0.01, 'pitch': 0.02, 'yaw': 0.01},
    'thrust_curve': {'a_1': 0.09, 'b_1': 0.07, 'a_2': 0.09, 'b_2': 0.07},
    'linear_drag': {'surge': 0.02, 'sway': 0.02, 'heave': 0.05},
}


def begin(memory):
    return pack_state((1.0, 2.0, 0.33), 0.3, (0.3, -0.2, -0.1), (0.4, 0.5, -0.6), memory)


@pytest.mark.parametrize('effect', FREE, ids=of)
@laws
@given(data=st.data())
def test_effects_see_the_air_and_not_the_ground(effect, data):
    """Another speed over ground, from another place, through the same air: the same wrench."""
    values, motion = data.draw(parameters(effect)), data.draw(motions())
    thrust, memory = data.draw(thrusts), data.draw(memories(effect))
    moved = motion._replace(position=data.draw(vectors), velocity=data.draw(vectors))
    here = effect.wrench(values, memory, motion, thrust), effect.rate(values, memory, motion)
    there = effect.wrench(values, memory, moved, thrust), effect.rate(values, memory, moved)
    assert here == there, (
        f'{effect.name} knows where it is, or its speed over ground; '
        'declare placed=True, or let it take the airspeed.'
    )


def some_values(effect, seed):
    """Return moderate values of an effect that its own check allows."""
    generator = np.random.default_rng(seed)
    for _ in range(1000):
        values = {}
        for known in effect.parameters:
            low, high = max(known.low, known.null - 0.2), min(known.high, known.null + 0.2)
            values[known.name] = generator.uniform(low, high) if low < high else known.low
        if not effect.check(values):
            return values
    return pytest.fail(f'no values of {effect.name} pass its check')


@pytest.mark.parametrize('effect', FREE, ids=of)
def test_a_flight_in_wind_is_a_flight_in_calm_carried_along(effect):
    given = BODY | {effect.name: BODY.get(effect.name, {}) | some_values(effect, 4)}
    model = VehicleModel.build(
        given, mass=0.4, cg=(0.01, 0.0, -0.05), inertia=np.diag([0.02, 0.03, 0.02]),
        displaced=0.38, rotors=ROTORS,
    )  # fmt: skip
    start = begin(initial_memory())
    turn = Rotation.from_quat(start[QUATERNION])
    carried = start.copy()
    carried[VELOCITY] += turn.inv().apply(WIND)
    calm = advance(start, model, COMMAND, np.zeros(3), 2e-3, 500)
    windy = advance(carried, model, COMMAND, WIND, 2e-3, 500)
    np.testing.assert_allclose(windy[POSITION], calm[POSITION] + WIND * 1.0, atol=1e-10)
    np.testing.assert_allclose(windy[QUATERNION], calm[QUATERNION], atol=1e-10)
    over_air = windy[VELOCITY] - Rotation.from_quat(windy[QUATERNION]).inv().apply(WIND)
    np.testing.assert_allclose(over_air, calm[VELOCITY], atol=1e-10)
    np.testing.assert_allclose(windy[RIGID - 3 :], calm[RIGID - 3 :], atol=1e-10)


@pytest.mark.parametrize(
    'name', ['linear_drag', 'quadratic_drag', 'cross_flow', 'hull_lift', 'oblique_lift']
)
def test_wind_moves_a_hull_that_has_nothing_but_this_drag(name):
    effect = EFFECTS[name]
    assert isinstance(effect, WrenchEffect)
    values = some_values(effect, 4)
    model = VehicleModel.build(
        {name: values}, mass=0.4, cg=(0.0, 0.0, 0.0), inertia=np.diag([0.02, 0.03, 0.02])
    )
    start = begin(initial_memory())
    start[7:13] = 0.0
    still = advance(start, model, COMMAND, np.zeros(3), 2e-3, 500)
    blown = advance(start, model, COMMAND, WIND, 2e-3, 500)
    assert not still[VELOCITY].any()
    along = Rotation.from_quat(blown[QUATERNION]).apply(blown[VELOCITY]) @ WIND
    assert along > 1e-3
