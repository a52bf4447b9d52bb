# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The cascade: signs, limits, feed-forward and the course of a hull without a keel."""

import math

from lta_control.laws.cascade import (
    cascade_step,
    CascadeMemory,
    slope_step,
    SlopeEstimate,
    steer_to_course,
    WrenchDemand,
)
from lta_control.motion import CascadeMeasurement, Setpoint, wrap_angle
import numpy as np
import pytest

from .round_gains import GAINS

AT_REST = CascadeMeasurement(
    altitude=0.5, climb=0.0, heading=0.0, yaw_rate=0.0, speed=0.0, sway=0.0, pitch_rate=0.0
)
HOLD = Setpoint(altitude=0.5, heading=0.0, speed=0.0)
NONE = WrenchDemand(0.0, 0.0, 0.0)
DT = 0.01


def ask(measured=AT_REST, setpoint=HOLD, memory=None, shortfall=NONE, gains=GAINS, **more):
    drag, lowest = more.get('drag', (0.0, 0.092)), more.get('lowest', -10.0)
    memory, sink = memory or CascadeMemory(), more.get('sink', 0.0)
    return cascade_step(gains, drag, lowest, sink, memory, measured, setpoint, shortfall, DT)


def test_too_low_is_pushed_up_by_the_product_of_the_gains():
    demand, memory = ask(AT_REST._replace(altitude=0.4))
    # 0.1 m low: 0.6 * 0.1 = 0.06 m/s asked, 0.5 N s/m times that.
    assert demand == (0.0, pytest.approx(0.5 * 0.06), 0.0)
    assert memory.climb == pytest.approx(DT * 0.15 * 0.06)


def test_too_high_is_pushed_down_only_as_far_as_the_rotors_can():
    assert ask(AT_REST._replace(altitude=0.6))[0].heave == pytest.approx(-0.03)
    assert ask(AT_REST._replace(altitude=0.6), lowest=0.0)[0].heave == 0.0
    assert ask(AT_REST._replace(altitude=0.6), lowest=-0.01)[0].heave == -0.01


def test_jets_that_draw_the_hull_down_are_let_to_where_it_is_too_high():
    """0.5 m/s asks 0.15 * 0.5 + 0.092 * 0.25 N of surge, limited to 0.05 + 0.023 N."""
    low = AT_REST._replace(altitude=0.55)
    demand, _ = ask(low, HOLD._replace(speed=0.5), lowest=0.0, sink=-0.1)
    share = 1.0 - 0.05 / 0.5
    assert demand.surge == pytest.approx(share * (0.05 + 0.092 * 0.25))
    assert demand.heave == pytest.approx(max(-0.5 * 0.6 * 0.05, -0.1 * demand.surge))
    assert ask(low, HOLD._replace(speed=0.5), lowest=0.0, sink=0.1)[0].heave == 0.0


def test_height_goes_before_speed():
    """Above its altitude, or about to be, it is pushed less, down to 0.3; below, as ever."""
    ahead = HOLD._replace(speed=0.5)
    whole = ask(setpoint=ahead)[0].surge
    for altitude, climb, share in (
        (0.5, 0.1, 0.8), (0.7, 0.0, 0.6), (0.7, -0.2, 1.0), (0.9, 0.0, 0.3), (9.0, 0.0, 0.3),
        (0.1, 0.0, 1.0),
    ):  # fmt: skip
        measured = AT_REST._replace(altitude=altitude, climb=climb)
        assert ask(measured, ahead)[0].surge == pytest.approx(share * whole), altitude


def test_a_swing_is_stopped_by_the_surge():
    """Nose going down at 0.3 rad/s: rotors below the hull push on, 0.2 N s/rad of it."""
    assert ask(AT_REST._replace(pitch_rate=0.3))[0].surge == pytest.approx(0.06)


def test_no_more_speed_is_asked_for_than_the_hull_bears():
    fast = steer_to_course(GAINS, AT_REST, HOLD._replace(speed=3.0))
    assert fast == steer_to_course(GAINS, AT_REST, HOLD._replace(speed=GAINS.speed_limit))


def test_the_force_is_limited():
    demand, _ = ask(AT_REST._replace(climb=-5.0))
    assert demand.heave == GAINS.climb.limit
    demand, _ = ask(AT_REST._replace(yaw_rate=-5.0))
    assert demand.yaw == GAINS.yaw_rate.limit
    demand, _ = ask(AT_REST._replace(speed=-5.0))
    assert demand.surge == GAINS.speed.limit


def test_a_lamp_to_the_left_turns_left():
    demand, memory = ask(setpoint=HOLD._replace(heading=0.2))
    assert demand == (0.0, 0.0, pytest.approx(0.04 * 0.6 * 0.2))
    assert memory.yaw_rate == pytest.approx(DT * 0.01 * 0.6 * 0.2)
    assert ask(setpoint=HOLD._replace(heading=-0.2))[0].yaw == pytest.approx(-0.04 * 0.6 * 0.2)


def test_it_turns_the_short_way_round():
    measured, setpoint = AT_REST._replace(heading=3.1), HOLD._replace(heading=-3.1)
    assert ask(measured, setpoint)[0].yaw == pytest.approx(0.04 * 0.6 * (2 * math.pi - 6.2))


