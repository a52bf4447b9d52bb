"""
Measure the graph: a whole flight, and the way of one message.

`graph.realtime` is a whole lockstep flight of seven processes, flight seconds a wall second; the
peer is the same with Fast DDS's own settings in place of `config/fastdds/`. `graph.one_process` is
that flight with all nodes in one process, and `graph.share` the processor time that this process
takes in real time, simulator and recorder included.
`spin.*` sends a message there and back between two processes, with the executor of our nodes and
with rclpy's usual one.
"""

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
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
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
    executor = EventsExecutor() if kind == 'events' else SingleThreadedExecutor()
    executor.add_node(node)
    while not done:
        executor.spin_once(0.02)
    executor.shutdown()


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


def figures() -> list[Figure]:
    """Return what is measured here."""
    median, unit = statistics.median, 'us'
    events, plain = partial(round_trip, 'events'), partial(round_trip, 'rclpy')
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
        Figure('spin.events', unit, events, 3, median),
        Figure('spin.rclpy', unit, plain, 3, median, 'spin.events', f'rclpy {version("rclpy")}'),
    ]


if __name__ == '__main__':
    if sys.argv[1] in ('flight', 'share'):
        measure = fly if sys.argv[1] == 'flight' else share
        sys.stdout.write(f'{measure(sys.argv[2])}\n')
    else:
        echo(sys.argv[1])
