# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The recorder node: it writes the topic table's recorded topics, given topics or all to a bag.

Messages older than a second survive even SIGKILL. A separate thread writes the disk, so that a
slow disk does not fill the middleware's queues. When the disk is nearly full, the bag is closed
while its index still fits, and the process ends with an error message and status 2.
"""

from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
import time
from typing import Unpack

from lta_bag.background_writer import BackgroundWriter
from lta_bag.provenance import merge_provenance
from lta_bag.storage import StorageFault
from lta_bag.writer import BagWriter
from lta_bridge.crazyflie.safety import LEAVE
from lta_bridge.intake import MessageIntake
from lta_bridge.messages import RecordedTopics
from lta_bridge.parameters import RecorderSettings, RobotOrigin
from lta_bridge.playback.answer_bag import build_replay_origin
from lta_bridge.playback.recording import open_recording
from lta_config.errors import BadInput
from lta_config.limits import limit_memory
from lta_config.topics import ALL_TOPICS, select_topics
from lta_graph.health import HealthLevel
from lta_graph.interrupts import hold_interrupts
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import declare_robots, NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.replay_due import subscribe_due_times
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

LOOK_PERIOD = 0.4  # wall seconds between two checks of the graph and of losses
DISK_PERIOD = 0.1  # wall seconds between two checks of the disk
SILENT_POLLS = 15  # polls in a row without a message after which the graph counts as silent: 0.3 s
LINGER = 3.0  # wall seconds to wait for that silence at most
DISK = 'disk'  # diagnostics task for a slow disk
# Wall seconds of one write that count as slow; a fault must be reported within 1 s
SLOW_WRITE = 0.3
MB = 1_000_000


class Recorder(GraphNode):
    """Write raw messages to a bag."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('recorder', **options)
        settings = self._settings = NodeParameters(self, RecorderSettings).value
        origin = self._collect_origin()
        robots = self._robots = settings.robots.split() or [self.get_namespace().strip('/')]
        topics = select_topics(settings.topics, robots, self.table)
        self._fault = ''
        with ExitStack() as unfinished:
            with hold_interrupts():  # Ctrl-C must not leave a bag half created
                try:
                    self._writer = self._open_writer(Path(settings.bag), origin)
                except StorageFault as fault:
                    raise BadInput(str(fault)) from None
                unfinished.callback(self._writer.close)  # if the constructor fails
            whole = self.lockstep and not self.replayed  # a replayed bag may begin anywhere
            self._real = self.get_parameter('source').value == 'crazyflie'
            begun_ns = self.graph_time_ns() if self._real else None
            self._intake = MessageIntake(self.table, whole, robots, self._writer, begun_ns)
            if self.replayed:  # created first, so that it is matched first
                subscribe_due_times(
                    self, self.table, partial(self._intake.set_due_times, robots[0])
                )
            everything = settings.topics.split() == [ALL_TOPICS]
            self._topics = RecordedTopics(self, topics, everything, self._intake, self._writer)
            # Graph time may stop or run faster, but disk and graph follow the wall clock
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self.create_timer(LOOK_PERIOD, self._report_recording, clock=steady)
            self.create_timer(DISK_PERIOD, self._report_disk, clock=steady)
            # The constructor succeeded: close() now closes the writer
            unfinished.pop_all()

    def _collect_origin(self) -> dict[str, str]:
        """Return the origin of the data: the launch, or the replayed bag."""
        settings, lockstep = self._settings, self.lockstep
        each = {
            name: item.to_provenance(lockstep=lockstep)
            for name, item in declare_robots(self, settings.robots, RobotOrigin).items()
        }
        origin = merge_provenance(each) if each else settings.to_provenance(lockstep=lockstep)
        if settings.replay and self.get_parameter('source').value == 'replay':
            own = self.get_namespace().strip('/')
            # A damaged bag may declare huge sizes
            with limit_memory():
                played = open_recording(Path(settings.replay), '', self.table, own)
            return build_replay_origin(played, origin)
        return origin

    def _open_writer(self, path: Path, origin: dict[str, str]) -> BackgroundWriter:
        """Create the bag."""
        return BackgroundWriter(BagWriter(path, origin), int(self._settings.queue_size * MB))

    def _report_recording(self) -> None:
        """Check the graph and the writer, and report the state of the recording."""
        for fact in self._topics.poll():
            self.health.set_fact(fact)
        if not self._fault:
            level, words, figures = self._intake.summarize_recording(self._topics.lost_counts)
            self.health.report('recording', level, words, **figures)

    def _report_disk(self) -> None:
        """Report a slow or failed disk, soon enough to name a fault within a second."""
        busy = self._writer.busy_time
        if busy > SLOW_WRITE:
            words = (
                f'the disk is slow: it has been writing for {busy:.1f} s, and messages are queued'
            )
            self.health.report(DISK, HealthLevel.ERROR, words)
        elif DISK in self.health:
            self.health.report(DISK, HealthLevel.OK, 'the disk keeps up with the messages')
        if self._writer.fault is not None and not self._fault:
            self._fault = str(self._writer.fault)
            self.health.report('recording', HealthLevel.ERROR, self._fault)
            self.running = False

    def run(self) -> Iterator[None]:
        """Record until stopped, then until no more messages arrive."""
        yield from super().run()
        landed = time.monotonic() + LEAVE
        while self._has_flight_bridge() and time.monotonic() < landed:
            yield
        if not self._fault:
            yield from self._take_late_messages()

    def _take_late_messages(self) -> Iterator[None]:
        """Take what the other nodes still send, until none arrives."""
        # The last report of its own that the bag holds; a later one would break the silence
        self._report_recording()
        self.publish_health()
        for timer in self.timers:
            timer.cancel()
        deadline = time.monotonic() + LINGER
        latest, silent_polls = self._intake.latest, 0
        # Counts polls, not seconds: a busy machine may suspend this process for longer than that
        while silent_polls <= SILENT_POLLS and time.monotonic() < deadline:
            yield
            silent_polls = silent_polls + 1 if self._intake.latest == latest else 0
            latest = self._intake.latest

    def _has_flight_bridge(self) -> bool:
        """Return whether the bridge of a real drone still runs; it lands before it exits."""
        # An empty robot name gives '//imu'
        own = (f'/{robot}/imu'.replace('//', '/') for robot in self._robots)
        return self._real and not self.hurried and any(map(self.count_publishers, own))

    def close(self) -> None:
        """Finish the bag; raise if the recording ended early."""
        self._intake.write_early_messages()
        self._topics.announce_silent()
        try:
            self._writer.close()
        except StorageFault as fault:
            self._fault = str(fault)
        if self._fault:
            self.health.report(
                'recording', HealthLevel.ERROR, self._fault, unwritten=self._writer.lost_count
            )
        self.publish_health()
        super().close()
        if self._fault:
            raise BadInput(self._fault)


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(Recorder, args)
