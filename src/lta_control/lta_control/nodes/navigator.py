# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Navigator node: convert the light estimate to heading, altitude and speed."""

import time
from typing import Unpack

from lta_config.errors import BadInput
from lta_control.actions.messages import serve_tasks
from lta_control.actions.tasks import FlightTask
from lta_control.commanded_flight import check_commanded, CommandedFlight
from lta_control.flight_report import describe_guidance, describe_tracking
from lta_control.guidance import check_reserve, Guidance, GuidanceInputs
from lta_control.messages import from_setpoint, GuidanceReader, to_tracked
from lta_control.motion import Setpoint
from lta_control.parameters import NavigatorParameters
from lta_control.strategies import check_route, find_navigation_strategy
from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.goal_server import GoalServer
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_model.scenario import load_course, load_room_size, load_route
from lta_model.vehicle import load_vehicle
from lta_msgs.msg import ActuatorDuty
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64

SILENCE_LIMIT = 10.0  # wall seconds without a step after which a task ends


class Navigator(GraphNode):
    """Publish setpoints for each light estimate."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('navigator', **options)
        self._pose = self.create_output('setpoint/pose')
        self._velocity = self.create_output('setpoint/velocity')
        self._beacon = self.create_output('light/beacon')
        self._settings = NodeParameters(self, NavigatorParameters)
        settings = self._settings.value
        self._strategy = find_navigation_strategy(settings.strategy)
        course, route = load_course(settings.scenario), load_route(settings.scenario)
        check_route(self._strategy, len(route))
        check_reserve(settings.reserve, self._strategy)
        vehicle = load_vehicle(settings.vehicle)
        scale = vehicle.diodes.gain_scale if self._strategy.ranges else 1.0
        self._reader = GuidanceReader(self.table, scale)
        self.subscribe_inputs(
            [
                'odom',
                'airspeed',
                'light/peaks',
                'light/estimate',
                'energy/status',
                'energy/reserve',
            ],
            trigger='light/estimate',
            on_step=self._on_step,
        )
        self._guidance: Guidance | CommandedFlight = Guidance(course, route)
        self._servers: list[GoalServer[FlightTask]] = []
        self._held = False  # whether a person has control
        self._stepped = time.monotonic()
        if settings.commanded:
            check_commanded(self._strategy, course is not None)
            room = load_room_size(settings.scenario)
            self._guidance = CommandedFlight(settings.limits, vehicle.hull_height_on_floor, room)
            self._serve_tasks(self._guidance)

    def _serve_tasks(self, flight: CommandedFlight) -> None:
        """Offer the actions of a commanded flight, and follow the person who may take over."""
        if not self.lockstep:
            self.subscribe_topic('teleop/held', self._on_takeover)
            self.subscribe_topic('motors', self._on_motors)
            self.subscribe_topic('tracker/odom', self._on_tracked)
        self._servers = serve_tasks(self, flight)

    def _on_step(self, step: InboxStep) -> None:
        settings = self._settings.value
        inputs = self._reader.read_step(step, settings, settings.reserve, self._strategy)
        located = inputs.located
        if located is not None and (located.tracked or 'tracker' in self.health):
            self.health.set_fact(describe_tracking(located.tracked))
        if not self._reader.is_started and not self.lockstep:
            return  # light may arrive before an estimate; in lockstep every node answers
        setpoint = self._choose_setpoint(inputs)
        stamp = step.messages['light/estimate'][-1].header.stamp
        pose, velocity = from_setpoint(stamp, setpoint)
        self._pose.publish(pose)
        self._velocity.publish(velocity)
        self._beacon.publish(Float64(data=self._guidance.beacon))
        self._update_tasks('the drone turned over' if self._reader.has_overturned else '')

    def _choose_setpoint(self, inputs: GuidanceInputs) -> Setpoint:
        """Return the setpoint, and report the mission's state."""
        if isinstance(self._guidance, CommandedFlight):
            self._guidance.limits = self._settings.value.limits
        try:
            setpoint = self._guidance.choose_setpoint(inputs)
        except BadInput as error:  # of a strategy from a file
            # The bag holds why; the node ends, and without setpoints the drone lands
            self.health.report('mission', HealthLevel.ERROR, f'{error}')
            self.publish_health()
            raise
        self.health.set_fact(describe_guidance(self._guidance, inputs.explain_restriction()))
        return setpoint

    def _update_tasks(self, fault: str = '') -> None:
        """Follow a step, or a fault, in the actions."""
        self._stepped = time.monotonic()
        if isinstance(self._guidance, CommandedFlight):
            if fault:
                self._guidance.fail(fault)
            elif self._held:
                self._guidance.yield_to_person()
        for server in self._servers:
            server.update()

    def _on_tracked(self, message: Odometry) -> None:
        self._reader.tracked = to_tracked(message)

    def _on_takeover(self, held: Bool) -> None:
        self._held = held.data
        if self._held:
            self._update_tasks()

    def _on_motors(self, motors: ActuatorDuty) -> None:
        if isinstance(self._guidance, CommandedFlight):
            self._guidance.motors_turn = any(motors.duty)

    def _monitor_inputs(self) -> None:
        """Report missing inputs, without which no task goes on."""
        super()._monitor_inputs()
        missing = [] if self.lockstep or not self._servers else self.list_missing_inputs()
        # The controller lands long before
        if missing and time.monotonic() - self._stepped > SILENCE_LIMIT:
            self._update_tasks(f'no messages on {", ".join(missing)}')


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Navigator, args)
