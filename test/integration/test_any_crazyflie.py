# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What firmware 2026.08 does when we fail (docs/hardware.md), judged by its log packets alone.

On the emulated Crazyflie in three builds, or on the one that `LTA_CF_URI` names: the outcomes are
the same. Times are the drone's own. What locks it comes last.
"""

import itertools
import os
from random import random

from lta_bridge.crazyflie import duties_packet
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import REQUIRED
from lta_config.topics import load_topic_table
from lta_control.messages import from_duties
from lta_emulation.crazyflie.parameters import APP, ARMING, AS_SOLD
from lta_graph.ros.message_validation import find_message_type
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from std_srvs.srv import SetBool

from .any_crazyflie import connected, OUT_OF_TREE, PATIENCE, PID, served
from .peer import Peer, start

pytestmark = pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning')

STALE = 0.5  # s by which the emulated drone's clock and a busy machine may be late
HEIGHT = 0.45  # m
TABLE = load_topic_table()
BUILDS = {'as sold': AS_SOLD, 'arming': ARMING, 'app': APP}


@pytest.fixture(
    params=[
        pytest.param('as sold', marks=pytest.mark.long),
        pytest.param('arming', marks=pytest.mark.long),
        'app',
    ]
)
def uri(request):
    if os.environ.get('LTA_CF_URI') and request.param != 'app':
        pytest.skip('the one that LTA_CF_URI names has one build')
    with served(BUILDS[request.param]) as uri:
        yield uri


@pytest.fixture
def drone(uri):
    with connected(uri) as drone:
        yield drone


def test_every_log_block_comes_at_its_rate(drone):
    drone.until(lambda: all(len(drone.heard.get(block.name, ())) > 10 for block in LOG_BLOCKS))
    for block in LOG_BLOCKS:
        stamps = [packet.stamp_ms for packet in drone.heard[block.name]]
        assert np.median(np.diff(stamps)) == pytest.approx(block.period_ms, abs=1)


def test_unarmed_no_setpoint_turns_a_motor(drone):
    if drone.arms_itself:
        pytest.skip('this firmware arms itself')
    drone.control_by(PID)
    before = drone.now
    drone.wait(1.0, drone.hover)
    assert not drone.turned(before)


def test_disarmed_in_flight_it_stops_at_once_and_can_be_armed_again(drone):
    if drone.arms_itself:
        pytest.skip('this firmware arms itself again')
    drone.fly()
    before = drone.now
    drone.until(lambda: not drone.turns, lambda: drone.link.request_arming(False))
    assert drone.now - before < 0.2 + STALE
    drone.until(lambda: SupervisorBit.CAN_BE_ARMED in drone.word)


def test_handed_over_it_lands_and_does_not_lock(drone):
    drone.fly()
    drone.link.hand_over(land=True)
    drone.until(lambda: not drone.turns)
    drone.until(lambda: SupervisorBit.FLYING not in drone.word)
    assert SupervisorBit.LOCKED not in drone.word


def test_duties_hold_for_as_long_as_their_packet_says(drone):
    if not drone.has_app:
        pytest.skip('this firmware has no app: flash firmware/crazyflie')
    drone.control_by(OUT_OF_TREE)
    drone.arm()
    numbers = itertools.count(1)

    def send():
        drone.link.send_duties(duties_packet.pack_duties(next(numbers), (0.1, 0.1, 0.1, 0.1), 200))

    drone.until(lambda: drone.turns, send)
    before = drone.now
    drone.until(lambda: not drone.turns)
    assert drone.now - before < 0.25 + STALE
    drone.until(lambda: SupervisorBit.ARMED not in drone.word)
    assert drone.now - before < 0.2 + 1.0 + 0.15 + STALE
    assert SupervisorBit.LOCKED not in drone.word


def test_no_motor_turns_once_the_bridge_has_set_what_every_drone_must_have(drone):
    """Where arming is required, Kconfig's idle thrust turns all motors as soon as it is armed."""
    for name, wanted in REQUIRED.items():
        drone.link.write_parameter(name, wanted.value, PATIENCE)
    drone.arm()
    before = drone.now
    drone.wait(1.0)
    assert not drone.turned(before)


@pytest.mark.long
def test_the_bridge_flies_it_and_brings_it_down_unlocked(uri, domain_id, hear):
    """By duties where the app is aboard, by setpoints elsewhere; through the node's services."""
    with connected(uri) as drone:
        by_duties = drone.has_app
    vehicle = load_vehicle('gtmab' if by_duties else 'multirotor')
    # With a watchdog it would be locked once the node has gone
    words = ('uri:=' + uri, f'vehicle:={vehicle.file.name}', 'blind:=true', 'watchdog:=never',
             'allow_other_commanders:=true')  # fmt: skip
    words = tuple(part for word in words for part in ('-p', word))
    node = start('lta_bridge.nodes.crazyflie_bridge', *words)

    def safety(facts, word, turning):
        fact = facts.get('crazyflie_bridge: safety')
        motors = '' if fact is None else fact.values['motors']
        turns = any(float(duty) > 0.0 for duty in motors.split())
        return fact is not None and fact.message.startswith(word) and motors and turns == turning

    with Peer(domain_id) as peer:
        commands = ('motors',) if by_duties else ('setpoint/pose', 'setpoint/velocity')
        publishers = {name: peer.publisher(name) for name in ('odom', *commands)}

        def send():
            stamp = peer.node.get_clock().now().to_msg()
            for name, publisher in publishers.items():
                message = find_message_type(TABLE[name])()
                message.header.stamp = stamp
                if name == 'odom':
                    message.pose.pose.position.z = random()  # no height repeats to the bit
                elif name == 'setpoint/pose':
                    message.pose.position.z = HEIGHT
                elif name == 'motors':
                    names = vehicle.rotor_names
                    message = from_duties(stamp, names, (0.1,) * len(names))
                publisher.publish(message)

        hear(lambda facts: safety(facts, 'disarmed', turning=False))
        peer.arm()
        hear(lambda facts: send() or safety(facts, 'flying', turning=True))
        hear(lambda facts: safety(facts, 'disarmed: the newest command', turning=False))
        assert peer.ask(SetBool, 'crazyflie_bridge/arm', data=False).success
        node.send_signal(2)
        _, text = node.communicate(timeout=PATIENCE)
        assert node.returncode == 0, text
    with connected(uri) as drone:
        assert SupervisorBit.LOCKED not in drone.word


def test_an_emergency_stop_cuts_and_locks(drone):
    drone.fly()
    before = drone.now
    drone.link.send_emergency_stop()
    drone.until(lambda: SupervisorBit.LOCKED in drone.word and not drone.turns)
    assert drone.now - before < 0.2 + STALE
    refuses(drone)


def test_the_watchdog_locks_a_second_after_its_last_word(drone):
    drone.fly()
    drone.link.feed_watchdog()
    before = drone.now
    drone.until(lambda: SupervisorBit.LOCKED in drone.word and not drone.turns, drone.hover)
    assert drone.now - before == pytest.approx(1.0, abs=0.2 + STALE)


def test_two_seconds_of_silence_lock(drone):
    drone.fly()
    before = drone.now
    drone.until(lambda: SupervisorBit.LOCKED in drone.word and not drone.turns)
    assert drone.now - before == pytest.approx(2.0, abs=0.2 + STALE)
    refuses(drone)


def refuses(drone):
    """Nothing turns any more, and nobody arms it."""
    before = drone.now
    drone.link.request_arming(True)
    drone.wait(0.5, drone.hover)
    assert SupervisorBit.ARMED not in drone.word
    assert not drone.turned(before)
