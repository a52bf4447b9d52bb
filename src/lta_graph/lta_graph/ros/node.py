# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The base class of LTA nodes: topics from the table, stepped inputs and health reports.

A node has a role in `topics.yaml`, which defines the types, names and quality of service of its
topics. `on_step` gets all inputs of one step (see `lta_graph.lockstep`). Health is published on
/diagnostics at every change of a level and every `REPORT_PERIOD`. Each fault and its end is
logged.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import partial
import time
from typing import Any, cast, Literal, Unpack

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_config.settings import setting, Settings
from lta_config.topics import load_topic_table, Topic
from lta_graph.health import Health, HealthLevel, HealthLog
from lta_graph.lockstep import Inbox, InboxStep
from lta_graph.ros.contained_node import ContainedNode, NodeOptions
from lta_graph.ros.message_validation import find_message_type, MESSAGES, MessageValidator
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.publisher_conflict import PublisherConflict
from lta_graph.ros.qos import reject_bad_overrides, select_profile, select_reader_profile
from lta_graph.ros.replay_due import DUE, subscribe_inbox_schedule
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_graph.ros.transforms import prefix_frames
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

WATCH_PERIOD = 0.1  # wall seconds between checks for missing inputs
REPORT_PERIOD = 1.0  # wall seconds between two unchanged /diagnostics
ACKNOWLEDGE_TIME = 0.2  # wall seconds for the last messages to be acknowledged
# The same after a successful flight, when a live recorder may be far behind
LONG_ACKNOWLEDGE_TIME = 5.0
REPORTED_WAIT = 0.5  # wall seconds of waiting after which the missing input is reported
LINKS_TASK = 'links'  # health task with the number of readers of each output
NO_INPUT_TIME = 5.0  # wall seconds without any input after which the node logs a warning


class GraphSettings(Settings):
    """Settings that all nodes of a graph must share."""

    time: Literal['realtime', 'lockstep'] = setting('realtime', fixed=True)
    """
    Time mode: realtime runs at the pace of the wall clock, lockstep as fast as the nodes answer.
    """
    source: Literal['sim', 'replay', 'crazyflie'] = setting('sim', fixed=True)
    """
    Where the data of the vehicle comes from: sim (the simulator), replay (a recording) or
    crazyflie (a real drone).
    """
    frame_prefix: str = setting('', fixed=True)
    """Prefix of all frames but map, in headers and on /tf, such as lta1/, for several drones."""


class FramePublisher(Publisher):
    """A publisher that gives the frames of its messages the prefix of the robot."""

    frame_prefix = ''

    def publish(self, msg: Any) -> None:
        """Publish a message; one that is serialised stays as it is."""
        if self.frame_prefix and not isinstance(msg, bytes):
            prefix_frames(self.frame_prefix, msg)
        super().publish(msg)


