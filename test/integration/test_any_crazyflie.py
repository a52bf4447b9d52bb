"""
What firmware 2026.08 does when we fail (docs/hardware.md), judged by its log packets alone.

On the emulated Crazyflie, or on the one that `LTA_CF_URI` names: the outcomes are the same. Times
are the drone's own. What locks it comes last.
"""

import itertools

from lta_bridge.crazyflie import duties_packet
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.crazyflie.supervisor import Bit
from lta_config.topics import topic_table
from lta_graph.ros.message_types import message_type
import numpy as np
import pytest
from std_srvs.srv import SetBool

from .any_crazyflie import connected, served
from .peer import Peer, start

pytestmark = pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning')

STALE = 0.5  # s by which the emulated drone's clock and a busy machine may be late
HEIGHT = 0.45  # m
TABLE = topic_table()


@pytest.fixture
def uri():
    with served() as uri:
        yield uri


@pytest.fixture
def drone(uri):
    with connected(uri) as drone:
        yield drone


def test_every_log_block_comes_at_its_rate(drone):
    drone.until(lambda: all(len(drone.heard.get(block.name, ())) > 20 for block in BLOCKS))
    for block in BLOCKS:
        stamps = [packet.stamp_ms for packet in drone.heard[block.name]]
        assert np.median(np.diff(stamps)) == pytest.approx(block.period_ms, abs=1)


def test_unarmed_no_setpoint_turns_a_motor(drone):
    if Bit.AUTO_ARM in drone.word:
        pytest.skip('this firmware arms itself')
    before = drone.now
    drone.wait(1.0, drone.hover)
    assert not drone.turned(before)


def test_disarmed_in_flight_it_stops_at_once_and_can_be_armed_again(drone):
    drone.fly()
    before = drone.now
    drone.until(lambda: not drone.turns, lambda: drone.link.arm(False))
    assert drone.now - before < 0.2 + STALE
    drone.until(lambda: Bit.CAN_BE_ARMED in drone.word)


def test_handed_over_it_lands_and_does_not_lock(drone):
    drone.fly()
    drone.link.hand_over(land=True)
    drone.until(lambda: not drone.turns)
    drone.until(lambda: Bit.FLYING not in drone.word)
    assert Bit.LOCKED not in drone.word


def test_duties_hold_for_as_long_as_their_packet_says(drone):
    if drone.link.parameter('lta.app') is None:
        pytest.skip('this firmware has no app: flash firmware/crazyflie')
    drone.arm()
    numbers = itertools.count(1)

    def send():
        drone.link.duties(duties_packet.packed(next(numbers), (0.1, 0.1, 0.1, 0.1), 200))

    drone.until(lambda: drone.turns, send)
    before = drone.now
    drone.until(lambda: not drone.turns)
    assert drone.now - before < 0.25 + STALE
    assert Bit.LOCKED not in drone.word


@pytest.mark.long
def test_the_bridge_flies_it_by_setpoints_and_brings_it_down_unlocked(uri, domain_id, hear):
    """Through the node and its services; judged by what the node heard of the drone."""
    node = start(
        'lta_bridge.nodes.crazyflie_bridge', '-p', f'uri:={uri}', '-p', 'vehicle:=multirotor'
    )

    def safety(facts, word, turning):
        fact = facts.get('crazyflie_bridge: safety')
        motors = '' if fact is None else fact.values['motors']
        turns = any(float(duty) > 0.0 for duty in motors.split())
        return fact is not None and fact.message.startswith(word) and motors and turns == turning

    with Peer(domain_id) as peer:
        wanted = {n: peer.publisher(n) for n in ('odom', 'setpoint/pose', 'setpoint/velocity')}

        def send():
            stamp = peer.node.get_clock().now().to_msg()
            for name, publisher in wanted.items():
                message = message_type(TABLE[name])()
                message.header.stamp = stamp
                if name == 'setpoint/pose':
                    message.pose.position.z = HEIGHT
                publisher.publish(message)

        hear(lambda facts: safety(facts, 'disarmed', turning=False))
        peer.arm()
        hear(lambda facts: send() or safety(facts, 'flying', turning=True))
        hear(lambda facts: safety(facts, 'disarmed: the newest command', turning=False))
        refused = peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)
        assert refused.success
        node.send_signal(2)
        _, text = node.communicate(timeout=30)
        assert node.returncode == 0, text
    with connected(uri) as drone:
        assert Bit.LOCKED not in drone.word


def test_an_emergency_stop_cuts_and_locks(drone):
    drone.fly()
    before = drone.now
    drone.link.stop()
    drone.until(lambda: Bit.LOCKED in drone.word and not drone.turns)
    assert drone.now - before < 0.2 + STALE
    refuses(drone)


def test_the_watchdog_locks_a_second_after_its_last_word(drone):
    drone.fly()
    drone.link.watchdog()
    before = drone.now
    drone.until(lambda: Bit.LOCKED in drone.word and not drone.turns, drone.hover)
    assert drone.now - before == pytest.approx(1.0, abs=0.2 + STALE)


def test_two_seconds_of_silence_lock(drone):
    drone.fly()
    before = drone.now
    drone.until(lambda: Bit.LOCKED in drone.word and not drone.turns)
    assert drone.now - before == pytest.approx(2.0, abs=0.2 + STALE)
    refuses(drone)


def refuses(drone):
    """Nothing turns any more, and nobody arms it."""
    before = drone.now
    drone.link.arm(True)
    drone.wait(0.5, drone.hover)
    assert Bit.ARMED not in drone.word
    assert not drone.turned(before)
