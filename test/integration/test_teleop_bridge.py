# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A person takes over where the firmware's own controller flies: over the bridge, by setpoints."""

from random import random
import signal

from bench_body import BenchBody
from lta_control.messages import from_setpoint
from lta_control.motion import Setpoint
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.parameters import AS_SOLD
from lta_emulation.crazyflie.server import CrazyflieServer
from nav_msgs.msg import Odometry
import pytest
from std_msgs.msg import Bool
from waiting import PATIENCE

from .peer import Peer, start


class Watched:
    """A bench that remembers what it was asked to do."""

    def __init__(self):
        self._bench, self.hover = BenchBody(), None

    @property
    def duties(self):
        return self._bench.duties

    def advance(self, now, wish):
        self.hover = wish.hover
        self._bench.advance(now, wish)

    def read_log_values(self):
        return self._bench.read_log_values()


@pytest.fixture
def body():
    return Watched()


@pytest.fixture
def drone(body):
    with CrazyflieServer(Firmware(body, build=AS_SOLD)) as server:
        yield server


@pytest.fixture
def bridge(drone):
    words = ('-p', f'uri:={drone.uri}', '-p', 'vehicle:=multirotor', '-p', 'blind:=true',
             '-p', 'allow_other_commanders:=true')  # fmt: skip
    node = start('lta_bridge.nodes.crazyflie_bridge', *words)
    yield node
    if node.poll() is None:
        node.send_signal(signal.SIGINT)
        node.communicate(timeout=PATIENCE)


@pytest.mark.long
def test_a_person_s_word_is_flown_and_their_silence_lands(body, bridge, domain_id):
    with Peer(domain_id) as peer:
        power = []
        peer.hear('battery', power.append)
        peer.until(lambda: power)
        publish = {
            name: peer.publisher(name).publish
            for name in (
                'odom',
                'setpoint/pose',
                'setpoint/velocity',
                'teleop/pose',
                'teleop/velocity',
                'teleop/held',
            )
        }
        person = {'speed': None}

        def say(prefix, speed) -> None:
            stamp = peer.node.get_clock().now().to_msg()
            pose, velocity = from_setpoint(stamp, Setpoint(0.5, 0.0, speed))
            publish[f'{prefix}/pose'](pose)
            publish[f'{prefix}/velocity'](velocity)

        def go_on() -> None:
            odom = Odometry()
            odom.header.stamp = peer.node.get_clock().now().to_msg()
            # No height repeats to the bit
            odom.pose.pose.position.z, odom.pose.pose.orientation.w = 0.45 + 1e-6 * random(), 1.0
            publish['odom'](odom)
            say('setpoint', 0.05)
            if person['speed'] is not None:
                say('teleop', person['speed'])

        peer.node.create_timer(0.02, go_on)
        peer.arm()

        def flown(speed):
            return body.hover is not None and body.hover.forward == pytest.approx(speed, abs=1e-6)

        peer.until(lambda: flown(0.05))
        person['speed'] = 0.2
        publish['teleop/held'](Bool(data=True))
        peer.until(lambda: flown(0.2))
        publish['teleop/held'](Bool(data=False))
        peer.until(lambda: flown(0.05))
        publish['teleop/held'](Bool(data=True))
        peer.until(lambda: flown(0.2))
        # The navigator goes on talking, and is not flown by.
        person['speed'] = None
        peer.until(lambda: body.duties == (0.0,) * 4)
