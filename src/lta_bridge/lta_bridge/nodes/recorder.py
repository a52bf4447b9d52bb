"""
The recorder node: everything that the topic table marks as recorded, as it comes, into a bag.

The middleware fills the gaps that CDR leaves between numbers with whatever its memory held before.
That repeats itself where every message of a topic has the same layout. Where texts change their
length it does not, so the gaps of such a repeatable topic are written as zeros.

What is older than `FLUSH_PERIOD` survives even SIGKILL. When the disk fills, the bag is closed
while its index still fits and the process ends with a sentence and status 2.
"""

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
import time
from typing import Any

from lta_bridge.bag.qos import offered_qos
from lta_bridge.bag.storage import free_space, StorageFault
from lta_bridge.bag.writer import BagWriter
from lta_bridge.bookkeeping import Bookkeeping
from lta_bridge.cdr import serialise
from lta_bridge.provenance import joined, provenance
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_config.topics import is_name, robot_topic
from lta_graph.health import Level
from lta_graph.interrupts import held_interrupts
from lta_graph.ros.node import GraphNode, message_type, run
from lta_graph.ros.parameters import Parameters
from lta_graph.ros.qos import profile
from lta_graph.ros.spin import spin
from pydantic import create_model
from rclpy.clock import Clock, ClockType
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

FLUSH_PERIOD = 0.4  # wall seconds; a killed recorder loses at most this
QUIET = 0.3  # wall seconds without a message after which nothing more is on the way
LINGER = 3.0  # wall seconds to wait for that quiet at most
MARGIN = 4_000_000  # bytes left free on the disk beyond what closing needs
VARYING = {'diagnostic_msgs/msg/DiagnosticArray'}  # types whose texts change their length
DEPTH = 1000  # messages that may wait while the disk is slow
NAP_NS = 5_000_000  # between looks: waking up for every message would cost half a core


