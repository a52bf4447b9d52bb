"""Estimates and setpoints as ROS messages: frames, signs, and what is unknown."""

import math

from lta_control.airspeed import Airspeed
from lta_control.altitude import Altitude
from lta_control.carried import velocity
from lta_control.cascade import Setpoint
from lta_control.estimator import Estimate
from lta_control.messages import (
    from_duties,
    from_estimate,
    from_setpoint,
    to_distance,
    to_duties,
    to_measured,
    to_setpoint,
    UNKNOWN,
)
from lta_control.per_rotor import NONE, slots
import pytest
from sensor_msgs.msg import JointState, Range

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
    setpoint = Setpoint(0.7, -2.5, 0.3)
    assert to_setpoint(*from_setpoint(Range().header.stamp, setpoint)) == pytest.approx(setpoint)


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
