"""
Measure the recorder: what it costs, beside a bare loop that receives the same messages.

`recorder.realtime` is its share of a core in a flight at the pace of the wall clock, all topics
recorded. For the others a flight is played ten times as fast to a recorder and to a loop of
rclpy's own that does nothing with the raw bytes, both at once, each in a process of its own;
`recorder.message` is what one message costs the recorder. A run that loses a message fails.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from importlib.metadata import version
import os
from pathlib import Path
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

from bench import Figure
from graph import Silent
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.reader import read_bag
from lta_flight.flight import FlightRequest, fly_once
from lta_flight.flight_run import ROBOT
from lta_flight.simulate import simulate_once, SimulationRequest
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

TABLE = load_topic_table()
FAST = 10  # times real time
TICK = os.sysconf('SC_CLK_TCK')
RECORDER = 'from lta_bridge.nodes.recorder import main; main()'
PATIENCE = 30.0  # wall seconds


def stat(pid: int) -> list[str]:
    """Return what the kernel tells of a process, from its state on."""
    return Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()


def cpu(pid: int) -> float:
    """Return the time that a process has spent in itself and in the kernel. [s]"""
    fields = stat(pid)
    return (int(fields[11]) + int(fields[12])) / TICK


def named(node: str) -> int | None:
    """Return our process that is a node, None where there is none."""
    for folder in Path('/proc').glob('[0-9]*'):
        try:
            line = (folder / 'cmdline').read_bytes()
            ours = int(stat(int(folder.name))[1]) == os.getpid()
            if ours and f'__node:={node}'.encode() in line:
                return int(folder.name)
        except OSError:
            continue
    return None


class Meter(threading.Thread):
    """Follows what the recorder of a flight spends, while the flight goes on."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.over = threading.Event()
        self.samples: list[tuple[float, float]] = []

    def run(self) -> None:
        """Take samples until told to stop, without the first seconds of start-up."""
        pid = None
        while not self.over.wait(0.5):
            pid = pid or named('recorder')
            try:
                if pid:
                    self.samples.append((time.monotonic(), cpu(pid)))
            except OSError:
                return

    @property
    def share(self) -> float:
        """Share of a core from the sixth second on. [%]"""
        kept = [each for each in self.samples if each[0] > self.samples[0][0] + 6.0]
        (begun, before), (ended, after) = kept[0], kept[-1]
        return 100.0 * (after - before) / (ended - begun)


def realtime() -> float:
    """Return what a recorder takes of a core in a flight in real time. [%]"""
    meter = Meter()
    meter.start()
    with tempfile.TemporaryDirectory() as folder:
        order = FlightRequest('gtmab', 'lamp_room', 'bag', 1, 'realtime', Path(folder) / 'flight')
        fly_once(order, Silent())
    meter.over.set()
    return meter.share


def wired(node: Node, make: Callable[..., object]) -> dict[str, object]:
    """Return what a function makes of each topic of a flight in one process."""
    rows = {name: row for name, row in TABLE.topics.items() if row.repeatable}
    return {
        topic: make(find_message_type(row), topic, select_profile(row, lockstep=True))
        for topic, row in ((robot_topic(ROBOT, name), row) for name, row in rows.items())
    }


def play(bag: Path) -> None:
    """Publish a bag at its log times, ten times as fast, once two listen to each topic."""
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node('player')
    outputs = wired(node, node.create_publisher)
    messages = list(read_bag(bag).iterate_messages(list(outputs)))
    while any(output.get_subscription_count() < 2 for output in outputs.values()):
        time.sleep(0.05)
    sys.stdout.write('ready\n')
    sys.stdout.flush()
    sys.stdin.readline()
    begun, first = time.monotonic(), messages[0][1]
    for topic, when, data in messages:
        left = begun + (when - first) * 1e-9 / FAST - time.monotonic()
        if left > 1e-3:
            time.sleep(left)
        outputs[topic].publish(data)
    sys.stdout.write(f'{time.monotonic() - begun}\n')
    sys.stdout.flush()
    signal.sigwait([signal.SIGINT])  # what was latched is there until both have it


