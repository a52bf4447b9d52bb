# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The teleop node: a person steers by gamepad, keyboard or Joy messages, or a program by cmd_vel.

It never arms. While the operator has control, it publishes this and their setpoints; controller
and bridge follow these instead of the navigator's, with all their safety checks.
"""

from pathlib import Path
import sys
import time
from typing import Unpack

from geometry_msgs.msg import TwistStamped
from lta_bridge.parameters import TeleopSettings
from lta_bridge.teleop.messages import (
    JoyDevice,
    SetpointFollowers,
    to_heading_altitude,
    TwistDevice,
)
from lta_bridge.teleop.steering import (
    check_time_mode,
    describe_steering,
    step_state,
    TeleopState,
)
from lta_bridge.teleop.sticks import (
    CMD_VEL,
    Gamepad,
    HELP,
    JOY,
    KEYBOARD,
    Keyboard,
    StickDevice,
)
from lta_control.messages import from_setpoint
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from nav_msgs.msg import Odometry
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

TELEOP_PERIOD = 0.02  # s
TAPS = 50  # queue depth of Joy messages: the newest alone would hide a short press of a button
ESTIMATE_LIFE = 0.3  # s; an older estimate is not used
STOPPING = ('emergency_stop', 'crazyflie_bridge/emergency_stop')  # services that can stop motors


class Teleop(GraphNode):
    """Publish the operator's setpoints."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('teleop', **options)
        check_time_mode(lockstep=self.lockstep)
        self._held = self.create_output('teleop/held')
        self._pose = self.create_output('teleop/pose')
        self._velocity = self.create_output('teleop/velocity')
        self._settings = NodeParameters(self, TeleopSettings)
        self._stops = {name: self.create_client(Trigger, name) for name in STOPPING}
        self._answered: set[str] = set()
        self._flyers = SetpointFollowers(self.get_namespace())
        self._odom: Odometry | None = None
        self._odom_at = -ESTIMATE_LIFE
        # Sticks are read on the wall clock: a person acts in real time
        self._state, self._ticked = TeleopState(), time.monotonic()
        self.subscribe_topic('odom', self._on_odom)
        self.subscribe_topic('/diagnostics', self._flyers.add_diagnostics)
        self._device = self._create_device(self._settings.value)
        self.create_timer(TELEOP_PERIOD, self._tick, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _create_device(self, settings: TeleopSettings) -> StickDevice:
        if settings.device == KEYBOARD:
            keyboard = Keyboard()
            sys.stdout.write(HELP)
            sys.stdout.flush()
            return keyboard
        if settings.device == JOY:
            joy = JoyDevice(settings.layout)
            # One count of all that this node hears
            self.soundness.unsound = self.undecodable = joy.unsound
            self.create_subscription(
                Joy, 'joy', lambda message: joy.receive(message, time.monotonic()), TAPS
            )
            return joy
        if settings.device == CMD_VEL:
            frames = '', 'base_link', f'{self.frame_prefix}base_link'
            twist = TwistDevice(lambda: self._settings.value.rates, frames)
            self.soundness.unsound = self.undecodable = twist.unsound
            self.create_subscription(
                TwistStamped,
                CMD_VEL,
                lambda message: twist.receive(message, time.monotonic(), self.graph_time_ns()),
                1,
            )
            return twist
        return Gamepad(Path(settings.device), settings.layout)

    def _on_odom(self, odom: Odometry) -> None:
        self._odom, self._odom_at = odom, time.monotonic()

    def _tick(self) -> None:
        now = time.monotonic()
        # A long pause must not become one large step of the setpoint
        dt, self._ticked = min(now - self._ticked, ESTIMATE_LIFE), now
        sticks, rates = self._device.read_sticks(now), self._settings.value.rates
        odom = self._odom if now - self._odom_at <= ESTIMATE_LIFE else None
        felt = None if odom is None else to_heading_altitude(odom)
        before, follows = self._state.stage, self._flyers.is_operator_steering
        self._state, order = step_state(self._state, now, dt, sticks, felt, rates, follows)
        if order.setpoint is not None and self._odom is not None:
            # A setpoint answers the newest estimate: its age is counted from that one's stamp.
            pose, velocity = from_setpoint(self._odom.header.stamp, order.setpoint)
            self._pose.publish(pose)
            self._velocity.publish(velocity)
        if order.held is not None:
            self._held.publish(Bool(data=order.held))
        if order.stop:
            self._request_stop()
        if self._state.stage is not before:
            self.get_logger().info(f'control of the drone: {self._state.stage.value}')
        stage, alive, placed = self._state.stage, sticks is not None, felt is not None
        self.health.set_fact(describe_steering(stage, alive, placed, self._answered))

    def _request_stop(self) -> None:
        """Call the emergency-stop services that are available."""
        for name, client in self._stops.items():
            if client.service_is_ready():
                answer = client.call_async(Trigger.Request())
                answer.add_done_callback(lambda _, name=name: self._answered.add(name))

    def close(self) -> None:
        """Close the device; control is not handed back, so a drone under control lands."""
        self._device.close()
        super().close()


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(Teleop, args)
