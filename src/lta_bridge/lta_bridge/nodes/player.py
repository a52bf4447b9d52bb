"""
The player node: it replays a recording in the simulator's place.

It publishes a bag's sensor topics byte for byte, and the bag's time on `/clock`. In real time it
follows the wall clock at any rate. In lockstep it plays as fast as the nodes answer, and never
further ahead than their queues hold, so that no message is lost and a replay is reproducible. The
nodes' answers do not influence what is played.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
import json
import math
from pathlib import Path
import sys
import time
from typing import Unpack

from lta_bridge.bag.metadata import build_offered_qos, OfferedQos
from lta_bridge.parameters import check_playback, FOREVER, PlayerSettings
from lta_bridge.playback.answer_bag import AnswerBag
from lta_bridge.playback.answer_times import (
    compute_answer_times,
    compute_due_times,
    NEVER_NS,
    PendingAnswers,
)
from lta_bridge.playback.message_iterator import MessageIterator
from lta_bridge.playback.node_selection import CLOCK_TOPIC, select_nodes
from lta_bridge.playback.recording import open_recording
from lta_config.errors import BadInput
from lta_config.limits import limit_memory
from lta_graph.health import HealthLevel
from lta_graph.quality import select_quality
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode, LONG_ACKNOWLEDGE_TIME
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.peer_listener import OVER_VALUE
from lta_graph.ros.process import run_node
from lta_graph.ros.replay_due import from_due
from lta_graph.ros.stamps import to_stamp
from lta_graph.ros.startup import wait_until_complete
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rosgraph_msgs.msg import Clock as ClockMessage

LARGEST_LAG_NS = 1_000_000_000  # largest lag of a node in lockstep; queues hold 20 s
CLOCK_PERIOD = 0.02  # wall seconds between two /clock messages
PLAYER_TICK = 0.002  # wall seconds between two ticks in real time
MESSAGES_PER_TICK = 2000  # messages per tick at most, so that services are answered
LAST_ANSWER_TIME = 0.5  # wall seconds to wait for answers after the last message in real time


class Player(GraphNode):
    """Publish a recording, and receive the nodes' answers."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('player', role='vehicle', **options)
        settings = self._settings = NodeParameters(self, PlayerSettings).value
        check_playback(settings)
        own = self.get_namespace().strip('/')
        self._recording = open_recording(Path(settings.bag), settings.robot, self.table, own)
        self._selection = select_nodes(self.table, settings.nodes.split(), settings.roles.split())
        topics = [name for name in self._selection.played if name in self._recording.topics]
        end = math.inf if settings.end >= FOREVER else settings.end
        self._section = MessageIterator(self._recording, topics, settings.start, end)
        self._outputs = {name: self.create_output(name) for name in topics}
        self._clock_output = self.create_output(CLOCK_TOPIC)
        self._due = self.create_output('replay/due')
        self._pending = PendingAnswers(
            self._publish_due_times()
            if self.lockstep
            else dict.fromkeys(self._selection.answers, ())
        )
        for name in self._selection.answers:
            self.subscribe_raw(name, self._build_answer_receiver(name))
        self._answer_bag = self._open_answer_bag()
        self._messages = 0
        self._now = self._section.begin_ns
        self._began = self._clocked = self._news = 0.0
        self._ended = ''
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        # In lockstep the answers drive the replay; the timer only detects overdue ones
        self.create_timer(0.1 if self.lockstep else PLAYER_TICK, self._tick, clock=steady)

    def _publish_due_times(self) -> Mapping[str, Sequence[int]]:
        """Publish the due times of the nodes' inputs; return those of their answers. [ns]"""
        read = {name for node in self._selection.nodes for name in self.table.read_by(node)}
        # The trigger determines when a node answers, so its times are needed too
        topics = read | {self.table.trigger_topic(node) for node in self._selection.nodes}
        played = compute_due_times(
            (item for item in self._section.iterate_section() if item.topic in topics), self.table
        )
        answers = compute_answer_times(played, self.table, self._selection)
        inputs = {name: times.due for name, times in (played | answers).items() if name in read}
        self._due.publish(from_due(inputs))
        return {name: times.due for name, times in answers.items()}

    def _open_answer_bag(self) -> AnswerBag | None:
        if not self._settings.answers:
            return None

        def build_qos(name: str) -> list[OfferedQos]:
            depth, reliability, durability = select_quality(self.table[name], self.lockstep)
            return [build_offered_qos(reliability, durability, depth)]

        robot = self.get_namespace().strip('/')
        return AnswerBag(
            Path(self._settings.answers),
            self._recording,
            self._selection,
            self.table,
            robot,
            build_qos,
        )

    def run(self) -> Iterator[None]:
        """Wait for the graph, then play; exit with status 1 if the nodes do not answer."""
        yield from wait_until_complete(self, self._list_missing_nodes, self._settings.patience)
        self._began = self._news = time.monotonic()
        self.begun = True
        self._report_missing_topics()
        self._publish_due()
        yield from super().run()
        if self._ended == 'unanswered':
            late = ', '.join(
                f'{n} from {self.find_publishing_role(n)}'
                for n in self._pending.list_oldest_topics()
            )
            sys.stderr.write(
                'Playback stopped, because these messages of the nodes did not arrive within '
                f'{self._settings.patience:g} s: {late}.\n'
            )
            sys.exit(1)

    def _report_missing_topics(self) -> None:
        """Report topics that the recording lacks."""
        absent = self._selection.find_missing_topics(self.table, self._recording.topics)
        words = [*self._recording.strange]
        if absent:
            words.append(f'the recording lacks topics that the nodes need: {", ".join(absent)}')
        level = HealthLevel.WARN if words else HealthLevel.OK
        self.health.report('recording', level, '; '.join(words) or 'all topics found')

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
        if not self.lockstep or not self.begun or self._ended:
            return []
        return self._pending.list_oldest_topics()

    def _build_answer_receiver(self, name: str) -> Callable[[bytes], None]:
        def take(data: bytes) -> None:
            self._news = time.monotonic()
            due = self._pending.register_answer(name)
            if self._answer_bag is not None:
                self._answer_bag.write(name, data, due, self._now)
            if self.lockstep:
                self._publish_due()

        return take

    def _tick(self) -> None:
        """Publish due messages; in lockstep, end the replay if answers are overdue."""
        self._publish_due()
        if self._answer_bag is not None:
            self._answer_bag.flush()
            if self._answer_bag.fault and self.running:
                self.running = False
                self.health.report('recording', HealthLevel.ERROR, self._answer_bag.fault)
        waited = time.monotonic() - self._news
        if not self.begun or self._ended or not self.lockstep or waited < self._settings.patience:
            return
        self._ended, self.running = 'unanswered', False

    def _publish_due(self) -> None:
        """Publish the messages that are due now."""
        if not self.begun or self._ended:
            return
        # Neither ahead of the playback clock nor too far ahead of an unanswered input
        until = min(self._playback_time_ns(), self._pending.latest_play_time(LARGEST_LAG_NS))
        for _ in range(MESSAGES_PER_TICK):
            due = self._section.next_ns
            if due is None or due > until:
                break
            self._publish_next()
        self._publish_clock()
        # In real time the number of answers is unknown: wait until they cease
        late = not self.lockstep and time.monotonic() - self._news < LAST_ANSWER_TIME
        if self._section.next_ns is None and not self._pending.total_pending and not late:
            self._ended, self.running, self.farewell = 'played', False, LONG_ACKNOWLEDGE_TIME

    def _publish_next(self) -> None:
        """Publish the next message."""
        item = self._section.pop_message()
        # The recording may contain reordered messages, but /clock must not go back
        self._now = max(self._now, item.time_ns)
        self._outputs[item.topic].publish(item.data)
        self._messages += 1
        self._news = time.monotonic() if not self.lockstep else self._news

    def _publish_clock(self) -> None:
        """Publish the bag's time once per `CLOCK_PERIOD`."""
        wall = time.monotonic()
        if wall - self._clocked >= CLOCK_PERIOD:
            self._clocked = wall
            self._clock_output.publish(ClockMessage(clock=to_stamp(self.graph_time_ns())))

    def graph_time_ns(self) -> int:
        """Return the time of the bag, which is that of the graph. [ns]"""
        if self.lockstep:
            return self._now
        return max(self._now, self._playback_time_ns())

    def _playback_time_ns(self) -> int:
        """Return the time of the bag up to which to play, apart from the answers. [ns]"""
        if self.lockstep:
            return NEVER_NS
        passed = time.monotonic() - self._began if self.begun else 0.0
        return self._section.begin_ns + round(self._settings.rate * 1e9 * passed)

    def _format_position(self) -> str:
        """Return the position of the player as text."""
        return f'playing at {(self._now - self._section.begin_ns) * 1e-9:.3f} s'

    def _collect_progress(self) -> dict[str, str]:
        """Return the progress of the replay in figures."""
        elapsed = (self._now - self._section.begin_ns) * 1e-9
        wall = time.monotonic() - self._began if self._began else 0.0
        return {
            'outcome': self._ended or ('stopped' if not self.running else 'playing'),
            'time_s': f'{elapsed:.3f}',
            'messages': str(self._messages),
            'answers': str(sum(self._pending.come.values())),
            'owed': str(self._pending.total),
            'unanswered': str(self._pending.total_pending),
            'pace': f'{elapsed / wall:.2f}' if wall else '0.00',
        }

    def _monitor_inputs(self) -> None:
        """Report the progress of the replay."""
        over = {OVER_VALUE: self._ended == 'played'}
        self.health.report(
            'playback', HealthLevel.OK, self._format_position(), **self._collect_progress(), **over
        )
        super()._monitor_inputs()

    def close(self) -> None:
        """Print the outcome, finish the bag of answers, and send the last messages."""
        self.health.changed = True  # others wait for the end
        self._monitor_inputs()
        if self._answer_bag is not None:
            self._answer_bag.close()
        sys.stdout.write(json.dumps(self._collect_progress()) + '\n')
        sys.stdout.flush()
        super().close()
        if self._answer_bag is not None and self._answer_bag.fault:
            raise BadInput(self._answer_bag.fault)


def main(args: list[str] | None = None) -> None:
    """Run the node until the recording ends or it is stopped."""
    with limit_memory():
        run_node(Player, args)