@pytest.mark.parametrize('off', [0.3, 1.2, 1.9, 2.8, -2.8])
def test_speed_along_the_course_is_braked_whichever_way_the_nose_points(off):
    """Adrift along the course with the nose off it, the push must take speed away."""
    adrift = AT_REST._replace(heading=off, speed=0.3 * math.cos(off), sway=-0.3 * math.sin(off))
    demand, _ = ask(adrift, HOLD)
    push = np.array([math.cos(off), math.sin(off)]) * demand.surge
    assert push[0] == pytest.approx(-0.15 * 0.3 * math.cos(off) ** 2)


def test_a_negative_speed_is_that_of_a_flight_backwards():
    """Whatever the heading, and without the integral of the flight forward."""
    back, wanted = AT_REST._replace(speed=-0.5), HOLD._replace(heading=2.0, speed=-0.3)
    demand, memory = ask(back, wanted, drag=(0.0, 0.1), memory=CascadeMemory(speed=0.03))
    assert demand.surge == pytest.approx(0.15 * 0.2 - 0.1 * 0.3**2)
    assert memory.speed == pytest.approx(DT * 0.03 * 0.2)


def test_what_the_rotors_could_not_give_unwinds_the_integrals():
    memory = CascadeMemory(0.05, 0.002, 0.03)
    _, kept = ask(memory=memory)
    _, unwound = ask(memory=memory, shortfall=WrenchDemand(-0.02, -0.1, -0.001))
    assert kept[:3] == memory[:3]
    # Tracking time kp / ki of each loop.
    assert unwound.speed == pytest.approx(0.03 - DT * 0.03 / 0.15 * 0.02)
    assert unwound.climb == pytest.approx(0.05 - DT * 0.15 / 0.5 * 0.1)
    assert unwound.yaw_rate == pytest.approx(0.002 - DT * 0.01 / 0.04 * 0.001)


@pytest.mark.parametrize(
    ('error', 'share'), [(0.0, 1.0), (0.15, 0.75), (-0.3, 0.5), (0.6, 0.0), (2.0, 0.0)]
)
def test_it_turns_first(error, share):
    _, speed, *_ = steer_to_course(GAINS, AT_REST, Setpoint(0.5, error, 0.5))
    assert speed == pytest.approx(0.5 * share, abs=1e-15)


def test_the_speed_along_the_course_is_the_projection():
    generator = np.random.default_rng(5)
    for _ in range(20):
        nose, wanted, surge, sway = generator.uniform(-3.0, 3.0, 4)
        axes = np.array([[math.cos(nose), -math.sin(nose)], [math.sin(nose), math.cos(nose)]])
        velocity = axes @ (surge, sway)
        measured = AT_REST._replace(heading=nose, speed=surge, sway=sway)
        turn, _, along, _ = steer_to_course(GAINS, measured, Setpoint(0.5, wanted, 0.5))
        assert along == pytest.approx(velocity @ (math.cos(wanted), math.sin(wanted)), abs=1e-12)
        across = velocity @ (-math.sin(wanted), math.cos(wanted))
        lean = np.clip(1.5 * across, -0.7, 0.7)
        assert turn == pytest.approx(wrap_angle(wanted - lean - nose), abs=1e-12)


def test_a_slope_follows_a_ramp_and_starts_flat():
    """Behind 0.1 s of filter: 1 - exp(-t / 0.1) of the ramp's rate, a little late in steps."""
    slope = slope_step(SlopeEstimate(), 3.0, DT)
    assert slope == SlopeEstimate(3.0, 0.0)
    for k in range(1, 101):
        slope = slope_step(slope, 3.0 + 0.5 * k * DT, DT)
    assert slope.rate == pytest.approx(0.5, rel=1e-3)
    slope = SlopeEstimate(0.0, 0.0)
    for k in range(1, 11):
        slope = slope_step(slope, k * DT, DT)
    assert slope.rate == pytest.approx(1.0 - (0.1 / 0.11) ** 10, rel=1e-9)


@pytest.mark.parametrize(
    ('loop', 'field', 'axis'),
    [('climb', 'climb', 'heave'), ('yaw_rate', 'yaw_rate', 'yaw'), ('speed', 'speed', 'surge')],
)
def test_the_derivative_of_each_loop_brakes(loop, field, axis):
    """A measurement that rises is held back by kd times its smoothed rate."""
    braked = getattr(GAINS, loop).model_copy(update={'kd': 0.01})
    gains = GAINS.model_copy(update={loop: braked})
    _, memory = ask()
    rising = AT_REST._replace(**{field: 0.02})
    plain, _ = ask(rising, memory=memory)
    held, _ = ask(rising, memory=memory, gains=gains)
    rate = 0.02 / DT * DT / (0.1 + DT)
    assert getattr(held, axis) - getattr(plain, axis) == pytest.approx(-0.01 * rate, rel=1e-9)


def test_going_nowhere_it_brakes_only_what_moves_it_backwards():
    """Turning on the spot, drift to the side is no lack of speed: pushing would feed it."""
    turned = HOLD._replace(heading=0.5)
    assert ask(AT_REST._replace(sway=-0.2), turned)[0].surge == pytest.approx(0.0, abs=1e-12)
    assert ask(AT_REST._replace(speed=-0.1), turned)[0].surge == pytest.approx(0.15 * 0.1)
