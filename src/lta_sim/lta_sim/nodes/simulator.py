# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate one drone or several in a ROS node, in place of the hardware.

In lockstep the node publishes a step, waits for the motor commands of all drones in answer, and
flies the next; in real time it follows the wall clock. A drone whose flight is over stands still.
When all are over, the node prints the outcomes and exits with status 0.
"""

from collections.abc import Iterator
from functools import partial
import json
import os
import sys
import time
from typing import Unpack

from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.reach import describe_reach
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode, LONG_ACKNOWLEDGE_TIME
from lta_graph.ros.parameters import declare_robots, NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_graph.ros.startup import wait_for_graph
from lta_graph.ros.transforms import from_start
from lta_sim.drone import DroneSettings, Pacer, SimulatedDrone, SimulatorSettings
from lta_sim.messages import sense_motion, sense_rest
from rosgraph_msgs.msg import Clock as ClockMessage
from tf2_msgs.msg import TFMessage

CLOCK_PERIOD = 0.02  # wall seconds between two /clock
GRAPH_START_TIME = 20.0  # wall seconds for the graph of one drone to come up


class Simulator(GraphNode):
    """Publish the sensor readings of the drones, and fly the motor commands received in answer."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('simulator', role='vehicle', **options)
        self.health.set_fact(describe_reach(os.environ))
        settings = self._settings = NodeParameters(self, SimulatorSettings).value
        self._awaited = settings.list_awaited_roles(self.table, lockstep=self.lockstep)
        robots = declare_robots(self, settings.robots, DroneSettings) or {'': settings}
        self.drones: dict[str, SimulatedDrone] = {}  # by the prefix of their topics
        self._outputs = {'/clock': self.create_output('/clock')}
        starts = TFMessage()
        for robot, own in robots.items():
            prefix = f'{robot}/' if robot else ''
            drone = self.drones[prefix] = SimulatedDrone(own, self.table, self.add_robot(robot))
            for name in self.table.published_by('vehicle'):
                if name not in self._outputs:
                    self._outputs[prefix + name] = self.create_output(prefix + name)
            take = partial(self._on_motors, drone)
            self.subscribe_inputs(['motors', 'energy/reserve'], 'motors', take, prefix)
            starts.transforms += from_start(drone.world.start_pose, prefix).transforms
        self.create_output('/tf_static').publish(starts)
        self._flying = dict(self.drones)
        self._steps, self._clocked = 0, 0.0
        self._pacer = Pacer(self.table.control_ns * 1e-9)

    def run(self) -> Iterator[None]:
        """Wait for the graph, then fly."""
        recorded = self._settings.topics if self._settings.record else None
        patience = GRAPH_START_TIME * len(self.drones)
        yield from wait_for_graph(self, self._outputs, self._awaited, recorded, patience)
        self._pacer.begin()
        self.begun = True
        self._publish_step()
        if not self.lockstep:
            self.create_timer(self._pacer.period, self._tick, clock=self.steady_clock)
        yield from super().run()

    def _on_motors(self, drone: SimulatedDrone, step: InboxStep) -> None:
        for command in step.messages['motors']:
            stamp_ns = from_stamp(command.header.stamp)
            drone.take_command(list(command.name), list(command.duty), stamp_ns)
        drone.is_answered = self.lockstep
        if self.lockstep and all(each.is_answered for each in self._flying.values()):
            self._fly_step()

    def _tick(self) -> None:
        """Follow the wall clock, and report where that is not possible."""
        for _ in range(self._pacer.count_due(self._steps)):
            for drone in self._flying.values():
                drone.stop_without_command()
            self._fly_step()
        if self._pacer.is_slow:
            words = 'the simulation runs slower than real time'
            self.health.report('pace', HealthLevel.WARN, words, lost_s=f'{self._pacer.lost:.2f}')

    def _fly_step(self) -> None:
        """Fly a control period with each drone whose flight is not over, and publish the step."""
        for prefix, drone in list(self._flying.items()):
            if drone.is_over:
                drone.finish()
                del self._flying[prefix]
                self.health.changed = True  # so that nobody takes its nodes for stalled
        if not self._flying:
            self.running, self.farewell = False, LONG_ACKNOWLEDGE_TIME
            return
        for drone in self._flying.values():
            drone.advance()
        self._steps += 1
        self._publish_step()

    def _publish_step(self) -> None:
        """Publish a control step; the outputs that the next command waits for go first."""
        # The estimators can work while light and energy are still computed
        for sense in (sense_motion, sense_rest):
            for prefix, drone in self._flying.items():
                for name, message in sense(drone):
                    self._outputs[prefix + name].publish(message)
        now = time.monotonic()
        if now - self._clocked >= CLOCK_PERIOD:
            self._clocked = now
            self._outputs['/clock'].publish(ClockMessage(clock=to_stamp(self.graph_time_ns())))

    def graph_time_ns(self) -> int:
        """Return the time of the simulation, which is that of the graph [ns]."""
        return self.table.start_ns + self._steps * self.table.control_ns

    def list_missing_inputs(self) -> list[str]:
        """Return the inputs that this node is waiting for; none of a drone that stands still."""
        waiting = tuple(k for k, each in self._flying.items() if not each.is_answered)
        return [name for name in super().list_missing_inputs() if name.startswith(waiting)]

    def _monitor_inputs(self) -> None:
        """Report the state of the flights."""
        for drone in self.drones.values():
            drone.report_flight(self._pacer)
        super()._monitor_inputs()

    def close(self) -> None:
        """Report the outcomes, also to the launcher, and let the last messages leave."""
        for drone in self._flying.values():
            drone.finish()
        self.health.changed = True  # the outcome does not wait for the next report
        self._monitor_inputs()
        # Lines of JSON, which the launcher parses; a flight that never began has no outcome
        for prefix, drone in self.drones.items() if self._steps else ():
            robot = {'robot': prefix[:-1]} if prefix else {}
            sys.stdout.write(json.dumps(robot | drone.report_flight(self._pacer)) + '\n')
        sys.stdout.flush()
        super().close()


def main(args: list[str] | None = None) -> None:
    """Run the node until the flights end or it is shut down."""
    run_node(Simulator, args)
