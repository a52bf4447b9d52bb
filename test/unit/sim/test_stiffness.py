# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What reacts faster than the step can follow is refused, before the flight or as it runs away."""

import re

from lta_config.errors import BadInput
from lta_model.model import find_fastest_damping, STEP_NS
from lta_sim.scene_model import check_scene
import numpy as np
import pytest

from .changed_vehicle import build, given
from .lamp_room import build as world_of
from .lamp_room import HOVER

STEP = STEP_NS * 1e-9


def test_the_fastest_decay_is_damping_by_inertia():
    """A heave damping alone: rate = d (M^-1)_zz, which is d / (m + m_a) with the CG below."""
    vehicle = build(('aero.linear_drag.force', given([0, 0, 50.0], 'N s/m')))
    name, rate = find_fastest_damping(vehicle.build_model())
    assert name == 'linear_drag'
    assert rate == pytest.approx(50.0 / (vehicle.mass + vehicle.added_mass[2]), rel=1e-9)


def test_damping_that_the_step_cannot_follow():
    """RK4 grows beyond 2.785 / rate, and the sentence says by how much to weaken it."""
    moment = 100.0
    place = 'aero.linear_drag.moment'
    stiff = build((place, given([0, 0, moment], 'N m s')))
    with pytest.raises(
        BadInput, match='The effect rotational_drag of gtmab damps motion'
    ) as caught:
        stiff.check_step(STEP)
    times = float(re.search(r'make its damping ([0-9.]+) times weaker', str(caught.value))[1])
    build((place, given([0, 0, 0.99 * moment / times], 'N m s'))).check_step(STEP)
    with pytest.raises(BadInput, match='times weaker'):
        build((place, given([0, 0, 1.02 * moment / times], 'N m s'))).check_step(STEP)


def test_a_floor_that_the_step_cannot_follow():
    with pytest.raises(BadInput, match='The effect floor_contact of gtmab damps motion'):
        world_of(
            vehicle={
                'effects/floor_contact/stiffness/value': 1e4,
                'effects/floor_contact/relaxation/value': 10.0,
            }
        )


def test_numbers_that_run_away_are_one_sentence():
    world = world_of()
    world.state[:3] = 0.0, 0.0, 1.5
    world.state[7:10] = 1e4, 1e4, 1e4  # where quadratic drag is too stiff for any step
    with pytest.raises(
        BadInput, match=r'The simulation of gtmab diverged 0\.00 s after the start'
    ):
        world.advance(HOVER)
    world = world_of()
    world.state[12] = np.nan
    with pytest.raises(BadInput, match='diverged'):
        world.advance(HOVER)


def test_effects_that_ground_or_flip_it_are_refused():
    scene = world_of().scenario
    with pytest.raises(BadInput, match=r'needs 1\.\d+ N from each lifting rotor to hover'):
        check_scene(build(('effects.payload', {'mass': given(0.2, 'kg')})), scene)
    check_scene(build(('effects.payload', {'mass': given(2, 'g')})), scene)
    raised = ('effects.cg_height', {'z': given(0.3, 'm')})
    with pytest.raises(BadInput, match=r'has its centre of gravity \d+\.\d cm above the hull'):
        check_scene(build(raised), scene)
    check_scene(build(raised, ('trim.unstable', 'allowed')), scene)


def test_lift_that_an_effect_adds_carries_a_payload():
    scene = world_of().scenario
    check_scene(
        build(
            ('effects.payload', {'mass': given(0.2, 'kg')}),
            ('effects.net_lift', {'force': given(1.96, 'N')}),
        ),
        scene,
    )
