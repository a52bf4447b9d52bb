"""Flights of a balloon out of balance, against closed forms: tilts, energy, period, spin-down."""

import math

from lta_model.effect_parameters import build_strips, DragBox
from lta_model.state import COMMAND, MASS_PLACE, QUATERNION, RATES
from lta_sim.kernels.kernel import advance
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from . import flat_balloon as balloon

OFF = np.zeros(4)
CALM = np.zeros(3)
NEUTRAL = balloon.NEUTRAL | balloon.ADDED
DAMPED = NEUTRAL | {'rotational_drag': {'roll': 0.02, 'pitch': 0.02, 'yaw': 0.02}}
MASS, DEPTH = balloon.MASS, -balloon.CG[2]


def model(given):
    return balloon.model(given, displaced=MASS)


def told(*place):
    command = np.zeros(COMMAND)
    command[MASS_PLACE:] = place
    return command


def tilt(state):
    """Return yaw, pitch and roll. [rad]."""
    return Rotation.from_quat(state[QUATERNION]).as_euler('ZYX')


def swung(pitch):
    state = balloon.at()
    state[QUATERNION] = (0.0, math.sin(0.5 * pitch), 0.0, math.cos(0.5 * pitch))
    return state


MOVING = {'mass': 0.05, 'x': 0.06, 'z': -0.2, 'lag': 0.5}


def test_a_moved_mass_tilts_by_the_closed_form():
    command = told(0.06 + 0.03, 0.0, -0.2)
    state = advance(
        balloon.at(), model(DAMPED | {'moving_mass': MOVING}), command, CALM, 2e-3, 60_000
    )
    first = LAYOUT.remembers['moving_mass']
    np.testing.assert_allclose(state[first : first + 3], (0.03, 0.0, 0.0), atol=1e-12)
    expected = math.atan(0.05 * 0.03 / (MASS * DEPTH))
    np.testing.assert_allclose(tilt(state), (0.0, expected, 0.0), atol=1e-9)


def test_a_mass_at_its_place_does_nothing():
    with_mass = model(DAMPED | {'moving_mass': MOVING})
    start = swung(0.2)
    one = advance(start, with_mass, told(0.06, 0.0, -0.2), CALM, 2e-3, 1000)
    two = advance(start, model(DAMPED), OFF, CALM, 2e-3, 1000)
    np.testing.assert_array_equal(one[:13], two[:13])


def test_the_mass_moves_at_its_speed_and_then_settles():
    slow = model(DAMPED | {'moving_mass': MOVING | {'speed': 0.02}})
    first = LAYOUT.remembers['moving_mass']
    command = told(0.06 + 0.06, 0.0, -0.2 + 0.08)
    state = advance(balloon.at(), slow, command, CALM, 2e-3, 1000)
    np.testing.assert_allclose(state[first : first + 3], (0.024, 0.0, 0.032), atol=1e-12)


def test_a_moved_mass_swings_without_loss():
    """Without lag its weight is a potential: mass g times the height of its way."""
    given = NEUTRAL | {'moving_mass': {'mass': 0.05, 'x': 0.06, 'z': -0.2}}
    vehicle, away = model(given), np.array((0.02, 0.01, -0.01))
    command = told(*np.add(away, (0.06, 0.0, -0.2)))
    inverse = vehicle.inverse.reshape(6, 6)
    matrix = np.linalg.inv(inverse)

    def energy(state):
        turn, nu = Rotation.from_quat(state[QUATERNION]), state[7:13]
        potential = MASS * turn.apply(balloon.CG)[2] + 0.05 * turn.apply(away)[2]
        return 0.5 * nu @ matrix @ nu + balloon.G * potential

    state = balloon.at(rates=(0.5, -1.0, 0.7))
    start = energy(state)
    for _ in range(4):
        state = advance(state, vehicle, command, CALM, 5e-4, 5000)
        assert abs(energy(state) - start) < 1e-9 * MASS * balloon.G * DEPTH


def test_a_cg_ahead_tips_the_nose_down():
    state = advance(
        balloon.at(), model(DAMPED | {'cg_offset': {'x': 0.01, 'y': 0.0}}), OFF, CALM, 2e-3, 60_000
    )
    np.testing.assert_allclose(tilt(state), (0.0, math.atan(0.01 / DEPTH), 0.0), atol=1e-9)


def test_a_frame_brakes_a_spin_as_one_over_time():
    """I dw/dt = -D w^2: w = w_0 / (1 + D w_0 t / I); a post 1 m off the axis, D = drag."""
    post = build_strips([DragBox((0.0, 1.0, 0.0), (0.01, 0.01, 0.3), 1.0)], 1.2)
    drag = 0.6 * 0.01 * 0.3
    state = advance(
        balloon.at(rates=(0.0, 0.0, 2.0)),
        model(NEUTRAL | {'strip_damping': post}),
        OFF,
        CALM,
        2e-3,
        5000,
    )
    assert state[RATES][2] == pytest.approx(2.0 / (1.0 + drag * 2.0 * 10.0 / 0.018), rel=1e-9)
