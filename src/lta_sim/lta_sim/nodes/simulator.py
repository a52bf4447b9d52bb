"""
Simulate the vehicle in a ROS node, in place of the hardware.

In lockstep the node publishes a state, waits for the duties in answer, and advances; in real time
it follows the wall clock. It also decides when the flight ends: it exits with status 0 and reports
the outcome when the flight has reached its goal, run out of time or left the room.

The simulators of one launch stay synchronised (see `lta_graph.ros.peer_listener`), and one of them
publishes /clock for all. A finished vehicle stops and waits until the others have finished.
"""

from collections.abc import Iterator
import json
import operator
import os
import sys
import time
from typing import Unpack

from builtin_interfaces.msg import Time
from lta_config.errors import unknown_name_error
from lta_config.topics import is_selected
from lta_graph.health import HealthLevel
from lta_graph.inbox import InboxStep
from lta_graph.reach import describe_reach
from lta_graph.ros import vehicle_messages as messages
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode, LONG_ACKNOWLEDGE_TIME
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.peer_listener import OVER_VALUE, PeerListener, PULSE_TOPIC
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_graph.ros.startup import wait_until_complete, wait_until_settled
from lta_graph.ros.transforms import from_start
from lta_model.scenario import load_scenario, offset_start
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome, SensorReadings
from lta_sim.simulator_settings import SimulatorSettings, WAIT_FOR_DEFAULT, WAIT_FOR_DESCRIPTION
from lta_sim.world import World
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rosgraph_msgs.msg import Clock as ClockMessage

STALE_NS = 300_000_000  # commands older or newer than this stop the motors, as on the real vehicle
REPORTED_CHARACTERS = 100  # characters of a refused command that are reported
LARGEST_CATCH_UP = 50  # control periods of delay that are caught up
# Control periods that are caught up without a pause: fewer than the queue of a sensor topic holds,
# as readers in the same process are called only afterwards
BURST_STEPS = 4
LOST_TIME_SHARE = 0.05  # share of the wall clock that may be lost before a report
CLOCK_PERIOD = 0.02  # wall seconds between two /clock
GRAPH_START_TIME = 20.0  # wall seconds for the graph of one drone to come up


