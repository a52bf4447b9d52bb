"""
Measure the graph: `python test/benchmark/graph.py` prints name, value and unit.

`graph.realtime` is a whole lockstep flight of seven processes, flight seconds a wall second.
`spin.*` sends a message there and back between two processes, with our spin and with rclpy's own
executor, turn about: the ratio is what the lean spin brings.
"""

import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

from lta_analysis.flight import fly_once, Order
from lta_graph.ros.spin import spin
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Imu

ROUNDS = 3000


class Silent:
    """Nobody watches."""

    def at(self, time: float, distance: float, pace: float) -> None:
        """Ignore where the drone is."""

    def say(self, sentence: str) -> None:
        """Pass on what happened."""
        sys.stderr.write(sentence + '\n')


def flight() -> float:
    """Return the pace of one flight. [s/s]"""
    with tempfile.TemporaryDirectory() as folder:
        order = Order('gtmab', 'lamp_room', 'bag', 1, 'lockstep', Path(folder) / 'flight')
        return fly_once(order, Silent()).pace


def turn(kind: str, node: Node, done: list[float]) -> None:
    """Run a node with one of the two executors until its work is done."""
    if kind == 'lean':
        spin(node, lambda: not done, lambda: node.subscriptions, 20_000_000)
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
    done: list[float] = []

    def answer(message: Imu) -> None:
        if message.header.stamp.sec < 0:
            done.append(0.0)
        else:
            out.publish(message)

    node.create_subscription(Imu, 'there', answer, 10)
    turn(kind, node, done)


def round_trip(kind: str) -> float:
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

        back = node.create_subscription(Imu, 'back', again, 10)
        while out.get_subscription_count() == 0 or node.count_publishers(back.topic) == 0:
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


def main() -> None:
    """Print the table."""
    paces = [flight() for _ in range(3)]
    rclpy.init()
    pairs = [(round_trip('lean'), round_trip('rclpy')) for _ in range(3)]
    rclpy.shutdown()
    lean, plain = (sorted(column)[1] for column in zip(*pairs, strict=True))
    rows = (
        ('graph.realtime', sorted(paces)[1], 's/s'),
        ('spin.lean', lean, 'us'),
        ('spin.rclpy', plain, 'us'),
        ('spin.ratio', plain / lean, '1'),
    )
    for name, value, unit in rows:
        sys.stdout.write(f'{name:<20} {value:12.4g} {unit}\n')


if __name__ == '__main__':
    if len(sys.argv) > 1:
        echo(sys.argv[1])
    else:
        main()
