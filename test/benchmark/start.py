"""
Measure how soon the processes of a graph have found each other.

`start.matched` is the time from the last of seven nodes that begin within a second, as those of a
drone do, until each has found all the others; the peer is the same with Fast DDS's own settings in
place of `config/fastdds/`.
"""

from functools import partial
import os
import statistics
import subprocess
import sys
import time

from bench import Figure

NODES = 7
TOPICS = 5  # of each node; all others read them
SPREAD = 1.0  # s between the first node and the last
PROFILES = 'FASTRTPS_DEFAULT_PROFILES_FILE'
PLAIN = 'Fast DDS as it comes'


def figures() -> list[Figure]:
    """Return what can be measured here."""
    figure, median = partial(Figure, unit='s', rounds=8), statistics.median
    return [
        figure('start.matched', measure=partial(matched, dict(os.environ)), choose=median),
        figure(
            'start.defaults',
            measure=partial(matched, as_it_comes()),
            choose=median,
            of='start.matched',
            peer=PLAIN,
        ),
    ]


def as_it_comes() -> dict[str, str]:
    """Return our environment with Fast DDS's own settings."""
    kept = {name: value for name, value in os.environ.items() if name != PROFILES}
    return kept | {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


def matched(environment: dict[str, str]) -> float:
    """Start the nodes and return how long they took to find each other. [s]"""
    nodes = [
        subprocess.Popen(
            [sys.executable, __file__, str(own)],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for own in range(NODES)
    ]
    times = [told(node) for node in nodes]
    for node in nodes:
        node.communicate()
    born, found = zip(*(map(float, line.split()) for line in times), strict=True)
    return max(found) - max(born)


def told(node: 'subprocess.Popen[str]') -> str:
    """Return a node's line."""
    assert node.stdout is not None
    return node.stdout.readline()


def node(own: int) -> None:
    """Be one of the nodes: tell when it began and when all had found it, and wait for the end."""
    import rclpy
    from rclpy.qos import qos_profile_system_default as profile
    from std_msgs.msg import Header

    time.sleep(SPREAD * own / (NODES - 1))
    rclpy.init()
    one = rclpy.create_node(f'node_{own}')
    written = [one.create_publisher(Header, f'of_{own}/t{k}', profile) for k in range(TOPICS)]
    others = [other for other in range(NODES) if other != own]
    for name in (f'of_{other}/t{k}' for other in others for k in range(TOPICS)):
        one.create_subscription(Header, name, lambda _: None, profile)
    born = time.monotonic()
    while any(each.get_subscription_count() < len(others) for each in written):
        time.sleep(0.005)
    sys.stdout.write(f'{born} {time.monotonic()}\n')
    sys.stdout.flush()
    sys.stdin.read()


if __name__ == '__main__':
    node(int(sys.argv[1]))