class GraphNode(ContainedNode):
    """
    A node with a role in the topic table.

    `name`: name of the node. `role`: role in the topic table; None if it is the name. `options`:
    as rclpy's Node takes them.
    """

    def __init__(self, name: str, role: str | None = None, **options: Unpack[NodeOptions]) -> None:
        super().__init__(name, **options)
        self.table = load_topic_table()
        self.role = role or name
        graph = NodeParameters(self, GraphSettings).value
        self.lockstep = graph.time == 'lockstep'
        self.frame_prefix = graph.frame_prefix
        # In lockstep no message may be lost
        self._overrides = None if self.lockstep else QoSOverridingOptions.with_default_policies()
        self.replayed = self.lockstep and graph.source == 'replay'
        self.running = True
        self.farewell = ACKNOWLEDGE_TIME
        self.hurried = False  # a second stop signal came during the shutdown
        self.begun = False  # whether a first message was sent or received
        self.health = Health()
        robot = self.get_namespace().strip('/')
        # By robot: the prefix of its topics, and its health, as a node may serve several
        self.prefixes = {robot: ''}
        self._healths = {robot: self.health}
        self._logs: defaultdict[str, HealthLog] = defaultdict(HealthLog)
        self.health.report('state', HealthLevel.OK, 'starting')
        # In lockstep the inbox checks the stamps
        self.soundness = MessageValidator(stamps=not self.lockstep)
        self.undecodable = self.soundness.unsound
        self._inboxes: dict[str, Inbox] = {}  # by prefix
        self._inputs: dict[str, Subscription] = {}
        self._writers: dict[str, Publisher] = {}
        self._conflict = PublisherConflict(self, self._writers)
        self._waiting_since: float | None = None
        self._received_at: dict[str, float] = {}
        self._reported = 0.0
        self._input_expected_by: float | None = time.monotonic() + NO_INPUT_TIME
        self._diagnostics = self.create_output('/diagnostics')
        # The ROS clock may jump or stand still; health needs wall time that only grows
        self.steady_clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(WATCH_PERIOD, self._monitor_inputs, clock=self.steady_clock)

    def add_robot(self, robot: str) -> Health:
        """Return the health of another robot that the node serves; '' for its own."""
        if not robot:
            return self.health
        # Then it has no topics of a robot of its own
        self.prefixes.pop(self.get_namespace().strip('/'), None)
        self.prefixes[robot] = f'{robot}/'
        return self._healths.setdefault(robot, Health())

    def split_prefix(self, name: str) -> tuple[str, str]:
        """Return the prefix of a topic's robot, '' for the node's own, and its bare name."""
        if name in self.table.topics:
            return '', name
        robot, _, own = name.strip('/').partition('/')
        return f'{robot}/', own

    def find_row(self, name: str) -> Topic:
        """Return the row of a topic, which may have the prefix of a robot."""
        return self.table[self.split_prefix(name)[1]]

    def create_output(self, name: str) -> Publisher:
        """
        Return a publisher on a topic of the table, which may have the prefix of a robot.

        Create the outputs before anything else. In real time a message is lost until its reader
        has matched, and a flight begins when the last node listens. Discovery then runs while
        files load.
        """
        topic = self.find_row(name)
        quality = select_profile(topic, self.lockstep)
        with reject_bad_overrides(self.get_name()):
            publisher = cast(
                'FramePublisher',
                self.create_publisher(
                    find_message_type(topic),
                    name,
                    quality,
                    publisher_class=FramePublisher,
                    qos_overriding_options=self._overrides,
                ),
            )
        publisher.frame_prefix = self.frame_prefix + self.split_prefix(name)[0]
        self._writers[name] = publisher
        return publisher

    def graph_time_ns(self) -> int:
        """Return the time of the graph; 0 before its clock has begun [ns]."""
        return int(self.get_clock().now().nanoseconds)

    def count_readers(self) -> dict[str, int]:
        """Return the number of matched readers of each output."""
        return {name: item.get_subscription_count() for name, item in self._writers.items()}

    def subscribe_inputs(
        self,
        topics: list[str],
        trigger: str,
        on_step: Callable[[InboxStep], None],
        prefix: str = '',
    ) -> None:
        """
        Subscribe to topics and call `on_step` for each message of the trigger.

        `topics`: names in the table, including the trigger. `trigger`: the topic whose messages
        start a step. `on_step`: gets an `InboxStep` with ROS messages. `prefix`: of the robot
        whose topics they are; each robot has steps of its own.
        """
        inbox = self._inboxes[prefix] = Inbox(
            self.table, self.role, topics, trigger, self.lockstep, self.replayed
        )
        for name in topics:
            receive = self._build_input_receiver(inbox, prefix, name, on_step)
            self._inputs[prefix + name] = self._subscribe(prefix + name, receive)
        if self.replayed:
            then = partial(self._run_complete_steps, inbox, on_step)
            self._inbox_schedule = subscribe_inbox_schedule(self, self.table, inbox, then)

    def subscribe_raw(self, name: str, callback: Callable[[bytes], None]) -> Subscription:
        """Return a subscription that gets a topic's messages in serialised form."""
        return self._subscribe(name, callback, raw=True)

    def _subscribe(
        self, name: str, callback: Callable[[Any], None], *, raw: bool = False
    ) -> Subscription:
        row = self.find_row(name)
        with reject_bad_overrides(self.get_name()):
            return self.create_subscription(
                find_message_type(row),
                name,
                callback,
                select_reader_profile(row, self.lockstep),
                raw=raw,
                qos_overriding_options=self._overrides,
            )

    def _build_input_receiver(
        self, inbox: Inbox, prefix: str, name: str, on_step: Callable[[InboxStep], None]
    ) -> Callable[[Any], None]:
        row, topic = self.table[name], prefix + name

        def receive_message(message: Any) -> None:
            self._received_at[topic] = time.monotonic()
            self.begun = True
            stamp_ns = from_stamp(message.header.stamp) if row.stamped else 0
            valid = self.soundness.validate(row, topic, message)
            inbox.put(name, stamp_ns, message, valid)
            self._run_complete_steps(inbox, on_step)

        return receive_message

    def subscribe_topic(self, name: str, callback: Callable[[Any], None]) -> Subscription:
        """Return a subscription outside the steps: the callback gets each message on arrival."""
        row = self.table[name]

        def receive_message(message: Any) -> None:
            self.soundness.validate(row, name, message)
            callback(message)

        return self._subscribe(name, receive_message)

    def _run_complete_steps(self, inbox: Inbox, on_step: Callable[[InboxStep], None]) -> None:
        """Run all steps whose inputs are complete."""
        while (step := inbox.pop()) is not None:
            on_step(step)
            self._waiting_since = time.monotonic()

    def list_missing_inputs(self) -> list[str]:
        """Return the inputs that this node waits for; a subclass may add its own."""
        if self.lockstep:
            # Before the first message the graph is still starting
            if not self.begun:
                return []
            if any(inbox.turns is None for inbox in self._inboxes.values()):
                return [DUE]
            return [
                prefix + name
                for prefix, inbox in self._inboxes.items()
                for name in inbox.list_missing_topics() or [inbox.trigger]
            ]
        # In real time an input is missing if it is overdue by more than REPORTED_WAIT
        now = time.monotonic()
        return [
            name
            for name, received in self._received_at.items()
            if now - received > REPORTED_WAIT + 1e-9 * self.find_row(name).period_ns
        ]

    def find_publishing_role(self, name: str) -> str:
        """Return the role that publishes a topic; `/lta2/vehicle` with the prefix of a robot."""
        prefix, own = self.split_prefix(name)
        return f'/{prefix}{self.table[own].source}' if prefix else self.table[own].source

    def _monitor_inputs(self) -> None:
        """Report inputs that are missing for too long, and publish health when due."""
        now = time.monotonic()
        missing = self.list_missing_inputs()
        if not missing:
            self._waiting_since = None
        elif self._waiting_since is None:
            self._waiting_since = now
        # `list_missing_inputs` has already allowed for REPORTED_WAIT in real time
        patience = REPORTED_WAIT if self.lockstep else 0.0
        if self._waiting_since is not None and now - self._waiting_since >= patience:
            suspects = sorted({self.find_publishing_role(name) for name in missing})
            self.health.report(
                'inputs',
                HealthLevel.ERROR,
                f'waiting for messages on {", ".join(sorted(missing))} from {", ".join(suspects)}',
                suspects=','.join(suspects),
            )
        elif self._received_at:
            self.health.report('inputs', HealthLevel.OK, 'all inputs arrive')
        lost = {
            prefix + name: gap
            for prefix, inbox in self._inboxes.items()
            for name, gap in inbox.gaps.items()
            if gap
        }
        if lost:
            self.health.report(
                'losses',
                HealthLevel.ERROR,
                'messages of these topics were lost between the nodes',
                **lost,
            )
        if (unsound := self.soundness.unsound).count:
            self.health.set_fact(unsound.build_fact(MESSAGES))
        self._warn_missing_inputs(now)
        self.update_health()
        if self._has_news() or now - self._reported >= REPORT_PERIOD:
            # Asking the middleware takes longer than all the rest
            self.health.report(
                LINKS_TASK,
                HealthLevel.OK,
                'number of subscribers of each topic',
                **self.count_readers(),
            )
            self._conflict.report(self.health)
            self.publish_health()

    def _warn_missing_inputs(self, now: float) -> None:
        """Log once which inputs nobody publishes, for a user who started this node alone."""
        if self._input_expected_by is None or now < self._input_expected_by:
            return
        self._input_expected_by = None
        # Who publishes is there, and only slow: a vehicle that compiles, a busy machine
        absent = [
            name
            for name in self._inputs
            if name not in self._received_at and not self.count_publishers(name)
        ]
        if absent:
            sources = sorted({self.find_publishing_role(name) for name in absent})
            self.get_logger().warning(
                f'waiting for messages on {", ".join(sorted(absent))} from {", ".join(sources)}; '
                'start the missing nodes'
            )

    def update_health(self) -> None:
        """Report what a node looks up, every `WATCH_PERIOD`; a subclass may override this."""

    def _has_news(self) -> bool:
        return any(health.changed for health in self._healths.values())

    def publish_health(self) -> None:
        """Publish all facts immediately, and log what has changed."""
        self._reported = time.monotonic()
        array = DiagnosticArray()
        array.header.stamp = to_stamp(self.graph_time_ns())
        for robot, health in self._healths.items():
            self._log_health(robot, health)
            health.changed = False
            # With the robot's name, as others tell robots apart by this alone
            node = f'{robot}/{self.get_name()}'.strip('/')
            array.status += [
                DiagnosticStatus(
                    # The level is a `byte`, which rclpy represents as a bytes object of length 1
                    level=bytes([fact.level]),
                    name=f'{node}: {fact.task}',
                    message=fact.message,
                    hardware_id=robot,
                    values=[KeyValue(key=key, value=value) for key, value in fact.values.items()],
                )
                for fact in health.facts
            ]
        self._diagnostics.publish(array)

    def _log_health(self, robot: str, health: Health) -> None:
        logger, prefix = self.get_logger(), '' if health is self.health else f'{robot}/'
        for level, text in self._logs[robot].update(health.take_news(), self._reported):
            # rclpy accepts one severity from each line of code
            if level == HealthLevel.OK:
                logger.info(prefix + text)
            elif level == HealthLevel.WARN:
                logger.warning(prefix + text)
            else:
                logger.error(prefix + text)

    def run(self) -> Iterator[None]:
        """
        Process inputs until `running` is False; a subclass may override this.

        The callbacks run for `POLL` between two steps of this generator.
        """
        self.health.report('state', HealthLevel.OK, 'running')
        while self.running:
            yield

    def close(self) -> None:
        """Report the last changes, and wait for acknowledgements; on every exit but SIGKILL."""
        if self._has_news():
            self.publish_health()
        deadline = time.monotonic() + self.farewell
        for publisher in self.publishers:
            # All publishers share one time limit
            left = max(0.0, deadline - time.monotonic())
            publisher.wait_for_all_acked(Duration(seconds=left))
