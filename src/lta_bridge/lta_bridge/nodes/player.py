# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The player node: it replays a recording in the simulator's place.

It publishes a bag's sensor topics byte for byte, and the bag's time on `/clock`. In real time it
follows the wall clock at any rate. In lockstep it plays as fast as the nodes answer, and never
further ahead than their queues hold, so that no message is lost and a replay is reproducible. The
nodes' answers do not influence what is played.
"""

from collections.abc import Callable, Iterator
import json
import math
from pathlib import Path
import sys
import time
from typing import Unpack

from lta_bridge.parameters import check_playback, FOREVER, PlayerSettings
from lta_bridge.playback.answer_bag import AnswerBag
from lta_bridge.playback.answer_times import compute_schedule, PendingAnswers
from lta_bridge.playback.message_iterator import MessageIterator, Playback
from lta_bridge.playback.node_selection import CLOCK_TOPIC, select_nodes
from lta_bridge.playback.recording import open_recording
from lta_config.errors import BadInput
from lta_config.limits import limit_memory
from lta_graph.health import HealthLevel
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode, LONG_ACKNOWLEDGE_TIME
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.replay_due import from_due
from lta_graph.ros.stamps import to_stamp
from lta_graph.ros.startup import wait_until_complete
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rosgraph_msgs.msg import Clock as ClockMessage

CLOCK_PERIOD = 0.02  # wall seconds between two /clock messages
PLAYER_TICK = 0.002  # wall seconds between two ticks in real time


class Player(GraphNode):
    """Publish a recording, and receive the nodes' answers."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('player', role='vehicle', **options)
        settings = self._settings = NodeParameters(self, PlayerSettings).value
        check_playback(settings)
        own = self.get_namespace().strip('/')
        self._recording = open_recording(Path(settings.bag), settings.robot, self.table, own)
        selection = self._selection = select_nodes(
            self.table, settings.nodes.split(), settings.roles.split()
        )
        topics = [name for name in selection.played if name in self._recording.topics]
        end = math.inf if settings.end >= FOREVER else settings.end
        section = MessageIterator(self._recording, topics, settings.start, end)
        self._outputs = {name: self.create_output(name) for name in topics}
        self._clock_output = self.create_output(CLOCK_TOPIC)
        self._due = self.create_output('replay/due')
        answers: dict[str, list[int]] = {name: [] for name in selection.answers}
        if self.lockstep:
            inputs, answers = compute_schedule(section.iterate_section(), self.table, selection)
            self._due.publish(from_due(inputs))
        rate = None if self.lockstep else settings.rate
        self._playback = Playback(section, PendingAnswers(answers), rate)
        for name in selection.answers:
            self.subscribe_raw(name, self._build_answer_receiver(name))
        path = Path(settings.answers) if settings.answers else None
        self._answer_bag = AnswerBag(
            path, self._recording, selection, self.table, own, self.lockstep
        )
        self._clocked = 0.0
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        # In lockstep the answers drive the replay; the timer only detects overdue ones
        self.create_timer(0.1 if self.lockstep else PLAYER_TICK, self._tick, clock=steady)

    def run(self) -> Iterator[None]:
        """Wait for the graph, then play; exit with status 1 if the nodes do not answer."""
        yield from wait_until_complete(self, self._list_missing_nodes, self._settings.patience)
        self._playback.begin()
        self.begun = True
        self.health.set_fact(self._selection.describe_recording(self.table, self._recording))
        self._publish_due()
        yield from super().run()
        if self._playback.ended == 'unanswered':
            missing = self._playback.pending.list_oldest_topics()
            late = ', '.join(f'{n} from {self.find_publishing_role(n)}' for n in missing)
            sys.stderr.write(
                'Playback stopped, because these messages of the nodes did not arrive within '
                f'{self._settings.patience:g} s: {late}.\n'
            )
            sys.exit(1)

    def _list_missing_nodes(self) -> list[str]:
        """Return the nodes that are not connected yet."""
        waiting: set[str] = set()
        for name, publisher in self._outputs.items():
            readers = set(self.table[name].subscribers) & set(self._selection.nodes)
            if self._settings.record and self.table[name].recorded:
                readers.add('recorder')
            if publisher.get_subscription_count() < len(readers):
                waiting |= readers
        waiting |= {
            self.find_publishing_role(n)
            for n in self._selection.answers
            if not self.count_publishers(n)
        }
        if self.lockstep and self._settings.record:  # it needs the due times of unstamped topics
            readers_of_due = self.get_subscriptions_info_by_topic(self._due.topic_name)
            waiting |= {'recorder'} - {each.node_name for each in readers_of_due}
        return sorted(waiting)

    def list_missing_inputs(self) -> list[str]:
        """Return the answers that the player waits for."""
        if not self.lockstep or not self._playback.is_running:
            return []
        return self._playback.pending.list_oldest_topics()

    def _build_answer_receiver(self, name: str) -> Callable[[bytes], None]:
        def take(data: bytes) -> None:
            due = self._playback.receive_answer(name)
            self._answer_bag.write(name, data, due, self._playback.now_ns)
            if self.lockstep:
                self._publish_due()

        return take

    def _tick(self) -> None:
        """Publish due messages; in lockstep, end the replay if answers are overdue."""
        self._publish_due()
        self._answer_bag.flush()
        if self._answer_bag.fault and self.running:
            self.running = False
            self.health.report('recording', HealthLevel.ERROR, self._answer_bag.fault)
        self._playback.end_unanswered(self._settings.patience)
        self.running = self.running and not self._playback.ended

    def _publish_due(self) -> None:
        """Publish the messages and the bag's time that are due now."""
        if not self._playback.is_running:
            return
        for item in self._playback.iterate_due():
            self._outputs[item.topic].publish(item.data)
        wall = time.monotonic()
        if wall - self._clocked >= CLOCK_PERIOD:
            self._clocked = wall
            self._clock_output.publish(ClockMessage(clock=to_stamp(self.graph_time_ns())))
        if self._playback.ended == 'played':
            self.running, self.farewell = False, LONG_ACKNOWLEDGE_TIME

    def graph_time_ns(self) -> int:
        """Return the time of the bag, which is that of the graph [ns]."""
        return self._playback.bag_time_ns()

    def _monitor_inputs(self) -> None:
        """Report the progress of the replay."""
        figures = self._playback.summarize(self.running)
        text = f'playing at {figures["time_s"]} s'
        self.health.report('playback', HealthLevel.OK, text, **figures)
        super()._monitor_inputs()

    def close(self) -> None:
        """Print the outcome, finish the bag of answers, and send the last messages."""
        self.health.changed = True  # others wait for the end
        self._monitor_inputs()
        self._answer_bag.close()
        sys.stdout.write(json.dumps(self._playback.summarize(self.running)) + '\n')
        sys.stdout.flush()
        super().close()
        if self._answer_bag.fault:
            raise BadInput(self._answer_bag.fault)


def main(args: list[str] | None = None) -> None:
    """Run the node until the recording ends or it is stopped."""
    with limit_memory():
        run_node(Player, args)
