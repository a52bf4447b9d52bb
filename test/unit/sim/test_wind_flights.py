"""What wind and walls do to a flight, against closed forms."""

from itertools import pairwise
import math

from lta_model.effects.air import WIND_PROFILE
from lta_model.effects.protocol import AirEffectInput
from lta_model.state import POSITION, QUATERNION, RATES, SURROUNDINGS, VELOCITY
from lta_sim.kernels.kernel import advance
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from . import flat_balloon as balloon

OFF = np.zeros(4)
CALM = np.zeros(3)
CENTRED = (0.0, 0.0, 0.0)
DRAGGED = balloon.ADDED | {'linear_drag': {'surge': 0.05, 'sway': 0.05, 'heave': 0.05}}


def free(given, drag=True, cg=CENTRED):
    """Return a balloon that weighs what it displaces."""
    effects = balloon.NEUTRAL | (DRAGGED if drag else balloon.ADDED)
    return balloon.model(effects | given, cg, displaced=balloon.MASS)


def in_map(state):
    return Rotation.from_quat(state[QUATERNION]).apply(state[VELOCITY])


def test_a_free_balloon_drifts_with_the_wind():
    damped = {'rotational_drag': dict.fromkeys(('roll', 'pitch', 'yaw'), 2e-3)}
    wind = {'steady_wind': {'x': 0.8, 'y': -0.3, 'z': 0.1}}
    model = free(wind | damped, cg=balloon.CG)
    # Mass 0.36 and added mass 0.15 kg (heave more) over 0.05 N s/m: 10 to 15 s.
    state = advance(balloon.at(rates=(0.1, 0.2, 0.5)), model, OFF, CALM, 1e-2, 40_000)
    np.testing.assert_allclose(in_map(state), (0.8, -0.3, 0.1), atol=1e-9)


