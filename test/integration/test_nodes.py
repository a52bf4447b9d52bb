# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Nodes over DDS: parameters, services, quality of service, and what they make of nonsense."""

from collections.abc import Iterator
from contextlib import contextmanager
import itertools
import math
import signal
import time

from builtin_interfaces.msg import Time
from domain import free_domain
from lta_control.messages import from_duties
from lta_graph.health import HealthLevel
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.publisher_conflict import CONFLICT_TASK
from lta_graph.ros.qos import select_profile
from lta_graph.ros.stamps import to_stamp
import pytest
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import DescribeParameters
from rclpy.qos import ReliabilityPolicy
from std_srvs.srv import SetBool, Trigger
from waiting import PATIENCE

from .peer import ended, Peer, running, TABLE

ROTORS = ['up_left', 'up_right', 'forward_left', 'forward_right']
STEP = TABLE.control_ns
ARMED = ('-p', 'armed:=true')
BEST_EFFORT, RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE
AGAIN = 5.0  # wall seconds without an answer after which an estimate is sent again


class Pilot(Peer):
    """A peer that records motor commands and the latest control step that it has sent."""

    def __init__(self, domain_id: int) -> None:
        super().__init__(domain_id)
        self.motors, self.log = [], []
        self.step = self.estimates = 0
        self.hear('motors', self.motors.append)
        self.node.create_subscription(Log, '/rosout', self.log.append, 100)

    def reads(self, severity: str, words: str) -> list[str]:
        """Wait until the controller has logged something, and return the lines."""

        def lines() -> list[str]:
            return [
                line.msg
                for line in self.log
                if line.name == 'lta1.controller'
                and line.level == getattr(Log, severity)
                and words in line.msg
            ]

        return self.until(lines)


@pytest.fixture
def peer(domain_id: int) -> Iterator[Pilot]:
    with Pilot(domain_id) as made:
        yield made


@contextmanager
def beside_a_controller(domain_id: int) -> Iterator[Pilot]:
    """Run an armed controller, yield a peer of it, and check that it exits without complaints."""
    with Pilot(domain_id) as pilot, running('lta_control.nodes.controller', *ARMED) as process:
        yield pilot
        ended(process)


@pytest.fixture
def controller(domain_id: int) -> Iterator[Pilot]:
    """Return the peer of a controller of its own: a test may stop its motors for good."""
    with beside_a_controller(domain_id) as pilot:
        yield pilot


@pytest.fixture(scope='module')
def shared() -> Iterator[tuple[int, Pilot]]:
    """Return domain and peer of a shared controller: no test may stop its motors for good."""
    with free_domain() as domain, beside_a_controller(domain) as pilot:
        yield domain, pilot


@pytest.fixture
def flown(shared: tuple[int, Pilot], monkeypatch: pytest.MonkeyPatch) -> Pilot:
    """Return the peer of the shared controller, and set its domain for `hear`."""
    domain, pilot = shared
    monkeypatch.setenv('ROS_DOMAIN_ID', str(domain))
    return pilot


def estimate(peer, step, **position):
    """Send an estimate of a drone at rest, level at 0.5 m, and return the duties in answer."""
    odom = find_message_type(TABLE['odom'])()
    odom.header.stamp = to_stamp(TABLE.start_ns + step * STEP)
    peer.estimates += 1
    # No height of a flight repeats to the bit
    noise = position.get('noise', 1e-6) * (peer.estimates % 2)
    odom.pose.pose.position.z = position.get('z', 0.5) + noise
    odom.pose.covariance[14] = position.get('variance', 1e-4)
    half = 0.5 * position.get('roll', 0.0)
    odom.pose.pose.orientation.x, odom.pose.pose.orientation.w = math.sin(half), math.cos(half)
    peer.motors.clear()
    publisher, sent = peer.publisher('odom'), -math.inf

    def answered():
        nonlocal sent
        # Best effort: a first message is lost if the controller has not found this publisher yet
        if time.monotonic() - sent > AGAIN:
            publisher.publish(odom)
            sent = time.monotonic()
        return peer.motors and peer.motors[-1].header.stamp == odom.header.stamp

    peer.until(answered)
    assert peer.motors[-1].name == ROTORS
    peer.step = max(peer.step, step)
    return list(peer.motors[-1].duty)


def setpoint(peer, altitude, step, heading=0.0):
    """Ask for an altitude and a heading, at rest, as seen at a control step."""
    for name in ('setpoint/velocity', 'setpoint/pose'):
        message = find_message_type(TABLE[name])()
        message.header.stamp = to_stamp(TABLE.start_ns + step * STEP)
        if name == 'setpoint/pose':
            message.pose.position.z = altitude
            half = 0.5 * heading
            message.pose.orientation.z, message.pose.orientation.w = math.sin(half), math.cos(half)
        peer.publisher(name).publish(message)