class Origin(Settings):
    """What the bag says of a robot's origin."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    gains: str = setting('gtmab', "Name or file of the controller's gains.", fixed=True)
    strategy: str = setting('bag', 'Navigation strategy.', fixed=True)
    seed: int = setting(1, 'Seed of all chance.', low=0, high=2**31 - 1, fixed=True)
    offset_x: float = setting(
        0.0, "Start, east of the scenario's.", unit='m', low=-1e3, high=1e3, fixed=True
    )
    offset_y: float = setting(
        0.0, "Start, north of the scenario's.", unit='m', low=-1e3, high=1e3, fixed=True
    )


class RecorderSettings(Origin):
    """Where to, and what the bag says of its origin."""

    bag: str = setting('bag', 'Folder of the bag; it must not exist yet or be empty.', fixed=True)
    robots: str = setting(
        '',
        'Namespaces of the robots to record, with spaces between; the own one where empty. Of '
        'several, lta2.seed and so on tell the origin of each.',
        fixed=True,
    )


def origins(node: GraphNode, robots: list[str]) -> dict[str, Origin]:
    """Declare and return the origin of each robot, its parameters named `lta2.seed`."""
    for name in robots:
        if not is_name(name) or robots.count(name) > 1:
            raise BadInput(
                f"The recorder's robots are '{' '.join(robots)}', but '{name}' is no name or "
                'stands twice; give different namespaces.'
            )
    fields: Any = {name: (Origin, setting(Origin(), f'Origin of {name}.')) for name in robots}
    told = Parameters(node, create_model('Origins', __base__=Settings, **fields)).value
    return {name: getattr(told, name) for name in robots}


class Recorder(GraphNode):
    """Write raw messages to a bag."""

    def __init__(self) -> None:
        super().__init__('recorder')
        settings = Parameters(self, RecorderSettings).value
        robots = settings.robots.split()
        found = {name: self._told(item) for name, item in origins(self, robots).items()}
        origin = joined(found) if found else self._told(settings)
        robots = robots or [self.get_namespace().strip('/')]
        whole = self.lockstep and not self.replayed  # a recording may begin anywhere
        self._books = {name: Bookkeeping(self.table, whole) for name in robots}
        self._common = Bookkeeping(self.table, whole)
        self._fault = ''
        self._latest = time.monotonic()
        with ExitStack() as unfinished:
            with held_interrupts():  # a bag is begun whole ...
                self._writer = BagWriter(Path(settings.bag), origin)
                unfinished.callback(self._writer.close)  # ... and closed, whoever ends it here
            for name, topic in self.table.topics.items():
                for robot in robots if topic.recorded else []:
                    self._record(robot, name)
            self._writer.flush()
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self.create_timer(FLUSH_PERIOD, self._flush, clock=steady)
            unfinished.pop_all()

    def _told(self, origin: Origin) -> dict[str, str]:
        """Return a robot's origin as the bag tells it."""
        moved = {'offset_x': origin.offset_x, 'offset_y': origin.offset_y}
        return provenance(
            origin.vehicle,
            origin.scenario,
            origin.gains,
            strategy=origin.strategy,
            seed=str(origin.seed),
            time='lockstep' if self.lockstep else 'realtime',
            **{name: str(value) for name, value in moved.items() if value},
        )

    def _record(self, robot: str, name: str) -> None:
        """Record a topic of a robot; what is of all robots is recorded once."""
        topic = self.table[name]
        if name.startswith('/') and robot != next(iter(self._books)):
            return
        offered = profile(topic, self.lockstep)
        words = offered.reliability.name.lower(), offered.durability.name.lower()
        absolute = robot_topic(robot, name) if robot else f'/{name.lstrip("/")}'
        self._writer.add_topic(absolute, topic.type, [offered_qos(*words, offered.depth)])
        asked = QoSProfile(
            depth=max(DEPTH, offered.depth),
            reliability=offered.reliability,
            durability=offered.durability,
        )
        callback = self._writes(robot, name, absolute)
        self.create_subscription(message_type(topic), absolute, callback, asked, raw=True)

    def _log_time(self, robot: str, name: str, data: bytes) -> int:
        """Return when a message was published; what is of all robots is as new as the newest."""
        if not name.startswith('/'):
            return self._books[robot].log_time(name, data)
        self._common.log_time(name, data)
        return max(books.now for books in self._books.values())

    def _writes(self, robot: str, name: str, absolute: str) -> Callable[[bytes], None]:
        topic = self.table[name]
        varying = topic.repeatable and topic.type in VARYING
        kind = message_type(topic)

        def write(data: bytes) -> None:
            self._latest = time.monotonic()
            if not self._fault:
                try:
                    when = self._log_time(robot, name, data)
                    kept = serialise(deserialize_message(data, kind)) if varying else data
                    self._writer.write(absolute, kept, when)
                except StorageFault as fault:
                    self._give_up(str(fault))

        return write

    def _flush(self) -> None:
        if self._fault:
            return
        try:
            self._writer.flush()
        except StorageFault as fault:
            self._give_up(str(fault))
            return
        if free_space(self._writer.path) < self._writer.reserve + MARGIN:
            self._give_up(
                f"The disk is nearly full, so the bag '{self._writer.path}' ends here, whole; "
                'make room before the next flight.'
            )
        self._report()

    def _report(self) -> None:
        """Tell how many messages came, and what is wrong with which topics."""
        wrong = {
            'lost': self._counted('lost'),
            'with a wild stamp': self._counted('wild'),
            'cut short': self._counted('torn'),
        }
        words = [
            f'{sum(found.values())} messages {what}' for what, found in wrong.items() if found
        ]
        by_topic = {
            f'{name} {what}': count
            for what, found in wrong.items()
            for name, count in found.items()
        }
        self.health.report(
            'recording',
            Level.WARN if words else Level.OK,
            ', '.join(words) or 'recording',
            messages=sum(self._counted('counts').values()),
            **by_topic,
        )

    def _counted(self, what: str) -> dict[str, int]:
        """Return a count of the books by topic, with the robot's name before it of several."""
        several = len(self._books) > 1
        found: dict[str, int] = dict(getattr(self._common, what))
        for robot, books in self._books.items():
            for name, count in getattr(books, what).items():
                found[robot_topic(robot, name) if several else name] = count
        return found

    def _give_up(self, reason: str) -> None:
        """End the recording and the process; the sentence is said once the bag is closed."""
        self._fault = reason
        self.health.report('recording', Level.ERROR, reason)
        self.running = False

    def work(self) -> None:
        """Record until told to stop, then until nothing more is on the way."""
        self.health.report('state', Level.OK, 'running')
        spin(self, lambda: self.running, awaited=list, wait_ns=NAP_NS)
        deadline = time.monotonic() + LINGER
        if not self._fault:
            self._latest = time.monotonic()
            end = lambda: time.monotonic() < min(deadline, self._latest + QUIET)  # noqa: E731
            spin(self, end, awaited=list, wait_ns=NAP_NS)

    def close(self) -> None:
        """Finish the bag, and say so if it had to end early."""
        try:
            self._writer.close()
        except StorageFault as fault:
            self._fault = self._fault or str(fault)
        if self._fault:
            self.health.report('recording', Level.ERROR, self._fault, unwritten=self._writer.lost)
        self.publish_health()
        super().close()
        if self._fault:
            raise BadInput(self._fault)


def main(args: list[str] | None = None) -> None:
    """Run the node until it is told to stop."""
    run(Recorder, args)
