# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Walls, ceiling and floor as the hull and its rotors feel them, by hand."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_model.effects.protocol import VehicleMotion
from lta_model.effects.surfaces import CEILING_EFFECT, GROUND_EFFECT, WALLS
from lta_model.state import BODY, ROTOR, ROTOR_PLACE
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
NO = (0.0, 0.0, 0.0)
REST = (0.0,) * 8
number = st.floats(-2.0, 2.0, allow_subnormal=False)
vectors = st.tuples(number, number, number)


def standing(position, rotation=LEVEL, velocity=NO, rates=NO, rotors=()):
    body = [0.0] * BODY
    for i, (place, axis) in enumerate(rotors):
        body[ROTOR_PLACE + ROTOR * i : ROTOR_PLACE + ROTOR * (i + 1)] = (*place, *axis)
    return VehicleMotion(
        position, rotation, velocity, rates, velocity, tuple(body), (0.0,) * 11, REST
    )


# A room of 6 x 4 x 3 m about x = 1; a hull of 0.5 m radius and 0.3 m half height.
ROOM = (-2.0, 4.0, -2.0, 2.0, 3.0, 0.5, 0.3, 200.0, 0.1, 0.4)


def touch(position, rotation=LEVEL, velocity=NO, rates=NO, p=ROOM):
    return np.array(WALLS.wrench(p, (), standing(position, rotation, velocity, rates), REST))


def test_a_tilted_hull_reaches_as_far_as_its_spheroid():
    angle = 0.6
    turn = Rotation.from_euler('y', angle)
    rotation = tuple(turn.as_matrix().ravel().tolist())
    # Independently: the farthest of many points of the turned spheroid.
    u = np.linspace(0.0, 2.0 * math.pi, 20001)
    points = np.column_stack([0.5 * np.cos(u), np.zeros_like(u), 0.3 * np.sin(u)])
    inside = turn.apply(points)
    reach = inside[:, 0].max()
    assert not touch((4.0 - reach - 1e-6, 0.0, 1.5), rotation).any()
    wrench = touch((4.0 - reach + 0.01, 0.0, 1.5), rotation)
    force, moment = turn.apply(wrench[:3]), turn.apply(wrench[3:])
    np.testing.assert_allclose(force, (-2.0, 0.0, 0.0), atol=1e-4)
    lever = inside[inside[:, 0].argmax()]
    np.testing.assert_allclose(moment, np.cross(lever, force), atol=1e-3)


@given(
    position=st.tuples(st.floats(-2.2, 4.2), st.floats(-2.2, 2.2), st.floats(1.0, 3.2)),
    turn=vectors, velocity=vectors, rates=vectors,
)  # fmt: skip
def test_walls_give_back_no_more_than_they_took(position, turn, velocity, rates):
    """Power into the vehicle and into the springs together is never positive."""
    frictionless = (*ROOM[:9], 0.0)
    rotation = Rotation.from_euler('ZYX', turn)
    step = 1e-6

    def spring(position, rotation):
        matrix = rotation.as_matrix()
        reach = np.linalg.norm(matrix * (0.5, 0.5, 0.3), axis=1)
        low, high = np.array([-2.0, -2.0, -1e6]), np.array([4.0, 2.0, 3.0])
        depth = np.maximum(0.0, reach - np.minimum(position - low, high - position))
        return 0.5 * 200.0 * np.sum(depth**2)

    def moved(sign):
        place = np.array(position) + sign * step * rotation.apply(velocity)
        return spring(place, rotation * Rotation.from_rotvec(sign * step * np.array(rates)))

    flat = tuple(rotation.as_matrix().ravel().tolist())
    stored = (moved(1.0) - moved(-1.0)) / (2.0 * step)
    for p in (frictionless, ROOM):
        power = np.dot(touch(position, flat, velocity, rates, p), (*velocity, *rates))
        assert power + stored <= 1e-4


