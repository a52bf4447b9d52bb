"""Estimates and setpoints as ROS messages: frames, signs, and what is unknown."""

import math

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_control.airspeed import Airspeed
from lta_control.altitude import Altitude
from lta_control.carried import level, reach, setpoint, single, velocity
from lta_control.cascade import Setpoint
from lta_control.estimator import Estimate
from lta_control.messages import (
    from_duties,
    from_estimate,
    from_setpoint,
    heard_word,
    to_distance,
    to_duties,
    to_measured,
    to_setpoint,
    UNKNOWN,
)
from lta_control.per_rotor import NONE, slots
from lta_control.reserve import Word
from lta_graph.inbox import Step
import pytest
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import Bool

PITCH = 0.3  # nose down
FLYING = Estimate(
    ready=True,
    attitude=(0.0, math.sin(PITCH / 2), 0.0, math.cos(PITCH / 2)),
    rates=(0.01, 0.02, 0.03),
    altitude=Altitude(0.5, 0.1),
    airspeed=Airspeed(0.4, 0.05, 0.4, 0.05),
    flown=10.0,
)


def odometry(estimate):
    return from_estimate(Range().header.stamp, estimate)


def test_the_twist_is_in_the_body_frame():
    """Nose down by 0.3: 0.4 m/s ahead sinks, so a climb of 0.1 m/s needs that much more heave."""
    by_hand = (0.1 + 0.4 * math.sin(PITCH)) / math.cos(PITCH)
    assert velocity(FLYING)[2] == pytest.approx(by_hand)
    assert odometry(FLYING).twist.twist.linear.z == pytest.approx(by_hand)


def test_the_climb_comes_back():
    measured = to_measured(odometry(FLYING))
    assert measured.climb == pytest.approx(0.1)
    assert measured == pytest.approx((0.5, 0.1, 0.0, 0.03, 0.4, 0.05, 0.02), abs=1e-12)


def test_an_estimate_that_is_not_ready_is_unknown():
    message = odometry(Estimate())
    assert message.pose.covariance[0] == UNKNOWN
    assert to_measured(message) is None


def test_dead_reckoning_says_how_far_off_it_may_be():
    assert odometry(FLYING).pose.covariance[0] == pytest.approx(0.01**2 + 1.0)  # 0.1 m/s, 10 s


@pytest.mark.parametrize('distance', [0.039, 4.01, math.inf, -math.inf, math.nan, 0.0])
def test_a_distance_out_of_reach_is_none(distance):
    message = Range(min_range=0.04, max_range=4.0, range=distance)
    assert math.isnan(to_distance(message))


def test_a_distance_within_reach_counts():
    assert to_distance(Range(min_range=0.04, max_range=4.0, range=0.5)) == 0.5


def test_a_setpoint_survives_the_way_there_and_back():
    asked = Setpoint(0.7, -2.5, 0.3)
    assert to_setpoint(*from_setpoint(Range().header.stamp, asked)) == pytest.approx(asked)


@pytest.mark.parametrize(
    ('names', 'effort'), [(['a', 'b'], [0.1, 0.2]), (['a', 'b', 'c', 'd'], [0.1] * 3)]
)
def test_duties_that_do_not_fit_leave_those_before(names, effort):
    before = slots((0.1, 0.2, 0.3, 0.4))
    motors = JointState(name=names, effort=effort)
    assert to_duties(motors, ['a', 'b', 'c', 'd'], before) == before
    assert to_duties(None, ['a', 'b', 'c', 'd'], before) == before


def test_duties_that_fit_are_taken():
    motors = JointState(name=['a', 'b', 'c', 'd'], effort=[0.4, 0.3, 0.2, 0.1])
    assert to_duties(motors, ['a', 'b', 'c', 'd'], NONE) == slots((0.4, 0.3, 0.2, 0.1))


@pytest.mark.parametrize('count', [1, 2, 4, 6, 8])
def test_duties_survive_the_way_there_and_back(count):
    names = [f'rotor{index}' for index in range(count)]
    duties = slots(0.1 * index + 0.1 for index in range(count))
    message = from_duties(Range().header.stamp, names, duties)
    assert list(message.name) == names
    assert list(message.effort) == list(duties[:count])
    assert to_duties(message, names, NONE) == duties


def test_distances_at_the_limits_of_a_sensor_are_valid():
    assert (reach(0.04, 0.04, 4.0), reach(4.0, 0.04, 4.0)) == (0.04, 4.0)
    assert math.isnan(reach(0.03, 0.04, 4.0))
    assert math.isnan(reach(4.1, 0.04, 4.0))


def test_a_range_travels_in_32_bits_and_a_heading_as_a_level_attitude():
    assert single(0.1) == 13421773 / 2**27  # the float32 nearest to 0.1
    assert level(0.6) == (0.0, 0.0, math.sin(0.3), math.cos(0.3))
    assert setpoint(0.7, level(-2.5), 0.3) == pytest.approx((0.7, -2.5, 0.3))


@pytest.mark.parametrize(('upright', 'levelled'), [(0.11, True), (0.09, False)])
def test_heave_is_the_climb_rate_where_body_z_is_nearly_level(upright, levelled):
    """The vehicle is pitched nose down; the limit is a cosine of 0.1 between body z and up."""
    pitch = math.acos(upright)
    side = FLYING._replace(attitude=(0.0, math.sin(pitch / 2), 0.0, math.cos(pitch / 2)))
    heave = (0.1 + 0.4 * math.sin(pitch)) / upright
    assert velocity(side) == (0.4, 0.05, pytest.approx(heave if levelled else 0.1))


def test_the_climb_rate_of_a_rolled_vehicle_includes_its_sway():
    roll = 0.3
    rolled = FLYING._replace(attitude=(math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2)))
    heave = (0.1 - 0.05 * math.sin(roll)) / math.cos(roll)
    assert velocity(rolled) == pytest.approx((0.4, 0.05, heave))
    assert to_measured(odometry(rolled)).climb == pytest.approx(0.1)


def energy(stamp, reserve=None, level=None, why=''):
    """Return a step with the energy monitor's reserve, its status, both or neither."""
    status = [] if level is None else [DiagnosticStatus(level=level, message=why)]
    heard = {
        'energy/reserve': [] if reserve is None else [Bool(data=reserve)],
        'energy/status': [DiagnosticArray(status=status)] if status else [],
    }
    return Step(stamp, heard)


def test_reserve_and_status_may_come_in_different_steps():
    ok = heard_word(None, energy(1, False, b'\x00', 'all is well'))
    assert ok == Word(1, False, False, 'all is well')
    assert heard_word(ok, energy(2)) == ok
    # Their order does not matter; the stamp is that of the step with the reserve.
    first = heard_word(heard_word(ok, energy(2, level=b'\x02', why='hot')), energy(3, True))
    last = heard_word(heard_word(ok, energy(3, True)), energy(4, level=b'\x02', why='hot'))
    assert first == last == Word(3, True, True, 'hot')


def test_without_a_reserve_message_the_reserve_counts_as_reached():
    assert heard_word(None, energy(1)) is None
    assert heard_word(None, energy(1, level=b'\x01', why='warm')) == Word(1, True, False, 'warm')
    assert heard_word(None, energy(1, False)) == Word(1, False, False, '')


def test_a_status_of_error_is_urgent_without_a_reserve_message():
    ok = heard_word(None, energy(1, False, b'\x00'))
    assert heard_word(ok, energy(2, level=b'\x01')).urgent is False
    assert heard_word(ok, energy(2, level=b'\x02', why='hot')).urgent is True