class Simulator(GraphNode):
    """Publish the sensor readings of a `World` and apply the duties received in answer."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('simulator', role='vehicle', **options)
        self.health.set_fact(describe_reach(os.environ))
        self._settings = NodeParameters(self, SimulatorSettings).value
        offset = self._settings.offset_x, self._settings.offset_y
        scenario = offset_start(load_scenario(self._settings.scenario), *offset)
        vehicle = load_vehicle(self._settings.vehicle, scenario.air.density)
        self._world = World(
            vehicle, scenario, self.table, self._settings.seed, self._settings.strategy
        )
        if self._settings.commanded:
            self._world.fly_without_end()
        names = self.table.published_by('vehicle')
        if not self._settings.clock:
            names.remove('/clock')
        self._outputs = {name: self.create_output(name) for name in names}
        self._publish_start()
        self._awaited = self._list_awaited_roles()
        self.subscribe_inputs(
            ['motors', 'energy/reserve'], trigger='motors', on_step=self._on_motors
        )
        self._peers = PeerListener(self, self._settings.peers.split(), self._on_peer_update)
        self._rotors = vehicle.rotor_names
        self._duties = [0.0] * len(self._rotors)
        self._lowest = [-1.0 if reversible else 0.0 for reversible in vehicle.reversible]
        self._refused = False
        self._fed = True
        self._commanded_ns = 0
        self._began = self._anchor = self._clocked = 0.0
        self._lost = 0.0  # wall seconds of skipped delay
        self._finished: float | None = None
        if not self.lockstep:
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self._pacer = self.create_timer(self.table.control_ns * 1e-9, self._tick, clock=steady)
            # Started in `run`, when all subscribers are there
            self._pacer.cancel()

    def run(self) -> Iterator[None]:
        """Wait for the graph, then fly."""
        yield from wait_until_complete(
            self, self._find_missing_subscribers, GRAPH_START_TIME * (1 + len(self._peers.names))
        )
        if not self.lockstep:
            yield from wait_until_settled(self, self._awaited, GRAPH_START_TIME)
        self._began = self._anchor = time.monotonic()
        self.begun = True
        self._publish_step()
        if not self.lockstep:
            self._pacer.reset()
        yield from super().run()

    def _publish_start(self) -> None:
        """Publish where the drone starts in the map; only viewers and recorder read it."""
        self.create_output('/tf_static').publish(from_start(self._world.start_pose))

    def _list_awaited_roles(self) -> set[str]:
        """Return the roles of the nodes to wait for; raise `BadInput` for an unknown one."""
        names = self._settings.wait_for.split()
        roles = [WAIT_FOR_DEFAULT, WAIT_FOR_DESCRIPTION, *self.table.roles]
        for name in names:
            if name not in roles:
                raise unknown_name_error('role in wait_for', name, roles)
        awaited = set(names) - {WAIT_FOR_DEFAULT}
        if WAIT_FOR_DEFAULT in names and self.lockstep:
            awaited.update(role for name in self._outputs for role in self.table[name].subscribers)
        return awaited

    def _find_missing_subscribers(self) -> list[str]:
        """Return the awaited nodes that do not subscribe or publish yet."""
        waiting: set[str] = set()
        words, robot = self._settings.topics, self.get_namespace().strip('/')
        for name, publisher in self._outputs.items():
            readers = self._awaited & set(self.table[name].subscribers)
            # Every other simulator of the launch listens to this one's pulse
            if name == PULSE_TOPIC:
                readers |= {f'{peer}/vehicle' for peer in self._peers.names}
            if publisher.get_subscription_count() < len(readers):
                waiting |= readers
            recorded = self._settings.record and is_selected(words, robot, name, self.table[name])
            if recorded and not self._is_subscribed('recorder', name):
                waiting.add('recorder')
        if WAIT_FOR_DESCRIPTION in self._awaited and not all(
            self.count_publishers(name) for name in self.table.published_by(WAIT_FOR_DESCRIPTION)
        ):
            waiting.add(WAIT_FOR_DESCRIPTION)
        return sorted(waiting)

    def _is_subscribed(self, node: str, name: str) -> bool:
        """Return whether a node subscribes to a topic."""
        readers = self.get_subscriptions_info_by_topic(name)
        return node in {reader.node_name for reader in readers}

    def _on_motors(self, step: InboxStep) -> None:
        for command in step.messages['motors']:
            self._accept_command(command.name, list(command.duty))
        stamp_ns = from_stamp(step.messages['motors'][-1].header.stamp)
        # A future stamp would stay fresh for too long
        if stamp_ns <= self._world.stamp_ns + STALE_NS:
            self._commanded_ns = stamp_ns
        if self.lockstep:
            self._fly_control_step()

    def _on_peer_update(self) -> None:
        """Continue when the other simulators are ready, or exit with them."""
        if self._finished is None:
            if self.lockstep and self._peers.is_waiting:
                self._fly_control_step()
        elif self._peers.has_active_peers:
            self._publish_clock(to_stamp(self._peers.common_time(self._world.stamp_ns)))
        else:
            self.running = False

    def list_missing_inputs(self) -> list[str]:
        """Return the inputs that this node is waiting for; none after its flight has ended."""
        if self._finished is not None:
            return []
        return (
            self._peers.list_missing_pulses()
            if self._peers.is_waiting
            else super().list_missing_inputs()
        )

    def _accept_command(self, names: list[str], duties: list[float]) -> None:
        """Accept a command, or stop the motors on an invalid one."""
        expected = self._rotors
        fits = list(names) == expected and len(duties) == len(expected)
        # NaN is refused as well: it compares false.
        if fits and all(map(operator.le, self._lowest, duties)) and max(duties) <= 1.0:
            self._duties = duties
            if self._refused:
                self._refused = False
                self.health.report('command', HealthLevel.OK, 'accepted')
            return
        # An invalid command must not leave the last one active
        self._duties = [0.0] * len(expected)
        self._refused = True
        self.health.report(
            'command',
            HealthLevel.ERROR,
            f'invalid motor command with the duties {repr(duties)[:REPORTED_CHARACTERS]} for the '
            f'rotors {repr(names)[:REPORTED_CHARACTERS]}, so the motors are off; send duties for '
            f'the rotors {expected}, from {self._lowest} to 1',
        )

    def _tick(self) -> None:
        """Follow the wall clock: catch up after a late tick, skip and report a long delay."""
        period = self.table.control_ns * 1e-9
        # Steps that should have been flown by now
        due = round((time.monotonic() - self._anchor) / period)
        if due - self._world.steps > LARGEST_CATCH_UP:
            self._skip_delay((due - self._world.steps - 1) * period)
            due = self._world.steps + 1
        due = min(due, self._world.steps + BURST_STEPS)
        while self._world.steps < due and self.running:
            # Without fresh commands the motors stop, as on the real vehicle
            if self._world.stamp_ns - self._commanded_ns > STALE_NS:
                self._duties = [0.0] * len(self._duties)
            if not self._fly_control_step():
                # Do not catch up after waiting for slower simulators: all would fly in bursts.
                self._skip_delay(time.monotonic() - self._world.steps * period - self._anchor)
                return

    def _skip_delay(self, delay: float) -> None:
        """Skip a delay, and report it once it is noticeable. [s]"""
        self._anchor += delay
        if self._world.steps == 0:  # the others are not there yet: the flight has not begun
            self._began = self._anchor
            return
        self._lost += delay
        if self._lost > LOST_TIME_SHARE * (time.monotonic() - self._began):
            self.health.report(
                'pace',
                HealthLevel.WARN,
                'the simulation runs slower than real time',
                lost_s=f'{self._lost:.2f}',
            )

    def _fly_control_step(self) -> bool:
        """Fly a control step; return False where none is due yet or the flight has ended."""
        if self._finished is not None:
            return False
        if self._is_flight_over():
            self._finished, self.farewell = time.monotonic(), LONG_ACKNOWLEDGE_TIME
            self.health.changed = True  # the others may be waiting for this
            self._monitor_inputs()
            self._on_peer_update()
            return False
        if not self._peers.may_advance(self._world.stamp_ns + self.table.control_ns):
            return False
        self._world.advance(self._duties)
        self._report_supply()
        self._publish_step()
        return True

    def _report_supply(self) -> None:
        """Report a supply failure, which stops the motors, and its end."""
        if self._fed == self._world.supply.is_fed:
            return
        self._fed = not self._fed
        if self._fed:
            self.health.report(
                'supply',
                HealthLevel.OK,
                'the solar panel has charged the battery: the power supply is on again',
            )
        else:
            self.health.report(
                'supply',
                HealthLevel.ERROR,
                'brown-out: the battery is empty or its voltage fell below the cut-off; '
                'the motors are off until light has charged it',
            )

    def _is_flight_over(self) -> bool:
        """Return whether to stop: one control step after a light block, when all have answered."""
        over = self._world.outcome is not FlightOutcome.FLYING
        return over and self.table.is_settled(self._world.stamp_ns)

    def _publish_step(self) -> None:
        """Publish a control step; the outputs that the next command waits for go first."""
        # The estimator can work while light and energy are still computed
        readings = self._world.sense_motion()
        stamp = to_stamp(readings.stamp_ns)
        self._publish_motion(stamp, readings)
        self._world.sense_rest(readings)
        self._publish_rest(stamp, readings)
        self._publish_clock(stamp)

    def _publish_clock(self, stamp: Time) -> None:
        """Publish graph time if it is due and this simulator's task."""
        now = time.monotonic()
        if self._settings.clock and now - self._clocked >= CLOCK_PERIOD:
            self._clocked = now
            self._outputs['/clock'].publish(ClockMessage(clock=stamp))

    def _publish_motion(self, stamp: Time, readings: SensorReadings) -> None:
        """Publish range, pressure and IMU, the last of which the estimator answers."""
        out = self._outputs
        for taken_ns, distance in readings.ranges:
            sensor = self._world.range_settings
            limits = sensor.minimum, sensor.maximum
            message = messages.build_range_message(
                to_stamp(taken_ns), distance, limits, sensor.field_of_view
            )
            out['range'].publish(message)
        if readings.pressure is not None:
            noise = self._world.pressure_settings.noise
            out['pressure'].publish(
                messages.build_pressure_message(stamp, readings.pressure, noise)
            )
        noises = self._world.imu_errors.noise
        out['imu'].publish(
            messages.build_imu_message(stamp, readings.force, readings.rates, noises)
        )

    def _publish_rest(self, stamp: Time, readings: SensorReadings) -> None:
        """Publish light, energy and truth."""
        out = self._outputs
        if readings.truth is not None:
            out['ground_truth/odom'].publish(messages.build_odometry(stamp, readings.truth))
        if readings.block is not None:
            begun_ns, block = readings.block
            out['photodiodes'].publish(
                messages.build_light_block_message(to_stamp(begun_ns), block)
            )
        if readings.illuminance is None or readings.battery is None or readings.panel is None:
            return
        out['wind'].publish(messages.build_wind_message(stamp, self._world.wind))
        out['illuminance'].publish(messages.build_illuminance_message(stamp, readings.illuminance))
        out['panel'].publish(messages.build_battery_state(stamp, *readings.panel, 'panel'))
        out['battery'].publish(messages.build_battery_state(stamp, *readings.battery, 'battery'))

    def _summarize_flight(self) -> dict[str, str]:
        """Return the state of the flight in figures."""
        world = self._world
        now = self._finished or time.monotonic()
        wall = now - self._began if self._began else 0.0
        # Simulated seconds per wall second
        pace = world.elapsed / wall if wall else 0.0
        return {
            'outcome': world.outcome.name.lower(),
            'sentence': str(world.outcome),
            'time_s': f'{world.elapsed:.2f}',
            'distance_m': f'{world.goal_distance:.3f}',
            'pace': f'{pace:.2f}',
            'lost_s': f'{self._lost:.2f}',
        }

    def _monitor_inputs(self) -> None:
        """Report the state of the flight."""
        standing = self._summarize_flight()
        text = f'{standing["sentence"]}, {standing["distance_m"]} m from the lamp'
        over = {OVER_VALUE: self._finished is not None}
        self.health.report('flight', HealthLevel.OK, text, **standing, **over)
        super()._monitor_inputs()

    def graph_time_ns(self) -> int:
        """Return the time of the simulated world, which is that of the graph. [ns]"""
        return self._world.stamp_ns

    def close(self) -> None:
        """Report the outcome, also to the launcher, and let the last messages leave."""
        self.health.changed = True  # the outcome does not wait for the next report
        self._monitor_inputs()
        if self._world.steps:  # a flight that never began has no outcome
            # One line of JSON, which the launcher parses
            sys.stdout.write(json.dumps(self._summarize_flight()) + '\n')
            sys.stdout.flush()
        super().close()


def main(args: list[str] | None = None) -> None:
    """Run the node until the flight ends or it is shut down."""
    run_node(Simulator, args)
