# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Other people's nodes in plain rclpy: alone with the simulator, and in place of ours."""

import json
from pathlib import Path

from lta_control.messages import from_duties
from lta_flight.flight_run import EXIT_STATUSES
from lta_graph.ros.listener import DiagnosticsListener
from lta_graph.ros.message_validation import find_message_type
import pytest
from sensor_msgs.msg import Imu
from waiting import wait_until

from .command import ROOT
from .peer import Peer, TABLE

ROTORS = ['up_left', 'up_right', 'forward_left', 'forward_right']
EXAMPLES = ROOT / 'examples'


def test_the_simulator_flies_alone_by_anybodys_motors_and_sinks_without(lta, domain_id):
    """A command counts for 0.3 s; a drone that is 2 g heavy then sinks."""
    words = ('--ros-args', '-r', '__ns:=/lta1')
    simulator = lta.start('run', 'lta_sim', 'simulator', *words)
    with Peer(domain_id) as peer:
        motors = peer.node.create_publisher(find_message_type(TABLE['motors']), 'motors', 10)

        is_commanded = True

        def climb(message: Imu) -> None:
            if is_commanded:
                motors.publish(from_duties(message.header.stamp, ROTORS, (0.6, 0.6, 0.0, 0.0)))

        heights: list[float] = []
        peer.hear('imu', climb)
        peer.hear('ground_truth/odom', lambda m: heights.append(m.pose.pose.position.z))
        peer.until(lambda: len(heights) > 300)  # three seconds
        assert max(heights) > heights[0] + 0.2
        is_commanded = False
        peer.until(lambda: heights[-1] < max(heights) - 0.1)
    simulator.interrupt()
    simulator.end()


def fly(lta, out: Path, *words: str) -> tuple[set[str], str]:
    """Return the facts that the nodes had reported by the first step, and the outcome."""
    launch = lta.start('launch', 'fly', f'bag:={out}', *words)
    # A listener of its own, which has heard of no other flight
    with DiagnosticsListener() as listener:

        def has_begun() -> bool:
            fact = listener.facts.get('simulator: flight')
            return fact is not None and float(fact.values['time_s']) > 0.0

        wait_until(has_begun, 'flight', lambda: launch.text, step=lambda: listener.poll(0.02))
        facts = set(listener.facts)
    status = launch.end()
    (line,) = [line for _, line in launch.lines if '"outcome"' in line]
    outcome = json.loads(line.partition(' ')[2])['outcome']
    assert status == EXIT_STATUSES[outcome], launch.text
    return facts, outcome


def own(lta, name: str, *words: str):
    return lta.start('run', EXAMPLES / f'own_{name}.py', '--ros-args', '-r', '__ns:=/lta1', *words)


@pytest.mark.long
@pytest.mark.parametrize('mode', ['lockstep', 'realtime'])
@pytest.mark.parametrize('name', ['navigator', 'controller'])
def test_a_node_in_plain_rclpy_reaches_the_lamp(lta, tmp_path, name, mode):
    node = own(lta, name, '-p', f'lockstep:={str(mode == "lockstep").lower()}')
    words = (f'{name}:=false', f'time:={mode}', 'strategy:=bag')
    _, outcome = fly(lta, tmp_path / 'bag', *words)
    assert outcome == 'reached'
    assert node.end() == 0  # by itself


@pytest.mark.long
def test_the_start_does_not_wait_for_the_report_of_a_foreign_node(lta, scenario, tmp_path):
    """Had it waited, the simulator would have given up in the end and warned of it."""
    own(lta, 'controller')
    room = f'scenario:={scenario(time_limit="1 s")}'
    facts, _ = fly(lta, tmp_path / 'foreign', room, 'controller:=false')
    assert 'simulator: flight' in facts
    assert 'simulator: start' not in facts