def take() -> None:
    """Receive as rclpy's manual has it, and do nothing; print how many came."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node('taker')
    came = [0]

    def count(_: bytes) -> None:
        came[0] += 1

    wired(node, lambda kind, name, qos: node.create_subscription(kind, name, count, qos, raw=True))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    going = [True]
    signal.signal(signal.SIGINT, lambda *_: going.clear())
    while going:
        executor.spin_once(0.1)
    sys.stdout.write(f'{came[0]}\n')


@contextmanager
def process(*words: object) -> Iterator['subprocess.Popen[str]']:
    """Run Python, and end it with Ctrl-C."""
    with subprocess.Popen(
        [sys.executable, *map(str, words)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as child:
        try:
            yield child
        finally:
            child.send_signal(signal.SIGINT)


def played() -> dict[str, float]:
    """Play a flight to both, and return what each took."""
    with tempfile.TemporaryDirectory() as folder:
        order = SimulationRequest(
            'gtmab', 'lamp_room', 'bag', 'gtmab', 1, out=Path(folder) / 'flight'
        )
        flown, _ = simulate_once(order, Silent())
        sent_topics = read_bag(flown.bag).topics
        sent = sum(topic.count for topic in sent_topics.values())
        to = Path(folder) / 'recorded'
        options = ('--ros-args', '-r', '__ns:=/lta1', '-p', f'bag:={to}', '-p', 'time:=lockstep')
        with (
            process('-c', RECORDER, *options) as recorder,
            process(__file__, 'take') as taker,
            process(__file__, 'play', flown.bag) as player,
        ):
            player.stdout.readline()
            before = cpu(recorder.pid), cpu(taker.pid)
            player.stdin.write('go\n')
            player.stdin.flush()
            lasted = float(player.stdout.readline())
            time.sleep(1.0)
            after = cpu(recorder.pid), cpu(taker.pid)
            taker.send_signal(signal.SIGINT)
            came = int(taker.stdout.readline())
            recorder.send_signal(signal.SIGINT)
            recorder.wait(PATIENCE)
        kept = read_bag(to)
        # The recorder adds diagnostics of its own
        got = sum(topic.count for name, topic in kept.topics.items() if name in sent_topics)
        if (got, came) != (sent, sent):
            raise RuntimeError(f'of {sent} messages {got} were recorded and {came} received')
    ours, bare = after[0] - before[0], after[1] - before[1]
    return {
        'message': 1e6 * ours / sent,
        'raw': 1e6 * bare / sent,
        'share': 100.0 * ours / lasted,
        'rate': sent / lasted,
    }


class Runs:
    """Runs that several figures are read from: the first that asks for a turn makes it."""

    def __init__(self) -> None:
        self._made: list[dict[str, float]] = []
        self._asked: dict[str, int] = {}

    def read(self, name: str) -> float:
        """Return a figure of the next run that it has not been asked for yet."""
        turn = self._asked.get(name, 0)
        self._asked[name] = turn + 1
        if turn == len(self._made):
            self._made.append(played())
        return self._made[turn][name]


def figures() -> list[Figure]:
    """Return what is measured here."""
    median, runs = statistics.median, Runs()
    return [
        Figure('recorder.realtime', '% of a core', realtime, 1, median),
        Figure('recorder.10x', '% of a core', partial(runs.read, 'share'), 3, median),
        Figure('recorder.message', 'us', partial(runs.read, 'message'), 3, median),
        Figure(
            'recorder.raw', 'us', partial(runs.read, 'raw'), 3, median, 'recorder.message',
            f'rclpy {version("rclpy")}',
        ),
    ]  # fmt: skip


if __name__ == '__main__':
    {'play': lambda: play(Path(sys.argv[2])), 'take': take}[sys.argv[1]]()