@pytest.mark.parametrize(
    ('changes', 'word'),
    [
        ({'x_low': -0.5, 'x_high': 0.5}, 'x_low'),
        ({'y_low': -0.5, 'y_high': 0.5}, 'y_low'),
        ({'ceiling': 1.0}, 'ceiling'),
        ({'half_height': 0.75, 'ceiling': 1.5}, 'ceiling'),
        ({'x_low': -0.5, 'x_high': 0.501}, ''),
        ({'y_low': -0.5, 'y_high': 0.501, 'ceiling': 1.001}, ''),
        ({'half_height': 0.75, 'ceiling': 1.501}, ''),
        ({'radius': 0.0}, 'radius'),
        ({'half_height': 0.0}, 'half_height'),
        ({'stiffness': 0.0, 'radius': 0.0}, ''),
    ],
)
def test_a_room_must_be_larger_than_a_hull_that_has_a_size(changes, word):
    given = zip(WALLS.parameters, ROOM, strict=True)
    said = WALLS.check({parameter.name: value for parameter, value in given} | changes)
    assert (word in said) if word else said == ''


UP = ((0.1, 0.2, -0.05), (0.0, 0.0, 1.0))
AHEAD = ((0.0, -0.2, -0.05), (1.0, 0.0, 0.0))
RADIUS = 0.0235


def near_floor(z, thrust, gain=1.0, rotation=LEVEL):
    motion = standing((0.0, 0.0, z), rotation, rotors=(UP, AHEAD))
    return np.array(GROUND_EFFECT.wrench((gain, RADIUS), (), motion, (*thrust, *(0.0,) * 6)))


def test_cheeseman_and_bennett_by_hand():
    # One radius above the floor: 1 / (1 - 1 / 16) = 1.0667; half a radius 1.3333, and no more.
    for above, gained in ((1.0, 1.0 / 15.0), (0.5, 1.0 / 3.0), (0.1, 1.0 / 3.0), (-3.0, 1 / 3)):
        wrench = near_floor(above * RADIUS + 0.05, (0.12, 0.0))
        np.testing.assert_allclose(
            wrench, 0.12 * gained * np.array([0, 0, 1, 0.2, -0.1, 0]), rtol=1e-12, atol=1e-17
        )
    assert near_floor(1.0, (0.12, 0.0))[2] == pytest.approx(0.12 * 3.8e-5, rel=0.01)
    assert near_floor(RADIUS + 0.05, (0.12, 0.0), 0.5)[2] == pytest.approx(0.004)


def near_ceiling(distance, thrust, gain=1.0):
    motion = standing((0.0, 0.0, 3.0 - distance + 0.05), rotors=(UP, AHEAD))
    p = (gain, RADIUS, 3.0)
    return np.array(CEILING_EFFECT.wrench(p, (), motion, (*thrust, *(0.0,) * 6)))


def test_ceiling_by_hand():
    # One radius below: (sqrt(1 + 1/8) - 1) / 2 = 0.0303; a quarter (sqrt 3 - 1) / 2, no more.
    for below, gained in ((1.0, 0.030330), (0.25, 0.366025), (0.1, 0.366025), (-2.0, 0.366025)):
        wrench = near_ceiling(below * RADIUS, (0.12, 0.0))
        np.testing.assert_allclose(
            wrench, 0.12 * gained * np.array([0, 0, 1, 0.2, -0.1, 0]), rtol=2e-5, atol=1e-17
        )
    assert not near_ceiling(RADIUS, (-0.12, 0.12)).any()
    assert near_ceiling(1.0, (0.12, 0.0))[2] < 5e-6


@pytest.mark.parametrize('effect', [GROUND_EFFECT, CEILING_EFFECT])
def test_rotors_without_a_size_are_refused_and_gain_nothing(effect):
    values = {parameter.name: parameter.null for parameter in effect.parameters}
    assert effect.check(values) == ''
    assert 'radius' in effect.check({**values, 'gain': 1.0})
    p = (1.0, *(0.0,) * (len(values) - 1))
    assert not any(effect.wrench(p, (), standing((0, 0, 0.05), rotors=(UP,)), (1.0,) * 8))


def test_a_ceiling_effect_needs_its_ceiling():
    values = {'gain': 1.0, 'radius': RADIUS, 'height': 0.0}
    assert 'height' in CEILING_EFFECT.check(values)
    assert CEILING_EFFECT.check({**values, 'height': 3.0}) == ''
