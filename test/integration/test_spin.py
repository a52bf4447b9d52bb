# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The spin of nodes: rclpy's EventsExecutor, around its faults, and exceptions by their node."""

from contextlib import ExitStack
import time

from lta_control.nodes.navigator import Navigator
from lta_graph.ros.contained_node import ContainedNode
from lta_graph.ros.process import finish_waiting_events, open_executor, POLL, spin_for
import pytest
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from waiting import PATIENCE

STEADY = Clock(clock_type=ClockType.STEADY_TIME)


@pytest.fixture
def executor(domain_id):
    with ExitStack() as stack:
        rclpy.init(domain_id=domain_id)
        stack.callback(rclpy.shutdown)
        yield stack.enter_context(open_executor(rclpy.get_default_context()))


@pytest.fixture
def node(executor):
    made = ContainedNode('alone')
    executor.add_node(made)
    return made


def spin_until(executor, node, done):
    """Spin until something holds; a test that waits in vain fails by what it asserts."""
    end = time.monotonic() + PATIENCE
    while not done() and node.fault is None and time.monotonic() < end:
        spin_for(executor, [node])


def test_a_subscription_is_destroyed_while_an_event_of_it_waits(executor, node):
    """It has matched a publisher of another quality, of which rclpy's executor tells too late."""
    publisher = node.create_publisher(Float64, 'in', 10)
    node.create_publisher(Float64, 'in', qos_profile_sensor_data)
    generations = []

    def renew(_):
        if generations:
            node.destroy_subscription(generations[-1])
        generations.append(node.create_subscription(Float64, 'in', renew, 10))

    renew(Float64())
    node.create_timer(0.002, lambda: publisher.publish(Float64()), clock=STEADY)
    spin_until(executor, node, lambda: len(generations) > 20)
    assert len(generations) > 20
    assert node.fault is None


def test_a_spin_ends_in_time_while_events_are_waiting(executor, node):
    """The executor's own time limit would not: each message brings the next."""
    publisher = node.create_publisher(Float64, 'in', 10)
    heard = []

    def answer(message):
        heard.append(message)
        publisher.publish(message)

    node.create_subscription(Float64, 'in', answer, 10)
    spin_until(executor, node, publisher.get_subscription_count)
    publisher.publish(Float64())
    spin_until(executor, node, lambda: len(heard) > 100)
    assert len(heard) > 100


def test_the_events_that_wait_are_finished(executor, node):
    done = []
    for number in range(3):
        executor.create_task(lambda number=number: done.append(number))
    finish_waiting_events(executor, [node])
    assert done == [0, 1, 2]


@pytest.mark.parametrize('kind', ['message', 'timer', 'service'])
def test_an_exception_is_the_fault_of_its_node(executor, node, kind):
    own = ['--ros-args', '-r', '__node:=other']
    other = ContainedNode('named', cli_args=own, use_global_arguments=False)
    assert other.get_name() == 'other'
    executor.add_node(other)
    ticks = []

    def breaks(*_):
        ticks.append(kind)
        raise ValueError('on purpose')

    publisher = node.create_publisher(Float64, 'in', 10)
    client = node.create_client(Trigger, 'ask')
    if kind == 'message':
        other.create_subscription(Float64, 'in', breaks, 10)
    elif kind == 'timer':
        other.create_timer(POLL, breaks, clock=STEADY)
    else:
        other.create_service(Trigger, 'ask', breaks)

    def provoke():
        publisher.publish(Float64())
        if client.service_is_ready():
            client.call_async(Trigger.Request())

    node.create_timer(POLL, provoke, clock=STEADY)
    spin_until(executor, node, lambda: other.fault)
    assert str(other.fault) == 'on purpose'
    assert node.fault is None
    for _ in range(5):  # it is called no more
        spin_for(executor, [node])
    assert ticks == [kind]


def test_data_that_are_no_message_are_counted(executor, node):
    heard = []
    node.create_subscription(Float64, 'in', heard.append, 10)
    publisher = node.create_publisher(Float64, 'in', 10)
    spin_until(executor, node, publisher.get_subscription_count)
    publisher.publish(b'\0\1\0\0' + b'\1\2')
    publisher.publish(Float64(data=0.25))
    spin_until(executor, node, lambda: heard)
    assert [message.data for message in heard] == [0.25]
    assert node.undecodable.count == 1
    assert 'in: it is no message of type Float64' in node.undecodable.why


def test_a_node_of_ours_takes_what_a_node_of_rclpy_takes(executor):
    lower = Parameter('altitude', value=0.75)
    made = Navigator(namespace='/lta7', parameter_overrides=[lower])
    try:
        assert made.get_fully_qualified_name() == '/lta7/navigator'
        assert made.get_parameter('altitude').value == 0.75
    finally:
        made.destroy_node()