def flying_controller(peer):
    """Bring a controller to answer with thrust: setpoints have no order with the estimates."""
    first = peer.step + 1  # after the steps that earlier tests have sent
    for step in range(first, first + 500):
        setpoint(peer, 1.0, step)
        if any(estimate(peer, step)):
            return step
    raise AssertionError('no setpoint is flown')


def motors(facts):
    """Return what the controller says of its motors when all is not well."""
    fact = facts.get('controller: motors')
    return '' if fact is None or fact.level == HealthLevel.OK else fact.message


def test_one_half_of_a_setpoint_waits_for_the_other(flown):
    step = flying_controller(flown)
    velocity = find_message_type(TABLE['setpoint/velocity'])()
    velocity.twist.linear.x = 0.5
    for turn in range(30):  # the pose that came before is good for half a second
        velocity.header.stamp = to_stamp(TABLE.start_ns + (step + turn) * STEP)
        flown.publisher('setpoint/velocity').publish(velocity)
        forward = estimate(flown, step + turn)[2:]
        if min(forward) > 0.0:
            return
    raise AssertionError('the new speed was not flown without a new pose')


def test_one_half_alone_keeps_no_setpoint_alive(flown, hear):
    """Its age is that of the older half: a speed that goes on coming does not renew a heading."""
    step = flying_controller(flown)
    velocity = find_message_type(TABLE['setpoint/velocity'])()
    velocity.twist.linear.x = 0.5
    velocity.header.stamp = to_stamp(TABLE.start_ns + (step + 80) * STEP)
    flown.publisher('setpoint/velocity').publish(velocity)
    estimate(flown, step + 80)
    hear(lambda facts: 'holding' in motors(facts))


def test_a_drone_that_two_nodes_steer_comes_down_until_it_is_armed_again(controller, hear):
    later = itertools.count(flying_controller(controller) + 1)
    name, node = 'setpoint/pose', controller.beside()
    quality = select_profile(TABLE[name], lockstep=False)
    rival = node.create_publisher(find_message_type(TABLE[name]), name, quality)

    def fly_on():
        at = next(later)
        setpoint(controller, 1.0, at)
        return estimate(controller, at)

    def comes_down(facts):
        lift = fly_on()[:2]
        fact = facts.get('controller: commanders')
        return fact and 'landing' in fact.message and lift == [0.0, 0.0]

    hear(comes_down)
    assert len(controller.reads('ERROR', 'commanders: several nodes sent setpoints')) == 1
    refused = controller.ask(SetBool, 'arm', data=True)
    assert (refused.success, refused.message) == (
        False, '2 nodes send setpoints: stop all but one',
    )  # fmt: skip
    node.destroy_publisher(rival)
    controller.until(lambda: controller.node.count_publishers(name) == 1)
    assert all(fly_on()[:2] == [0.0, 0.0] for _ in range(50))  # whoever is left
    controller.until(lambda: controller.ask(SetBool, 'arm', data=True).success)
    controller.until(lambda: max(fly_on()) > 0.0)
    assert len(controller.reads('INFO', 'commanders: OK again')) == 1
    # While nothing is sent; on a busy machine some may be missed, and come, before
    controller.reads('ERROR', 'inputs: waiting for messages on odom, setpoint/pose, setpoint/velo')
    controller.until(lambda: max(fly_on()) > 0.0)
    controller.reads('INFO', 'inputs: OK again')


def airspeed_fact(facts):
    """Return what the controller says of the airspeed."""
    fact = facts.get('controller: airspeed')
    return '' if fact is None else fact.message


def test_without_the_airspeed_that_it_had_the_drone_lands(controller, hear):
    step = flying_controller(controller)
    airspeed = find_message_type(TABLE['airspeed'])()
    airspeed.header.stamp = to_stamp(TABLE.start_ns + step * STEP)
    controller.publisher('airspeed').publish(airspeed)
    later = itertools.count(step + 1)

    def fly_on():
        at = next(later)
        setpoint(controller, 1.0, at)
        return estimate(controller, at)[:2]

    hear(lambda facts: fly_on() and airspeed_fact(facts) == 'missing: landing')
    assert fly_on() == [0.0, 0.0]  # it sinks
    airspeed.header.stamp = to_stamp(TABLE.start_ns + next(later) * STEP)
    controller.publisher('airspeed').publish(airspeed)
    hear(lambda facts: max(fly_on()) > 0.0 and airspeed_fact(facts) == 'received again')


