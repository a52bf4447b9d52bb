# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The filter of the motion over ground, by hand calculations and by a simulation of its own."""

import math

from lta_control.estimator import MotionEstimate
from lta_control.motion_filters import AltitudeEstimate, HullDragModel
from lta_control.odometry import ground_filter
from lta_control.odometry.ground_motion import (
    ground_step,
    ModelledMotion,
    read_modelled_motion,
)
from lta_control.odometry.ground_state import (
    BEARING,
    BRIGHTNESS,
    GroundMotion,
    GroundSettings,
    LOG_DISTANCE,
    rotate_covariance,
    start_ground_motion,
)
from lta_control.sighting import build_sighting, LampPosition, LampSighting, TRUSTED
import numpy as np
import pytest

DT = 0.01
SETTINGS = GroundSettings()
MASS, DRAG = 0.55, 0.092
HULL = HullDragModel((MASS, MASS), (0.0, 0.0), (DRAG, DRAG))
AXES = tuple((math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4)


def fly(seconds, motion, state=None, settings=SETTINGS, sighting=lambda _: None):
    """Return the state after a steady modelled motion."""
    state = state or GroundMotion()
    for k in range(round(seconds / DT)):
        state = ground_step(settings, HULL, state, motion, sighting(k), DT)
    return state


def resting(ready=True):
    return ModelledMotion(ready, 0.0, 0.0, 0.0, 0.0)


def test_a_tracked_position_counts_by_its_variance():
    """The origin has 1 cm, as the tracker does: half way to it, and 1 / sqrt(2) cm."""
    state = ground_filter.correct_place(start_ground_motion(SETTINGS), (0.04, -0.02), 0.01)
    assert state.position == pytest.approx((0.02, -0.01))
    assert state.position_covariance == pytest.approx((0.5e-4, 0.0, 0.5e-4))


def test_a_tracker_shows_the_wind_that_no_sensor_on_board_does():
    """A drone without thrust that is carried along at 0.2 m/s, seen at 10 Hz."""
    state = GroundMotion()
    for k in range(2000):
        place = (0.2 * DT * (k + 1), 0.0)
        state = ground_step(SETTINGS, HULL, state, resting(), None, DT, place)
    assert state.velocity == pytest.approx((0.2, 0.0), abs=0.02)
    assert state.position == pytest.approx((4.0, 0.0), abs=0.01)
    assert math.sqrt(state.position_covariance[0]) < 0.01
    still = fly(20.0, resting())
    assert still.velocity == (0.0, 0.0)


def test_position_and_frame_begin_when_the_biases_are_known():
    state = fly(3.0, resting(ready=False))
    assert state.position == (0.0, 0.0)
    assert state.mean[2:4] == (0.0, 0.0)


def test_a_drone_that_stands_tells_little_of_the_wind():
    """Held by hand before a lamp for ten seconds."""
    lamp = LampSighting(0.0, 0.02, 5.0, 0.75, 70.0, 150.0, 0.0)

    def wait(on_ground):
        motion = resting()._replace(on_ground=on_ground)
        return fly(10.0, motion, sighting=lambda k: None if k % 10 else lamp)

    states = {on_ground: wait(on_ground) for on_ground in (True, False)}
    held, free = (math.sqrt(states[on_ground].rows[5][5]) for on_ground in (True, False))
    # Of the wind across, by a bearing that does not change
    assert held > 1.5 * free


def test_a_drone_that_stands_still_stays_where_it_is_and_tells_nothing_of_the_wind():
    standing = resting()._replace(on_ground=True, stands=True)
    state = fly(1.0, standing)
    state = state._replace(mean=(1.0, 2.0, 0.0, 0.0, 0.3, 0.0, *state.mean[6:]))
    after = fly(60.0, standing, state)
    assert after.position == (1.0, 2.0)
    assert after.velocity == (0.0, 0.0)
    # By 1 cm, and 1 cm more in a second
    assert after.position_covariance == pytest.approx((62.0e-4, 0.0, 62.0e-4), rel=0.01)
    assert after.velocity_covariance == pytest.approx((1e-4, 0.0, 1e-4))
    assert after.mean[4] == 0.3
    assert after.rows[4][4] == pytest.approx(SETTINGS.wind**2 + 61.0 * SETTINGS.gusts**2)
    # It begins to drift with the air as soon as it is off the floor
    assert fly(1.0, resting(), after).velocity[0] > 0.01


def test_a_drone_stands_still_on_the_floor_without_motors():
    height = AltitudeEstimate(height=0.4, climb=0.0)
    still = MotionEstimate(ready=True, altitude=height, rates=(0.002, -0.002, 0.002))
    assert read_modelled_motion(still, 0.4).stands
    duties = (0.3, *still.duties[1:])
    for moving in (
        still._replace(duties=duties),
        still._replace(rates=(0.0, 0.0, -0.1)),
        still._replace(altitude=height._replace(climb=-0.2)),
        still._replace(altitude=height._replace(height=0.5)),
    ):
        assert not read_modelled_motion(moving, 0.4).stands


def test_the_frame_begins_where_the_biases_are_known():
    waited = fly(30.0, resting(ready=False))
    assert waited.position_covariance == pytest.approx((1e-4, 0.0, 1e-4))


def simulate_wind(wind, seconds=20.0, seed=0, gust=0.0):
    """
    Return filter and truth of a drone that is released in wind and flies across a lamp.

    After 10 s, `gust` [m/s] comes from the side.
    """
    chance = np.random.default_rng(seed)
    lamp, place, speed = np.array([7.0, 0.0]), np.zeros(2), np.zeros(2)
    modelled, state = np.zeros(2), GroundMotion()
    thrust = np.array([0.02, 0.012])

    def drag(v):
        return DRAG * np.hypot(*v) * v

    for k in range(round(seconds / DT)):
        now = wind + np.array([0.0, gust if k * DT > 10.0 else 0.0])
        speed = speed + DT * (thrust - drag(speed - now)) / MASS
        modelled = modelled + DT * (thrust - drag(modelled)) / MASS
        place = place + DT * speed
        sighting = None
        if k % 10 == 0:
            way = lamp - place
            away = np.hypot(*way)
            bearing = math.atan2(way[1], way[0]) + 0.02 * chance.standard_normal()
            strength = 1800.0 / away**2 * math.exp(0.05 * chance.standard_normal())
            sighting = LampSighting(bearing, 0.02, 4.0, 0.75, strength, 150.0, 0.0)
        state = ground_step(
            SETTINGS, HULL, state, ModelledMotion(True, 0.0, 0.0, *modelled), sighting, DT
        )
    return state, place, speed


def test_a_correction_by_a_lamp_comes_little_by_little():
    """The drone ran into a jump of `odom` of 0.26 m near the lamp."""
    state = simulate_wind(np.array([0.0, 0.4]), seconds=6.0)[0]
    motion = ModelledMotion(True, 0.0, 0.0, 0.0, 0.0)
    away = math.exp(state.mean[LOG_DISTANCE])
    expected = math.exp(state.mean[BRIGHTNESS]) / away**2
    aside = LampSighting(state.mean[BEARING] + 0.15, 0.02, 4.0, 0.75, expected, 150.0, 0.0)
    after = ground_step(SETTINGS, HULL, state, motion, aside, DT)
    unseen = ground_step(SETTINGS, HULL, state, motion, None, DT)
    assert after.position == pytest.approx(unseen.position, abs=1e-12)
    assert math.hypot(*after.pending) > 0.03
    widened = after.rows[0, 0] + after.pending[0] ** 2
    assert after.position_covariance[0] == pytest.approx(widened)
    for _ in range(round(2.0 / DT)):
        after = ground_step(SETTINGS, HULL, after, motion, None, DT)
    # Exponential, with 0.7 s: after 2 s, 6 % are left
    assert after.position == pytest.approx(after.mean[:2], abs=0.06 * 0.26)


@pytest.mark.parametrize('wind', [(0.0, 0.0), (-0.4, 0.0), (0.0, 0.4), (0.2, -0.2)])
def test_a_lamp_shows_the_wind_and_the_covariance_is_honest(wind):
    squares, widths = [], []
    for seed in range(4):
        state, place, speed = simulate_wind(np.array(wind), seed=seed)
        error = np.array([*state.velocity, *state.position]) - [*speed, *place]
        variances = np.array([*state.velocity_covariance[::2], *state.position_covariance[::2]])
        squares.append(error**2 / variances)
        widths.append(variances)
    # Without the lamp it would be 0.3 m/s
    assert np.sqrt(np.mean(widths, axis=0))[:2].max() < 0.2
    assert np.mean(squares) < 2.0


def test_innovations_show_a_gust_and_the_covariance_grows(monkeypatch):
    """A gust of 2 m/s for 8 s, which the filter does not expect."""

    def square_of_sway(most):
        monkeypatch.setattr(ground_filter, 'MOST_EXCESS', most)
        squares = []
        for seed in range(3):
            state, _, speed = simulate_wind(np.zeros(2), 18.0, seed, gust=2.0)
            squares.append((state.velocity[1] - speed[1]) ** 2 / state.velocity_covariance[2])
        return float(np.mean(squares))

    assert square_of_sway(1.0) < 0.5 * square_of_sway(0.0)


def test_another_lamp_is_another_lamp_and_the_wind_is_kept():
    first, _, _ = simulate_wind(np.array([0.0, 0.4]))
    other = LampSighting(-2.0, 0.02, 4.0, 0.75, 40.0, 230.0, 0.0)
    after = ground_step(SETTINGS, HULL, first, resting(), other, DT)
    assert after.frequency == 230.0
    assert after.mean[6] == -2.0
    assert after.mean[4:6] == pytest.approx(first.mean[4:6])
    assert after.velocity_covariance == pytest.approx(first.velocity_covariance, rel=0.05)


def test_an_outlier_changes_nothing_until_it_lasts():
    state, _, _ = simulate_wind(np.array([0.0, 0.0]))
    reflection = LampSighting(state.mean[6] + 1.5, 0.02, 4.0, 0.75, 5.0, 150.0, 0.0)
    still = ModelledMotion(True, 0.0, 0.0, *state.air)
    once = ground_step(SETTINGS, HULL, state, still, reflection, DT)
    assert once.mean[6] == pytest.approx(state.mean[6], abs=0.02)
    # Two seconds of it are another lamp, or the filter was wrong
    lasting = fly(2.0, still, state, sighting=lambda k: reflection if k % 10 == 9 else None)
    assert lasting.mean[6] == pytest.approx(reflection.bearing, abs=0.1)


@pytest.mark.parametrize('doubtful', [2.0, 12.0, 300.0])
def test_sightings_that_contradict_each_other_end_in_no_nonsense(doubtful):
    """Whatever is seen, the estimate stays finite, and no later step is lost by an earlier one."""
    rng = np.random.default_rng(3)
    restarts = 0
    for _ in range(30):
        state = fly(0.5, resting())
        for _ in range(100):
            bearing, loud, far = rng.uniform(-3.0, 3.0, 3).tolist()
            strength, distance = math.exp(2.5 * loud), math.exp(2.0 * far)
            spread = float(rng.uniform(0.0, doubtful))
            seen = LampSighting(bearing, 1e-3, distance, spread, strength, 150.0, 0.0)
            motion = ModelledMotion(True, 0.0, 0.0, *rng.uniform(-2.0, 2.0, 2).tolist())
            state = fly(0.1, motion, state, sighting=lambda k, seen=seen: seen if k == 9 else None)
            for planar in (state.position_covariance, state.velocity_covariance):
                assert np.isfinite(planar).all()
                assert min(planar[0], planar[2]) >= 0.0
            assert np.isfinite((*state.position, *state.velocity)).all()
        restarts += state.restarts
    assert restarts < 3000  # not at each sighting


def test_a_state_that_is_not_a_number_begins_again_where_the_drone_was():
    flown = fly(5.0, ModelledMotion(True, 0.0, 0.0, 0.5, 0.0))
    spoilt = flown._replace(mean=(*flown.mean[:6], math.nan, math.nan, 0.0), frequency=150.0)
    after = fly(1.0, resting(), spoilt)
    assert after.restarts == 1
    assert after.position == pytest.approx(flown.position, abs=1.0)
    assert after.position_covariance[0] >= 100.0  # m2
    assert np.isfinite(after.rows).all()


def sight(**changes):
    """Return the sighting of a lamp 3 m ahead and 4 m to the left."""
    lamp = LampPosition(3.0, 4.0, 0.5, (4.0 * 0.36 + 1e-3, 4.0 * 0.48, 4.0 * 0.64 + 1e-3))
    values = {'lamp': lamp, 'amplitudes': (10.0,) + (1.0,) * 7, 'frequencies': (150.0,) * 8}
    values |= changes
    return build_sighting(values['lamp'], AXES, values['amplitudes'], values['frequencies'], 0.06)


def test_a_sighting_by_hand():
    seen = sight()
    assert seen.bearing == pytest.approx(math.atan2(4.0, 3.0))
    assert seen.distance == pytest.approx(5.0)
    assert seen.spread == pytest.approx(math.sqrt(4.0 + 1e-3) / 5.0)  # 2 m along the ray
    assert seen.strength == pytest.approx(4.0 * 9.0 / 8.0)  # the eight equal parts cancel
    assert seen.frequency == 150.0


@pytest.mark.parametrize(
    'changes',
    [
        {'lamp': None},
        {'amplitudes': (), 'frequencies': ()},
        {'frequencies': (150.0,)},
        {'frequencies': (math.nan,) * 8},
        {'amplitudes': (math.nan,) * 8},
        {'lamp': LampPosition(math.nan, 4.0, 0.5, (1.0, 0.0, 1.0))},
        # Across the ray by more than is trusted
        {'lamp': LampPosition(3.0, 0.0, 0.5, (1.0, 0.0, 10.0 * (2.0 * TRUSTED) ** 2))},
    ],
)
def test_a_lamp_that_is_not_seen_well_is_no_sighting(changes):
    assert sight(**changes) is None


def test_a_covariance_turns_with_its_axes():
    assert rotate_covariance((4.0, 0.0, 1.0), math.pi / 2) == pytest.approx((1.0, 0.0, 4.0))
    matrix = np.array([[4.0, 0.7], [0.7, 1.0]])
    cos, sin = math.cos(0.4), math.sin(0.4)
    turned = np.array([[cos, sin], [-sin, cos]]) @ matrix @ np.array([[cos, -sin], [sin, cos]])
    expected = turned[0, 0], turned[0, 1], turned[1, 1]
    assert rotate_covariance((4.0, 0.7, 1.0), 0.4) == pytest.approx(expected)
