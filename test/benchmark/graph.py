"""
Measure the graph: a whole flight, and the way of one message.

`graph.realtime` is a whole lockstep flight of seven processes, flight seconds a wall second; the
peer is the same with Fast DDS's own settings in place of `config/fastdds/`. `graph.one_process` is
that flight with all nodes in one process, and `graph.share` the processor time that this process
takes in real time, simulator and recorder included.
`spin.*` sends a message there and back between two processes, with our spin and with rclpy's own
executor. `message.*` encodes and decodes an Odometry, the peer by rclpy.
"""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib.metadata import version
from operator import itemgetter
import os
from pathlib import Path
import statistics
import subprocess
import sys
import tempfile
import time
from typing import Any

from bench import Figure
from lta_flight.flight import FlightRequest, fly_once
from lta_graph.cdr_encoder import encode_cdr
from lta_graph.ros.cdr_decoder import decode_cdr
from lta_graph.ros.spin import spin_node
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Imu
from start import as_it_comes, PLAIN

ROUNDS = 3000


class Silent:
    """
    Nobody watches.

    Attribute `spent`: wall time and processor time of the nodes while the drone flies. [s]
    """

    def __init__(self) -> None:
        self.spent: list[tuple[float, float]] = []

    def show_position(self, time_s: float, distance: float, pace: float) -> None:
        """Keep how much processor time the nodes have had, once a second."""
        now = time.monotonic()
        if not self.spent or now - self.spent[-1][0] > 1.0:
            self.spent.append((now, measure_running_children()))

    def show_message(self, sentence: str) -> None:
        """Pass on what happened."""
        sys.stderr.write(sentence + '\n')

    def wait_for(self, what: str) -> None:
        """Ignore what takes long."""


def measure_running_children() -> float:
    """Return the processor time of the running children of this process. [s]"""
    ticks = 0
    for file in Path('/proc').glob('[0-9]*/stat'):
        with suppress(OSError):  # it has ended
            fields = file.read_text().rpartition(') ')[2].split()
            if int(fields[1]) == os.getpid():
                ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf('SC_CLK_TCK')


def flight(environment: dict[str, str], processes: str = 'many', what: str = 'flight') -> float:
    """Return the pace of one flight in a process of its own, or its `share`. [s/s]"""
    command = [sys.executable, __file__, what, processes]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return float(done.stdout)


def fly(processes: Any) -> float:
    """Return the pace of one flight. [s/s]"""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / 'flight'
        order = FlightRequest('gtmab', 'lamp_room', 'bag', 1, 'lockstep', out, None, processes)
        return fly_once(order, Silent()).pace


def share(processes: Any) -> float:
    """Return the processor time of the nodes in a flight in real time, a wall second. [s/s]"""
    watcher = Silent()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / 'flight'
        order = FlightRequest('gtmab', 'lamp_room', 'bag', 1, 'realtime', out, None, processes)
        fly_once(order, watcher)
    # Nodes load before they fly, and those that have ended are no children any more
    (begun, before), (ended, after) = watcher.spent[0], max(watcher.spent, key=itemgetter(1))
    return (after - before) / (ended - begun)


def turn(kind: str, node: Node, done: list[float]) -> None:
    """Run a node with one of the two executors until its work is done."""
    if kind == 'lean':
        spin_node(node, lambda: not done, lambda: node.subscriptions, 20_000_000)
        return
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while not done:
        executor.spin_once(0.02)


def echo(kind: str) -> None:
    """Send everything back; the other end of `round_trip`."""
    rclpy.init()
    node = Node('echo')
    out = node.create_publisher(Imu, 'back', 10)
    # Whoever finds this end is found by it: the first answer is not lost.
    while out.get_subscription_count() == 0:
        time.sleep(0.01)
    done: list[float] = []

    def answer(message: Imu) -> None:
        if message.header.stamp.sec < 0:
            done.append(0.0)
        else:
            out.publish(message)

    node.create_subscription(Imu, 'there', answer, 10)
    turn(kind, node, done)


def asked(kind: str) -> float:
    """Return the mean time there and back. [us]"""
    command = [sys.executable, __file__, kind]
    with subprocess.Popen(command, env=os.environ) as other:
        node = Node('asker')
        out = node.create_publisher(Imu, 'there', 10)
        done: list[float] = []
        count = 0
        begin = 0.0

        def again(_: Imu) -> None:
            nonlocal count
            count += 1
            if count == ROUNDS:
                done.append((time.perf_counter() - begin) / ROUNDS * 1e6)
            else:
                out.publish(Imu())

        node.create_subscription(Imu, 'back', again, 10)
        while out.get_subscription_count() == 0:
            time.sleep(0.01)
        begin = time.perf_counter()
        out.publish(Imu())
        turn(kind, node, done)
        stop = Imu()
        stop.header.stamp.sec = -1
        out.publish(stop)
        other.wait()
        node.destroy_node()
    return done[0]


def round_trip(kind: str) -> float:
    """Return the mean time there and back, in a context of its own. [us]"""
    rclpy.init()
    try:
        return asked(kind)
    finally:
        rclpy.shutdown()


def call(function: Callable[..., Any], *arguments: Any) -> float:
    """Return the mean time of a call. [us]"""
    begin = time.process_time()
    for _ in range(ROUNDS):
        function(*arguments)
    return (time.process_time() - begin) / ROUNDS * 1e6


def list_message_figures() -> list[Figure]:
    """Return how long a message takes to be encoded and decoded."""
    message = Odometry(child_frame_id='base_link')
    message.header.frame_id = 'odom'
    data, peer = encode_cdr(message), f'rclpy {version("rclpy")}'
    rows = (
        ('message.encoded', '', partial(call, encode_cdr, message)),
        ('message.encoded_rclpy', 'message.encoded', partial(call, serialize_message, message)),
        ('message.decoded', '', partial(call, decode_cdr, data, Odometry)),
        (
            'message.decoded_rclpy',
            'message.decoded',
            partial(call, deserialize_message, data, Odometry),
        ),
    )
    return [
        Figure(name, 'us', measure, choose=min, of=of, peer=peer if of else '')
        for name, of, measure in rows
    ]


def figures() -> list[Figure]:
    """Return what is measured here."""
    median, unit = statistics.median, 'us'
    lean, plain = partial(round_trip, 'lean'), partial(round_trip, 'rclpy')
    return [
        Figure('graph.realtime', 's/s', partial(flight, dict(os.environ)), 5, median),
        Figure(
            'graph.defaults',
            's/s',
            partial(flight, as_it_comes()),
            5,
            median,
            'graph.realtime',
            PLAIN,
        ),
        Figure('graph.one_process', 's/s', partial(flight, dict(os.environ), 'one'), 5, median),
        Figure(
            'graph.share',
            's/s',
            partial(flight, dict(os.environ), 'one', 'share'),
            2,
            min,
        ),
        Figure('spin.lean', unit, lean, 3, median),
        Figure('spin.rclpy', unit, plain, 3, median, 'spin.lean', f'rclpy {version("rclpy")}'),
        *list_message_figures(),
    ]


if __name__ == '__main__':
    if sys.argv[1] in ('flight', 'share'):
        measure = fly if sys.argv[1] == 'flight' else share
        sys.stdout.write(f'{measure(sys.argv[2])}\n')
    else:
        echo(sys.argv[1])
