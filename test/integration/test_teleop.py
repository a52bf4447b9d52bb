# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A person takes over from the navigator, hands back, dies, and stops: over the controller."""

from random import random

from geometry_msgs.msg import TwistStamped
from lta_bridge.teleop.sticks import GamepadLayout
from lta_control.messages import from_setpoint
from lta_control.motion import Setpoint
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Joy

from .peer import Peer, running

LAYOUT = GamepadLayout()


class Cockpit:
    """A drone at rest, a navigator that wants it to stay, and a gamepad or a program."""

    def __init__(self, peer, device='joy', kind=Joy):
        self.peer, self.duties = peer, []
        self.axes, self.buttons = [0.0] * 6, [0] * 4
        peer.hear('motors', lambda motors: self.duties.append(max(map(abs, motors.duty))))
        peer.hear_facts()
        self.command = lambda: Joy(axes=self.axes, buttons=self.buttons)
        self._device = peer.offering(device, kind, 1)
        self._odom = peer.publisher('odom')
        self._pose, self._velocity = (
            peer.publisher('setpoint/pose'),
            peer.publisher('setpoint/velocity'),
        )
        peer.node.create_timer(0.02, self._go_on)

    def _go_on(self):
        now = self.peer.node.get_clock().now().to_msg()
        odom = Odometry()
        odom.header.stamp = now
        # No height repeats to the bit
        odom.pose.pose.position.z, odom.pose.pose.orientation.w = 1.5 + 1e-6 * random(), 1.0
        self._odom.publish(odom)
        pose, velocity = from_setpoint(now, Setpoint(1.5, 0.0, 0.0))
        self._pose.publish(pose)
        self._velocity.publish(velocity)
        if (command := self.command()) is not None:
            self._device.publish(command)

    def press(self, button):
        self.buttons = [0] * 4
        if button is not None:
            self.buttons[button] = 1

    def until_motors(self, text):
        self.peer.until(lambda: text in self.peer.told('controller: motors'))

    def until_helm(self, text):
        self.peer.until(lambda: text in self.peer.told('teleop: helm'))


def test_a_stick_wins_until_handed_back_a_dead_teleop_lands_and_the_button_stops(domain_id):
    with (
        running('lta_control.nodes.controller', '-p', 'armed:=true') as controller,
        running('lta_bridge.nodes.teleop') as teleop,
        Peer(domain_id) as peer,
    ):
        cockpit = Cockpit(peer)
        cockpit.until_helm('the navigator steers')
        cockpit.until_motors('flying by the setpoint')
        still = cockpit.duties[-1]
        cockpit.axes[LAYOUT.forward] = 1.0
        cockpit.until_motors('flying by a person')
        peer.until(lambda: cockpit.duties[-1] > still + 0.02)
        # At rest the person still has control.
        cockpit.axes[LAYOUT.forward] = 0.0
        cockpit.press(LAYOUT.give_back)
        cockpit.until_motors('flying by the setpoint')
        cockpit.press(LAYOUT.take)
        cockpit.until_motors('flying by a person')
        cockpit.press(None)
        teleop.kill()
        teleop.wait()
        # The navigator goes on talking, and is not listened to.
        cockpit.until_motors('holding')
        cockpit.until_motors('landing')
        peer.facts.pop('teleop: helm')
        with running('lta_bridge.nodes.teleop') as again:  # it learns from who flies by its word
            cockpit.until_helm('the operator steers')
            cockpit.until_motors('flying by a person')
            stop_for_good(cockpit)
            assert (again.poll(), controller.poll()) == (None, None)


def test_a_program_flies_by_cmd_vel_and_its_silence_lands_the_drone(domain_id):
    with (
        running('lta_control.nodes.controller', '-p', 'armed:=true'),
        running('lta_bridge.nodes.teleop', '-p', 'device:=cmd_vel'),
        Peer(domain_id) as peer,
    ):
        cockpit = Cockpit(peer, 'cmd_vel', TwistStamped)
        cockpit.command = lambda: None
        cockpit.until_motors('flying by the setpoint')
        still = cockpit.duties[-1]
        ahead = TwistStamped()
        ahead.twist.linear.x = 0.3
        cockpit.command = lambda: ahead
        cockpit.until_motors('flying by a person')
        peer.until(lambda: cockpit.duties[-1] > still + 0.02)
        cockpit.command = lambda: None
        # The navigator goes on talking, and is not listened to
        cockpit.until_motors('holding')
        cockpit.until_motors('landing')


def stop_for_good(cockpit):
    """Press the stop button in a climb, and check that the motors stay off."""
    cockpit.axes[LAYOUT.climb] = 1.0
    cockpit.peer.until(lambda: cockpit.duties[-1] > 0.0)
    cockpit.press(LAYOUT.stop)
    cockpit.until_motors('emergency stop')
    cockpit.until_helm('confirmed by emergency_stop')
    seen = len(cockpit.duties)
    cockpit.peer.until(lambda: len(cockpit.duties) > seen + 20)
    assert set(cockpit.duties[seen + 2 :]) == {0.0}
