"""
Measure how long nodes fall silent when another is killed.

`killed.silence` is the longest time for which one of three nodes that talk with two others could
do nothing, while these were killed and replaced in turn; the peer is the same with Fast DDS's own
settings in place of `config/fastdds/`, where whoever is killed may hold a lock of shared memory.
"""

from functools import partial
import os
from random import Random
import subprocess
import sys
import time

from bench import Figure
from start import as_it_comes, PLAIN, told

WATCHERS, VICTIMS = 3, 2
KILLS = 12
PERIOD = 0.0025  # s between the messages of a node
LATEST = 0.5  # s for which a victim talks with all others, at most
RANDOM = Random(1)


def figures() -> list[Figure]:
    """Return what can be measured here."""
    figure = partial(Figure, unit='s', rounds=4, choose=max)
    return [
        figure('killed.silence', measure=partial(silence, dict(os.environ))),
        figure(
            'killed.defaults',
            measure=partial(silence, as_it_comes()),
            of='killed.silence',
            peer=PLAIN,
        ),
    ]


def silence(environment: dict[str, str]) -> float:
    """Kill and replace nodes; return the longest silence of those that stay. [s]"""
    begin = partial(begun, environment)
    watchers = [begin() for _ in range(WATCHERS)]
    victims = [begin() for _ in range(VICTIMS)]
    for node in watchers + victims:
        told(node)
    for k in range(KILLS):
        time.sleep(RANDOM.uniform(0.0, LATEST))
        end(victims[k % VICTIMS])
        victims[k % VICTIMS] = begin()
        told(victims[k % VICTIMS])
    longest = [float(node.communicate('')[0]) for node in watchers]
    for node in victims:
        end(node)
    return max(longest)


def begun(environment: dict[str, str]) -> 'subprocess.Popen[str]':
    """Start a node."""
    pipe = subprocess.PIPE
    command = [sys.executable, __file__]
    return subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, text=True)


def end(node: 'subprocess.Popen[str]') -> None:
    """Kill a node."""
    node.kill()
    node.communicate()


def talk() -> None:
    """Be one of the nodes: say when all others are heard, and at the end the longest silence."""
    from threading import Thread

    import rclpy
    from rclpy.experimental import EventsExecutor
    from sensor_msgs.msg import Imu

    rclpy.init()
    node = rclpy.create_node(f'talker_{os.getpid()}')
    out = node.create_publisher(Imu, 'talk', 10)
    node.create_subscription(Imu, 'talk', lambda _: None, 10)
    all_here = WATCHERS + VICTIMS
    here, longest, last = False, 0.0, 0.0

    def tick() -> None:
        nonlocal here, longest, last
        out.publish(Imu())
        if here:
            now = time.monotonic()
            longest, last = max(longest, now - last), now
        elif out.get_subscription_count() >= all_here:
            sys.stdout.write('here\n')
            sys.stdout.flush()
            here, last = True, time.monotonic()

    node.create_timer(PERIOD, tick)
    over = Thread(target=sys.stdin.read)
    over.start()
    executor = EventsExecutor()
    executor.add_node(node)
    while over.is_alive():
        executor.spin_once(0.1)
    sys.stdout.write(f'{longest}\n')
    sys.stdout.flush()
    os._exit(0)  # what is killed beside it must not hold it up


if __name__ == '__main__':
    talk()
