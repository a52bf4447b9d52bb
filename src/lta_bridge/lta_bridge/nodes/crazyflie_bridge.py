# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The Crazyflie bridge node: it takes the simulator's place with a real drone.

It is a lifecycle node: `configure` opens the link, `activate` accepts commands, `deactivate` lands
and disarms. Only the service `crazyflie_bridge/arm` arms. `lta_bridge.crazyflie.safety` decides
when motors may turn; this node converts and publishes.
"""

import os
import threading
import time
from typing import Unpack

from lta_bridge.crazyflie.bridge_core import TICK_RATE
from lta_bridge.crazyflie.drone_operation import DroneOperation
from lta_bridge.crazyflie.messages import (
    CommandReader,
    CrazyfliePowerModel,
    from_reading,
    to_duties_command,
)
from lta_bridge.parameters import CrazyflieBridgeSettings
from lta_config.errors import BadInput
from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.reach import describe_reach
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.device import DeviceNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp
from lta_graph.ros.startup import ReaderLinks
from lta_model.vehicle import load_vehicle
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from std_srvs.srv import SetBool, Trigger

HEARING = 5.0  # s to wait for all readers before arming; a user's own node may never match


class CrazyflieBridge(DeviceNode):
    """Publish the sensor data of a Crazyflie, and send it the graph's commands."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('crazyflie_bridge', 'Crazyflie', **options)
        self.health.set_fact(describe_reach(os.environ))
        names = ('imu', 'range', 'pressure', 'battery')
        self._outputs = {name: self.create_output(name) for name in names}
        settings = NodeParameters(self, CrazyflieBridgeSettings).value
        vehicle = load_vehicle(settings.vehicle)
        self._names = vehicle.rotor_names
        self._consumption = CrazyfliePowerModel.from_energy(vehicle.file.energy)
        self._drone = DroneOperation(
            settings,
            vehicle,
            self.graph_time_ns,
            lambda: self.active,
            self._tick,
            self._serve_emergency_stop,
        )
        self._bridge = self._drone.bridge
        self.autostart = settings.autostart
        self._controller = self.create_client(SetBool, 'arm')
        self._armed_controller = False
        self.create_service(SetBool, '~/arm', self._on_arm)
        self._stop = self.create_service(Trigger, '~/emergency_stop', self._on_emergency_stop)
        self.subscribe_inputs(
            ['motors', 'energy/reserve'], trigger='motors', on_step=self._on_motors
        )
        self._commands = CommandReader(self, self._bridge, settings.allow_other_commanders)
        self._links = ReaderLinks(self)
        # Ticks follow the wall clock, even if graph time stops.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(1.0 / TICK_RATE, self._tick, clock=steady)
        # Own thread: sensor data continue while a service callback blocks the executor
        threading.Thread(target=self._publish_readings, name='crazyflie_pump', daemon=True).start()

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the link, and keep it open."""
        try:
            self._drone.open()
        except BadInput as error:
            self.refusal = str(error)
            self.get_logger().error(self.refusal)
            return TransitionCallbackReturn.FAILURE
        return super().on_configure(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Land if it flies, and disarm."""
        self._land()
        return super().on_deactivate(state)

    def release_device(self) -> None:
        """Land, disarm, and close the link, in this order."""
        self._land()
        self._drone.close()

    def _land(self) -> None:
        self.active = False
        if self._drone.land():  # let a recorder receive the reason before this node shuts down
            self.update_health()
            self.publish_health()

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Arm or disarm, and answer with the confirmed state."""
        self._commands.find_rivals()
        response.success, response.message = self._drone.arm(request.data, self._wait_for_links)
        return response

    def _wait_for_links(self) -> None:
        """Wait until all topics have their readers, so that no message of a flight is lost."""
        until = time.monotonic() + HEARING
        while (
            short := self._links.find_unmatched_topics(self.count_readers())
        ) and time.monotonic() < until:
            self._drone.wait_for_tick()
        if short:
            text = (
                f'armed before all subscribers of {", ".join(short)} were found; the first '
                'messages may be lost'
            )
            self.health.report('start', HealthLevel.WARN, text)

    def _on_emergency_stop(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        response.success, response.message = True, self._drone.stop()
        return response

    def _serve_emergency_stop(self) -> None:
        """Serve an emergency stop within another callback."""
        with self._stop.handle:
            request, header = self._stop.handle.service_take_request(Trigger.Request)
        if header is not None:
            answer = self._on_emergency_stop(request, Trigger.Response())
            self._stop.send_response(answer, header)

    def _on_motors(self, step: InboxStep) -> None:
        if self._bridge.sends_duties:
            newest = step.messages['motors'][-1]
            stamp = from_stamp(newest.header.stamp)
            self._bridge.accept_command(to_duties_command(newest, self._names, stamp))

    def _tick(self) -> None:
        self._bridge.wanted_height = self._commands.find_target_height()
        if self._drone.tick():
            self.update_health()  # a landing may be over before the next look
        arm = self._drone.needs_controller
        if arm != self._armed_controller and self._controller.service_is_ready():
            self._controller.call_async(SetBool.Request(data=arm))
            self._armed_controller = arm

    def _publish_readings(self) -> None:
        """Publish the readings of the drone as they arrive."""
        while True:
            reading = self._drone.wait_for_reading()
            if reading is not None:
                messages = from_reading(reading, self._bridge, self._consumption)
                for name, message in messages.items():
                    self._outputs[name].publish(message)

    def update_health(self) -> None:
        """Report the health of the link and the drone."""
        for fact in self._drone.describe():
            self.health.set_fact(fact)

    def publish_health(self) -> None:
        """Look for rivals, and report."""
        self._commands.find_rivals()
        super().publish_health()


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(CrazyflieBridge, args)
