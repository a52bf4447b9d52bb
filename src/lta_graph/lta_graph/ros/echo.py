# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Exchange messages over DDS: the two processes by which `lta doctor` checks that nodes can talk.

`python -m lta_graph.ros.echo answer` echoes what it receives. `... ask` sends until the first
echo arrives, then times round trips and prints one line of JSON. Both exit by themselves.
"""

import argparse
import json
import statistics
import sys
import time

from lta_config.errors import BadInput
from lta_graph.ros.command_line import initialize_ros
from lta_graph.terminal_streams import guard_streams
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import try_shutdown
from std_msgs.msg import String

QUESTION_TOPIC = 'lta_doctor/question'
ANSWER_TOPIC = 'lta_doctor/answer'
ROUND_TRIPS = 20  # for the median; the first are slow while caches are cold
QUESTION_PERIOD = 0.05  # s between questions until the first answer


def echo_messages(node: Node, executor: SingleThreadedExecutor, deadline: float) -> None:
    """Echo every message until 'end' arrives or the monotonic clock reaches `deadline` [s]."""
    questions: list[str] = []
    publisher = node.create_publisher(String, ANSWER_TOPIC, 10)

    def on_question(message: String) -> None:
        questions.append(message.data)
        publisher.publish(message)

    node.create_subscription(String, QUESTION_TOPIC, on_question, 10)
    while time.monotonic() < deadline and questions[-1:] != ['end']:
        executor.spin_once(timeout_sec=0.1)


def measure_round_trip(
    node: Node, executor: SingleThreadedExecutor, deadline: float
) -> dict[str, float] | None:
    """Return the discovery time and median round trip [s], or None at the deadline."""
    answers: set[str] = set()
    publisher = node.create_publisher(String, QUESTION_TOPIC, 10)

    def on_answer(message: String) -> None:
        answers.add(message.data)

    node.create_subscription(String, ANSWER_TOPIC, on_answer, 10)

    def round_trip(text: str, patience: float) -> float | None:
        sent = time.perf_counter()
        publisher.publish(String(data=text))
        until = min(deadline, time.monotonic() + patience)
        while text not in answers:
            if time.monotonic() >= until:
                return None
            executor.spin_once(timeout_sec=patience)
        return time.perf_counter() - sent

    began = time.monotonic()
    # A message sent before the endpoints have matched is lost, so repeat it
    while round_trip('begin', QUESTION_PERIOD) is None:
        if time.monotonic() >= deadline:
            return None
    discovery_time = time.monotonic() - began
    trips = [round_trip(str(count), 1.0) for count in range(ROUND_TRIPS)]
    publisher.publish(String(data='end'))
    times = [trip for trip in trips if trip is not None]
    # A lost trip on the same machine is a fault, not noise
    if len(times) < ROUND_TRIPS:
        return None
    return {'discovery_s': discovery_time, 'round_trip_s': statistics.median(times)}


def main() -> None:
    """Run one of the two roles; exit with status 1 if no echo arrived in time."""
    guard_streams()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('role', choices=('ask', 'answer'))
    parser.add_argument('--seconds', type=float, default=8.0, help='give up after [s]')
    options = parser.parse_args()
    deadline = time.monotonic() + options.seconds
    try:
        initialize_ros([])
    except BadInput as error:
        sys.exit(str(error))
    node = Node(f'lta_doctor_{options.role}')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    times = None
    try:
        if options.role == 'answer':
            echo_messages(node, executor, deadline)
        elif (times := measure_round_trip(node, executor, deadline)) is not None:
            sys.stdout.write(json.dumps(times) + '\n')
    finally:
        executor.shutdown()
        node.destroy_node()
        try_shutdown()
    sys.exit(1 if options.role == 'ask' and times is None else 0)


if __name__ == '__main__':
    main()