def test_the_wind_effect_and_the_wind_of_the_surroundings_are_one():
    start = balloon.at(velocity=(0.3, 0.2, -0.1), rates=(0.5, -0.4, 0.3))
    one = advance(
        start, free({'steady_wind': {'x': 0.8, 'y': -0.3, 'z': 0.1}}), OFF, CALM, 1e-2, 500
    )
    two = advance(start, free({}), OFF, (0.8, -0.3, 0.1), 1e-2, 500)
    np.testing.assert_allclose(one, two, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize('height', [0.5, 2.0])
def test_a_free_balloon_drifts_with_the_wind_at_its_height(height):
    profile = {'x': 8.0, 'y': 3.0, 'height': 10.0, 'roughness': 0.3, 'half_height': 0.3}
    start = balloon.at(position=(0.0, 0.0, height))
    state = advance(start, free({'wind_profile': profile}), OFF, CALM, 1e-2, 40_000)
    place = AirEffectInput((0.0, 0.0, height), CENTRED, CENTRED, (0.0,) * SURROUNDINGS)
    there = WIND_PROFILE.air(tuple(profile.values()), (), place)[:3]
    np.testing.assert_allclose(in_map(state), there, rtol=1e-9)
    assert state[2] == height


def test_a_gust_carries_an_inviscid_neutral_balloon_with_it_exactly():
    gust = {'x': 1.5, 'y': -0.4, 'z': 0.2, 'begin': 1.0, 'length': 0.5, 'hold': 0.7}
    model, state, dt = free({'gusts': gust}, drag=False), balloon.at(), 1e-2
    full = np.array([1.5, -0.4, 0.2])
    for k in range(300):
        state = advance(state, model, OFF, CALM, dt, 1)
        time = (k + 1) * dt
        edge = min(max(min(time - 1.0, 2.7 - time), 0.0), 0.5)
        wind = full * 0.5 * (1.0 - math.cos(math.pi * edge / 0.5))
        # Simpson's rule: h^4 / 2880 times the fourth derivative of DU/Dt, 7e3 m/s^6, for 0.5 s.
        np.testing.assert_allclose(in_map(state), wind, atol=5e-8)
    np.testing.assert_allclose(in_map(state), 0.0, atol=1e-9)
    # The way that the air has gone: two half rises and the time between.
    np.testing.assert_allclose(state[POSITION], (0.0, 0.0, 2.0) + full * (0.5 + 0.7), atol=1e-7)


def test_a_heavy_balloon_lags_behind_a_gust_as_its_mass_says():
    gust = {'x': 1.5, 'begin': 0.0, 'length': 0.5, 'hold': 10.0}
    displaced, added = 0.2, 0.146
    model = balloon.model(balloon.ADDED | {'gusts': gust}, CENTRED, displaced=displaced)
    state = advance(balloon.at(), model, OFF, CALM, 1e-3, 1000)
    share = (displaced + added) / (balloon.MASS + added)
    assert state[7] == pytest.approx(1.5 * share, rel=1e-9)


def test_an_inviscid_neutral_balloon_goes_round_with_an_eddy():
    turn, radius = 0.5, 2.0
    eddy = {'x_y': -turn, 'y_x': turn}
    start = balloon.at(position=(radius, 0.0, 1.0), velocity=(0.0, turn * radius, 0.0))
    state = advance(start, free({'wind_gradient': eddy}, drag=False), OFF, CALM, 1e-2, 500)
    angle = turn * 5.0
    place = (radius * math.cos(angle), radius * math.sin(angle), 1.0)
    np.testing.assert_allclose(state[POSITION], place, atol=1e-9)


def test_turbulence_moves_the_hull_and_noise_is_all_that_feeds_it():
    rough = dict.fromkeys(('along', 'across', 'up'), 0.3)
    rough |= dict.fromkeys(('along_length', 'across_length', 'up_length'), 1.0)
    model, state = free({'turbulence': rough}), balloon.at()
    assert not advance(state, model, OFF, CALM, 1e-2, 100)[VELOCITY].any()
    generator = np.random.default_rng(3)
    for _ in range(500):
        noise = generator.standard_normal(3) / math.sqrt(1e-2)
        state = advance(state, model, OFF, (0.0, 0.0, 0.0, *noise), 1e-2, 1)
    assert 0.01 < np.linalg.norm(in_map(state)) < 1.0
    assert np.linalg.norm(state[POSITION]) > 0.1


ROOM = {
    'x_low': -2.0, 'x_high': 2.0, 'y_low': -1.5, 'y_high': 1.5, 'ceiling': 3.0,
    'radius': 0.5, 'half_height': 0.3, 'stiffness': 100.0, 'relaxation': 0.05, 'friction': 0.3,
}  # fmt: skip


@pytest.mark.parametrize('seed', range(3))
def test_a_room_stays_a_room(seed):
    """A balloon that is thrown about stays inside, and walls only take energy."""
    generator = np.random.default_rng(seed)
    model = free({'walls': ROOM}, drag=False)
    velocity, rates = generator.uniform(-1.0, 1.0, 3), generator.uniform(-1.0, 1.0, 3)
    state = balloon.at(position=(0.0, 0.0, 2.0), velocity=(*velocity[:2], 0.3), rates=rates)
    masses = balloon.MASS + np.array([0.146, 0.146, 0.374])
    turning = np.diag(balloon.INERTIA) + [
        balloon.ADDED['added_inertia'].get(axis, 0.0) for axis in ('roll', 'pitch', 'yaw')
    ]
    start = np.sum(masses * state[VELOCITY] ** 2) + np.sum(turning * state[RATES] ** 2)
    for _ in range(60):
        state = advance(state, model, OFF, CALM, 2e-3, 500)
        # 0.5 N s at most meets 100 N/m: 0.2 m into a wall.
        assert abs(state[0]) < 1.9
        assert abs(state[1]) < 1.4
        assert state[2] < 2.9
        energy = np.sum(masses * state[VELOCITY] ** 2) + np.sum(turning * state[RATES] ** 2)
        assert energy <= start * (1.0 + 1e-6)
    assert energy < 0.9 * start


def test_wind_presses_a_balloon_against_the_wall_and_no_further():
    model = free({'walls': ROOM, 'steady_wind': {'x': 1.0}})
    state = advance(balloon.at(), model, OFF, CALM, 2e-3, 100_000)
    # 0.05 N of drag on 100 N/m: half a millimetre into the wall.
    assert state[0] == pytest.approx(1.5 + 0.05 / 100.0, abs=1e-9)
    np.testing.assert_allclose(state[7:], 0.0, atol=1e-9)


def test_a_wall_that_does_not_damp_gives_everything_back():
    elastic = ROOM | {'relaxation': 0.0, 'friction': 0.0}
    start = balloon.at(position=(1.0, 0.0, 1.5), velocity=(0.5, 0.0, 0.0))
    state = advance(start, free({'walls': elastic}, drag=False), OFF, CALM, 1e-4, 20_000)
    # The step in which it touches and that in which it leaves are not smooth.
    assert state[7] == pytest.approx(-0.5, rel=1e-6)


def test_smooth_effects_converge_with_the_fourth_power_of_the_step():
    smooth = {
        'steady_wind': {'x': -0.3, 'z': 0.1},
        'wind_profile': {'x': -1.0, 'roughness': 0.03, 'half_height': 0.3},
        'wind_gradient': {'x_y': 0.3, 'z_x': -0.2, 'y_y': 0.1},
        'munk_moment': {'lost': 0.4},
        'hull_lift': {
            'density': 1.2, 'area': 0.25, 'drag': 0.24, 'drag_alpha2': 4.4, 'lift': 0.16,
            'lift_alpha': 2.9, 'side_beta': -2.1, 'pitch': 0.06, 'yaw_beta': -0.09,
            'roll_rate': 0.05, 'pitch_rate': 0.03, 'yaw_rate': 0.01,
        },
    }  # fmt: skip
    model = free(smooth, cg=balloon.CG)
    start = balloon.at(velocity=(1.2, 0.3, 0.2), rates=(0.3, 0.2, 0.4))

    def after(steps):
        return advance(start, model, OFF, CALM, 2.0 / steps, steps)[:13]

    best = after(3200)
    errors = [np.linalg.norm(after(steps) - best) for steps in (50, 100, 200)]
    assert errors[-1] > 1e-12
    for coarse, fine in pairwise(errors):
        assert 3.8 < math.log2(coarse / fine) < 4.3
