"""
The simulator node: plays the vehicle.

In lockstep it publishes a state, waits for the duties that answer it, and steps on; in real time
it paces on the wall clock. It also referees: the process ends with status 0 when the flight has
reached its goal, run out of time or left the room, and says which.
"""

import json
import operator
import sys
import time

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_graph.health import Level
from lta_graph.inbox import Step
from lta_graph.ros.node import from_stamp, GraphNode, run, to_stamp
from lta_graph.ros.parameters import Parameters
from lta_sim import messages
from lta_sim.readings import Outcome, Readings
from lta_sim.scenario import load_scenario
from lta_sim.vehicle import load_vehicle
from lta_sim.world import World
from rclpy.clock import Clock, ClockType
from rosgraph_msgs.msg import Clock as ClockMessage

STALE_NS = 300_000_000  # commands older than this stop the motors, as on the real vehicle
SLIP = 50  # control periods of delay that are made up for at once
CLOCK_PERIOD = 0.02  # wall seconds between two /clock
PATIENCE = 20.0  # wall seconds for the graph to come up


class SimulatorSettings(Settings):
    """What is simulated."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    seed: int = setting(1, 'Seed of all chance.', low=0, high=2**31 - 1, fixed=True)
    record: bool = setting(False, 'Whether to wait for a recorder.', fixed=True)


class Simulator(GraphNode):
    """Publish what a `World` senses and fly the duties that come back."""

    def __init__(self) -> None:
        super().__init__('simulator', role='vehicle')
        self._settings = Parameters(self, SimulatorSettings).value
        scenario = load_scenario(self._settings.scenario)
        vehicle = load_vehicle(self._settings.vehicle, scenario.air.density)
        self._world = World(vehicle, scenario, self.table, self._settings.seed)
        self._outputs = {name: self.output(name) for name in self.table.published_by('vehicle')}
        inputs = self.table.read_by('vehicle')
        self.listen(inputs, trigger='motors', on_step=self._on_motors)
        self._duties = [0.0] * len(vehicle.rotor_names)
        self._lowest = [-1.0 if reversible else 0.0 for reversible in vehicle.reversible]
        self._refused = False
        self._commanded_ns = 0
        self._began = self._anchor = self._clocked = 0.0
        self._finished: float | None = None
        if not self.lockstep:
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self._pacer = self.create_timer(self.table.control_ns * 1e-9, self._tick, clock=steady)
            self._pacer.cancel()

    def work(self) -> None:
        """Wait for the graph, then fly."""
        self._wait_for_graph()
        self._began = self._anchor = time.monotonic()
        self.begun = True
        self._publish()
        if not self.lockstep:
            self._pacer.reset()
        super().work()

    def _lonely(self) -> list[str]:
        """Return whom the outputs still wait for."""
        waiting: set[str] = set()
        for name, publisher in self._outputs.items():
            readers = set(self.table[name].subscribers)
            if self._settings.record and self.table[name].recorded:
                readers.add('recorder')
            if publisher.get_subscription_count() < len(readers):
                waiting |= readers
        return sorted(waiting)

    def _wait_for_graph(self) -> None:
        deadline = time.monotonic() + PATIENCE
        while self.running and (missing := self._lonely()):
            if time.monotonic() > deadline:
                raise BadInput(
                    f'After {PATIENCE:.0f} s the simulator still waits for {", ".join(missing)}; '
                    'start them, or see "lta doctor" on discovery between processes.'
                )
            time.sleep(0.02)

    def _on_motors(self, step: Step) -> None:
        for command in step.messages['motors']:
            self._take(command.name, list(command.effort))
        self._commanded_ns = from_stamp(step.messages['motors'][-1].header.stamp)
        if self.lockstep:
            self._step()

    def _take(self, names: list[str], duties: list[float]) -> None:
        """Accept a command, or stop the motors on one that cannot be meant."""
        expected = self._world.vehicle.rotor_names
        fits = list(names) == expected and len(duties) == len(expected)
        # NaN is refused as well: it compares false.
        if fits and all(map(operator.le, self._lowest, duties)) and max(duties) <= 1.0:
            self._duties = duties
            if self._refused:
                self._refused = False
                self.health.report('command', Level.OK, 'accepted')
            return
        self._duties = [0.0] * len(expected)
        self._refused = True
        self.health.report(
            'command',
            Level.ERROR,
            f'refused duties {duties} of {names}: expected {expected} from {self._lowest} to 1; '
            'the motors are off',
        )

    def _tick(self) -> None:
        """Follow the wall clock: a late tick is made up for, a long delay is let go and said."""
        period = self.table.control_ns * 1e-9
        due = round((time.monotonic() - self._anchor) / period)
        if due - self._world.steps > SLIP:
            self._anchor += (due - self._world.steps - 1) * period
            self.health.report('pace', Level.WARN, 'cannot keep pace with the wall clock')
            due = self._world.steps + 1
        while self._world.steps < due and self.running:
            if self._world.stamp_ns - self._commanded_ns > STALE_NS:
                self._duties = [0.0] * len(self._duties)
            self._step()

    def _step(self) -> None:
        if self._ended():
            self._finished = time.monotonic()
            self.running = False
            return
        self._world.advance(self._duties)
        self._publish()

    def _ended(self) -> bool:
        """Tell whether to stop: one control step after a light block, when all have answered."""
        over = self._world.outcome is not Outcome.FLYING
        return over and self.table.settled(self._world.stamp_ns)

    def _publish(self) -> None:
        """Publish a control step; what the next command waits for goes first."""
        readings = self._world.sense_motion()
        self._publish_motion(readings)
        self._world.sense_rest(readings)
        self._publish_rest(readings)
        now = time.monotonic()
        if now - self._clocked >= CLOCK_PERIOD:
            self._clocked = now
            self._outputs['/clock'].publish(ClockMessage(clock=to_stamp(readings.stamp_ns)))

    def _publish_motion(self, readings: Readings) -> None:
        """Publish range, pressure and IMU, the last of which the estimator answers."""
        stamp = to_stamp(readings.stamp_ns)
        out = self._outputs
        for taken_ns, distance in readings.ranges:
            message = messages.range_(to_stamp(taken_ns), distance, self._world.range_settings)
            out['range'].publish(message)
        if readings.pressure is not None:
            noise = self._world.pressure_settings.noise
            out['pressure'].publish(messages.pressure(stamp, readings.pressure, noise))
        noises = self._world.imu_errors.noise
        out['imu'].publish(messages.imu(stamp, readings.force, readings.rates, noises))

    def _publish_rest(self, readings: Readings) -> None:
        """Publish light, energy and truth."""
        stamp = to_stamp(readings.stamp_ns)
        out = self._outputs
        if readings.truth is not None:
            out['ground_truth/odom'].publish(messages.truth(stamp, readings.truth))
        if readings.block is not None:
            begun_ns, block = readings.block
            out['photodiodes'].publish(messages.light_block(to_stamp(begun_ns), block))
        if readings.illuminance is None or readings.battery is None or readings.panel is None:
            return
        out['wind'].publish(messages.wind(stamp, self._world.wind))
        out['illuminance'].publish(messages.illuminance(stamp, readings.illuminance))
        out['panel'].publish(messages.branch(stamp, *readings.panel, 'panel'))
        out['battery'].publish(messages.branch(stamp, *readings.battery, 'battery'))

    def _standing(self) -> dict[str, str]:
        """Return how the flight stands, in figures."""
        world = self._world
        now = self._finished or time.monotonic()
        wall = now - self._began if self._began else 0.0
        pace = world.elapsed / wall if wall else 0.0
        return {
            'outcome': world.outcome.name.lower(),
            'sentence': str(world.outcome),
            'time_s': f'{world.elapsed:.2f}',
            'distance_m': f'{world.distance:.3f}',
            'pace': f'{pace:.2f}',
        }

    def _watch(self) -> None:
        """Tell how the flight stands at every look, for progress bars."""
        standing = self._standing()
        text = f'{standing["sentence"]}, {standing["distance_m"]} m from the lamp'
        self.health.report('flight', Level.OK, text, **standing)
        self.health.changed = True
        super()._watch()

    def close(self) -> None:
        """Say how the flight ended, also to whoever started it, and let the last messages out."""
        self._watch()
        sys.stdout.write(json.dumps(self._standing()) + '\n')
        sys.stdout.flush()
        super().close()


def main(args: list[str] | None = None) -> None:
    """Run the node until the flight ends or it is told to stop."""
    run(Simulator, args)
