"""The lean spin of one node: timers, services and clients are served as rclpy's executor does."""

import time

from lta_graph.ros.spin import list_actions, spin_node
import pytest
import rclpy
from rclpy.action import ActionServer
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from waiting import PATIENCE

STEADY = Clock(clock_type=ClockType.STEADY_TIME)


@pytest.fixture
def node(domain_id):
    rclpy.init()
    yield Node('alone')
    rclpy.shutdown()


def spin_until(node, done):
    """Spin until something holds; a test that waits in vain fails by what it asserts."""
    end = time.monotonic() + PATIENCE
    spin_node(node, lambda: not done() and time.monotonic() < end, lambda: node.subscriptions)


def test_a_service_is_answered_and_the_answer_taken(node):
    def answer(_, response):
        response.message = 'here'
        return response

    node.create_service(Trigger, 'ask', answer)
    client = node.create_client(Trigger, 'ask')
    answers = []

    def ask():
        timer.cancel()
        future = client.call_async(Trigger.Request())
        future.add_done_callback(lambda done: answers.append(done.result().message))

    timer = node.create_timer(0.01, ask, clock=STEADY)
    spin_until(node, lambda: answers)
    assert answers == ['here']


def test_a_cancelled_timer_does_not_tick(node):
    ticks = []
    node.create_timer(0.01, lambda: (ticks.append('first'), second.cancel()), clock=STEADY)
    second = node.create_timer(0.01, lambda: ticks.append('second'), clock=STEADY)
    spin_until(node, lambda: len(ticks) >= 5)
    assert ticks == ['first'] * 5


def test_timers_keep_their_periods(node):
    ticks = {0.01: 0, 0.05: 0}

    def count(period):
        ticks[period] += 1

    for period in ticks:
        node.create_timer(period, lambda period=period: count(period), clock=STEADY)
    spin_until(node, lambda: ticks[0.05] >= 20)
    assert ticks[0.05] == 20
    # A machine that stalls lets ticks go, of the quick timer more than of the slow one.
    assert 20 <= ticks[0.01] <= 5 * 20 + 5


def test_entities_come_and_go_while_the_node_spins(node):
    """By callbacks: each kind is served once it is there, and a destroyed one stops nothing."""
    heard, answers = [], []
    doomed = node.create_subscription(Float64, 'in', heard.append, 10)
    condemned = node.create_timer(0.01, lambda: heard.append('tick'), clock=STEADY)

    def answer(_, response):
        answers.append(response)
        return response

    def destroy(_):
        for end, entity in ((node.destroy_subscription, doomed), (node.destroy_timer, condemned)):
            end(entity)

    def change():
        change.timer.cancel()
        node.create_subscription(Float64, 'in', destroy, 10)
        node.create_service(Trigger, 'ask', answer)
        client = node.create_client(Trigger, 'ask')
        publisher = node.create_publisher(Float64, 'in', 10)

        def speak():
            if len(answers) < 3:
                publisher.publish(Float64())
                client.call_async(Trigger.Request())

        node.create_timer(0.01, speak, clock=STEADY)

    change.timer = node.create_timer(0.01, change, clock=STEADY)
    spin_until(node, lambda: len(answers) >= 3 and doomed not in list(node.subscriptions))
    assert len(answers) >= 3
    assert condemned not in list(node.timers)


def test_an_exception_leaves_the_spin(node):
    def breaks():
        raise ValueError('on purpose')

    node.create_timer(0.01, breaks, clock=STEADY)
    with pytest.raises(ValueError, match='on purpose'):
        spin_until(node, lambda: False)


def test_the_spin_waits_for_actions_but_not_for_events_of_topics(node):
    node.create_publisher(Float64, 'out', 1)
    node.create_subscription(Float64, 'in', print, qos_profile_sensor_data)
    assert len(list(node.waitables)) > 0
    assert list_actions(node) == []
    action = pytest.importorskip('lta_msgs.action').Land
    server = ActionServer(node, action, 'land', print)
    assert list_actions(node) == [server]
    server.destroy()