def test_not_a_number_stops_the_motors_for_good(controller, hear):
    step = flying_controller(controller)
    assert estimate(controller, step + 1, z=math.nan) == [0.0] * 4
    assert estimate(controller, step + 2) == [0.0] * 4
    hear(lambda facts: 'NaN or infinity' in motors(facts))
    refused = controller.ask(SetBool, 'arm', data=True)
    assert not refused.success
    assert 'NaN or infinity' in refused.message


def test_qualities_are_overridden_by_the_parameters_of_ros(peer):
    words = (
        '-p', 'qos_overrides./lta1/odom.publisher.reliability:=best_effort',
        '-p', 'qos_overrides./lta1/imu.subscription.reliability:=reliable',
    )  # fmt: skip
    with running('lta_control.nodes.estimator', *words):
        for topic, find, reliability in (
            ('/lta1/odom', peer.node.get_publishers_info_by_topic, BEST_EFFORT),
            ('/lta1/imu', peer.node.get_subscriptions_info_by_topic, RELIABLE),
        ):
            found = peer.until(lambda find=find, topic=topic: find(topic))
            assert [each.qos_profile.reliability for each in found] == [reliability]


def test_a_fault_at_the_very_end_is_logged(peer):
    with running('lta_control.nodes.controller', *ARMED) as process:
        assert peer.ask(Trigger, 'emergency_stop').success
        process.send_signal(signal.SIGINT)  # before the next look at the health
        _, errors = process.communicate(timeout=PATIENCE)
    assert errors.count('motors: emergency stop') == 1


def test_disarmed_motors_stand_still_and_armed_ones_turn(flown):
    step = flying_controller(flown)
    assert flown.ask(SetBool, 'arm', data=False).success
    assert estimate(flown, step + 1) == [0.0] * 4
    assert flown.ask(SetBool, 'arm', data=True).success
    assert any(estimate(flown, step + 2))


@pytest.mark.long
def test_a_flight_in_real_time_is_open_to_people(lta, peer, flying, hear, tmp_path):
    """Quality of service, parameters and services of a whole graph, as users find them."""
    flight = lta.start('fly', '--no-page', '--time', 'realtime', '--out', tmp_path / 'out')
    flying(2.5)

    for name, topic in TABLE.topics.items():
        full = name if name.startswith('/') else f'/lta1/{name}'
        offered = [info.qos_profile for info in peer.node.get_publishers_info_by_topic(full)]
        expected = select_profile(topic, lockstep=False)
        # A flight replays nothing, nobody is at its sticks, and no tracker sees it.
        assert bool(offered) == (topic.source not in {'player', 'teleop', 'tracker'}), name
        for quality in offered:
            assert quality.reliability == expected.reliability, name
            assert quality.durability == expected.durability, name
    imu = peer.node.get_subscriptions_info_by_topic('/lta1/imu')
    assert {info.node_name: info.qos_profile.reliability for info in imu} == {
        'estimator': BEST_EFFORT,
        'recorder': RELIABLE,
    }

    asked = ['gains.altitude_kp', 'vehicle', 'armed']
    told = peer.ask(DescribeParameters, 'controller/describe_parameters', names=asked).descriptors
    assert all(item.description for item in told)
    assert told[0].floating_point_range[0].from_value >= 0.0
    assert [item.read_only for item in told] == [False, True, True]
    assert peer.set('controller', 'gains.altitude_kp', 0.7).successful
    for name, value in (('gains.altitude_kp', -1.0), ('vehicle', 'other')):
        answer = peer.set('controller', name, value)
        assert not answer.successful
        assert answer.reason

    # Both the simulator and the estimator hear a command for some other drone.
    wrong = from_duties(Time(), ['left', 'right'], (1.0, 1.0))
    stranger = peer.publisher('motors')

    def refused(facts):
        stranger.publish(wrong)  # again: not all who listen have found the stranger yet
        return 'simulator: command' in facts

    hear(refused)
    hear(lambda facts: facts['simulator: command'].message == 'accepted')
    hear(lambda facts: f'controller: {CONFLICT_TASK}' in facts)

    assert peer.ask(Trigger, 'emergency_stop').success
    peer.motors.clear()
    peer.until(lambda: len(peer.motors) > 50)
    answers = [list(item.duty) for item in peer.motors if item.name == ROTORS]
    assert answers[1:] == [[0.0] * 4] * (len(answers) - 1)  # the first may have been on its way
    flight.interrupt()
    assert flight.end() == 130
    *told, last = flight.text.splitlines()
    assert last == 'Stopped.'
    # Other faults of the start and of the stranger's commands may be told as well
    assert set(told) >= {
        'controller: others: other nodes also publish motors (/lta1/peer); stop all but one.',
        'controller: motors: emergency stop: the motors are off; restart the controller to fly '
        'again.',
    }
