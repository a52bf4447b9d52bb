# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One simulator of two drones: a step needs the answers of both, and each is told apart."""

from lta_graph.health import HealthLevel
from lta_sim.nodes.simulator import Simulator
import pytest
import rclpy
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message

from .good_messages import good
from .peer import TABLE

START, STEP = TABLE.start_ns, TABLE.control_ns


@pytest.fixture
def said(monkeypatch):
    """Return the messages that are published, by topic."""
    messages = {}

    def publish(publisher, message):
        messages.setdefault(publisher.topic_name, []).append(message)

    monkeypatch.setattr(Publisher, 'publish', publish)
    return messages


@pytest.fixture
def simulator(said, domain_id):
    words = ['robots:=a b', 'b.seed:=2', 'b.offset_y:=1.0', 'time:=lockstep']
    given = [word for each in words for word in ('-p', each)]
    rclpy.init(args=['node', '--ros-args', *given], domain_id=domain_id)
    node = Simulator()
    yield node
    node.close()
    node.destroy_node()
    rclpy.try_shutdown()


def answer(simulator, robot, change=lambda message: message):
    """Let the simulator hear the command of a drone for the present step."""
    (inlet,) = [each for each in simulator.subscriptions if each.topic_name == f'/{robot}/motors']
    message = change(good('motors', simulator.graph_time_ns()))
    inlet.callback(serialize_message(message))
    assert simulator.fault is None


def test_a_step_is_flown_when_both_have_answered(simulator, said):
    assert simulator.graph_time_ns() == START
    answer(simulator, 'a')
    assert simulator.graph_time_ns() == START
    assert simulator.list_missing_inputs() == ['b/motors']
    answer(simulator, 'b')
    assert simulator.graph_time_ns() == START + STEP
    assert sorted(simulator.list_missing_inputs()) == ['a/motors', 'b/motors']
    headers = [said[f'/{robot}/imu'][-1].header for robot in 'ab']
    assert [each.frame_id for each in headers] == ['a/imu_link', 'b/imu_link']
    assert {each.stamp.nanosec for each in headers} == {STEP}
    starts = said['/tf_static'][0].transforms
    assert [each.child_frame_id for each in starts] == ['a/odom', 'b/odom']
    first, second = (each.transform.translation.y for each in starts)
    assert second - first == pytest.approx(1.0)


def test_a_wrong_command_is_the_fault_of_its_drone_alone(simulator, said):
    def spoil(message):
        message.duty[0] = 2.0
        return message

    answer(simulator, 'a')
    answer(simulator, 'b', spoil)
    assert any(simulator.drones['a/'].duties)
    assert not any(simulator.drones['b/'].duties)
    simulator.publish_health()
    levels = {
        (each.hardware_id, each.name): each.level for each in said['/diagnostics'][-1].status
    }
    assert levels['b', 'b/simulator: command'] == bytes([HealthLevel.ERROR])
    assert ('a', 'a/simulator: command') not in levels
