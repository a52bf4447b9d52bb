# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Controller node: convert estimate and setpoint to duties.

`lta_control.flight_step` has the rules of a flight, with all that keeps the motors off; the node
converts messages to its inputs, and its duties to a message. It lands the drone while two nodes
steer it, and while the airspeed that it had is missing.
"""

import math
from typing import Unpack

from geometry_msgs.msg import TwistWithCovarianceStamped
from lta_control import flight_report
from lta_control.allocation import create_working_array
from lta_control.flight_step import (
    control_motors,
    FlightRules,
    FlightState,
    is_stopped,
    PilotMemory,
)
from lta_control.laws import load_onboard_law
from lta_control.laws.cascade import CascadeGains
from lta_control.messages import from_duties, to_control_inputs
from lta_control.motion import step_duration
from lta_control.parameters import ControllerSettings
from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.ros.command_mux import CommandMux
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp
from lta_model.scenario import load_course
from lta_model.vehicle import load_vehicle
from std_srvs.srv import SetBool, Trigger

AIRSPEED_AGE_NS = 250_000_000  # ns; an airspeed further from the odometry is not used


class Controller(GraphNode):
    """Publish duties for each estimate."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('controller', **options)
        self._motors = self.create_output('motors')
        settings = NodeParameters(self, ControllerSettings, self._apply_settings).value
        vehicle = load_vehicle(settings.vehicle)
        self._names, self._reversible = vehicle.rotor_names, vehicle.reversible
        self._standing_height, self._scratch = vehicle.hull_height_on_floor, create_working_array()
        self._course = load_course(settings.scenario)
        self._law, self._constants = load_onboard_law(settings.law, vehicle, settings.gains)
        self._memory = PilotMemory(law=self._law.start)
        self._apply_settings(settings)
        self._armed = settings.armed
        self._contested = False  # whether two nodes have sent setpoints since arming
        self._airspeed_lost = False
        self._begun_ns: int | None = None
        self._last_ns: int | None = None
        self.create_service(SetBool, 'arm', self._on_arm)
        self.create_service(Trigger, 'emergency_stop', self._on_emergency_stop)
        self.subscribe_inputs(
            ['odom', 'airspeed', 'setpoint/pose', 'setpoint/velocity'],
            trigger='odom',
            on_step=self._on_step,
        )
        self._helm = CommandMux(self)

    def _apply_settings(self, settings: ControllerSettings) -> None:
        """Take the limits and gains, which may change in flight."""
        upright, floor = math.cos(settings.tilt_limit), self._standing_height
        self._rules = FlightRules(upright, floor, settings.hold_after, settings.land_after)
        if isinstance(self._constants.gains, CascadeGains):
            self._constants = self._constants._replace(gains=settings.gains)

    def _on_step(self, step: InboxStep) -> None:
        odom, airspeed = step.messages['odom'][-1], self._select_airspeed(step)
        setpoint = self._helm.select_setpoint(
            step.latest['setpoint/pose'], step.latest['setpoint/velocity']
        )
        must_land = self._contested or self._airspeed_lost
        dt = step_duration(self._last_ns, step.stamp_ns, self.table.control_ns)
        inputs = to_control_inputs(
            odom, airspeed, setpoint, self._armed, must_land, step.stamp_ns, dt
        )
        self._memory = control_motors(
            self._law, self._constants, self._rules, self._memory, inputs, self._scratch
        )
        self._last_ns, state = step.stamp_ns, self._memory.watch.state
        self._armed = self._armed and not is_stopped(state)
        steers = 'a person' if self._helm.held else 'the setpoint'
        self.health.set_fact(flight_report.describe_motors(state, inputs, self._rules, steers))
        duties = self._add_test_signals(self._memory.law.command.duties, step.stamp_ns)
        self._motors.publish(from_duties(odom.header.stamp, self._names, duties))

    def _select_airspeed(self, step: InboxStep) -> TwistWithCovarianceStamped | None:
        """Return the airspeed if it belongs to this time, and report where it is missing."""
        latest = step.latest['airspeed']
        near = latest and abs(from_stamp(latest.header.stamp) - step.stamp_ns) <= AIRSPEED_AGE_NS
        # Recordings of earlier versions have none
        lost = latest is not None and not near
        if lost is not self._airspeed_lost:
            self._airspeed_lost = lost
            self.health.set_fact(flight_report.describe_airspeed(lost))
        return latest if near else None

    def _add_test_signals(self, duties: tuple[float, ...], now_ns: int) -> tuple[float, ...]:
        """Return the duties with the test signals of the scenario, but none where all are off."""
        if self._course is None:
            return duties
        self._begun_ns = now_ns if self._begun_ns is None else self._begun_ns
        time = (now_ns - self._begun_ns) * 1e-9
        return self._course.excite_duties(time, duties, self._reversible)

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        count, watch = self._helm.count_commanders(), self._memory.watch
        rivals = f'{count} nodes send setpoints: stop all but one' if count > 1 else ''
        refusal = (flight_report.describe_stop(watch.state) or rivals) if request.data else ''
        response.success, response.message = not refusal, refusal
        if not refusal:
            # Arming starts with empty integrals
            self._memory = PilotMemory(watch._replace(flies=False), self._law.start)
            self._armed, self._contested = request.data, False
            response.message = 'armed' if self._armed else 'disarmed'
        return response

    def _on_emergency_stop(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        watch = self._memory.watch._replace(state=FlightState.EMERGENCY_STOP)
        self._memory, self._armed = PilotMemory(watch, self._law.start), False
        response.success, response.message = True, flight_report.describe_stop(watch.state)
        self.health.report('motors', HealthLevel.ERROR, response.message)
        return response

    def publish_health(self) -> None:
        """Land a drone that two nodes steer, and report."""
        # Until it is armed anew: a motor must not start because one of them ends
        self._contested = self._armed and (self._contested or self._helm.count_commanders() > 1)
        if self._contested or 'commanders' in self.health:
            self.health.set_fact(flight_report.describe_commanders(self._contested))
        super().publish_health()


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Controller, args)
