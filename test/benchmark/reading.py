"""
Measure reading a large recording: opening and listing it, and one topic of it beside `rosbags`.

The bag has 1 GB: ADC blocks of noise that does not compress, and what a flight records beside
them. It is made in a temporary folder and removed at the end.
"""

import atexit
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile
import time

from bench import Figure
from lta_bridge.bag import BagWriter, build_offered_qos
from lta_bridge.bag.schemas import load_jazzy_types
from lta_data.bag import read_bag, summarize_bag
import numpy as np
from rosbags.highlevel import AnyReader

SIZE = 1_000_000_000  # of the bag [bytes]
BLOCK = 160_000  # of a light block: 8 diodes of 10 kS/s for 1 s, 16 bits each [bytes]
STEPS = 100  # control steps a block
FLUSH = 10  # blocks between two flushes
TOPIC = '/lta1/odom'
RARE = '/lta1/energy/reserve'


@cache
def bag() -> Path:
    folder = Path(tempfile.mkdtemp(prefix='lta-reading-'))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return written(folder / 'large', SIZE)


def written(folder: Path, size: int) -> Path:
    """Write a bag of about that many bytes into a folder and return it."""
    rng = np.random.default_rng(1)
    qos = [build_offered_qos('reliable', 'volatile', 10)]
    types = {
        '/lta1/photodiodes': 'lta_msgs/msg/LightBlock',
        TOPIC: 'nav_msgs/msg/Odometry',
        '/lta1/imu': 'sensor_msgs/msg/Imu',
        RARE: 'std_msgs/msg/Bool',
    }
    # The readers under test hand out bytes as they are, so noise of the right length does.
    odometry, imu = rng.bytes(720), rng.bytes(330)
    with BagWriter(folder, {'seed': '1'}) as writer:
        for topic, type_name in types.items():
            writer.add_topic(topic, type_name, qos)
        now = 10**9
        for block in range(size // BLOCK):
            writer.write('/lta1/photodiodes', b'\0\1\0\0' + rng.bytes(BLOCK), now)
            for _ in range(STEPS):
                now += 10**7
                writer.write(TOPIC, b'\0\1\0\0' + odometry, now)
                writer.write('/lta1/imu', b'\0\1\0\0' + imu, now)
            if block % 1000 == 0:
                writer.write(RARE, b'\0\1\0\0\1', now)
            if block % FLUSH == 0:
                writer.flush()
    return folder


def listing() -> float:
    """Return how long a listing takes, in CPU time of this process. [s]"""
    begin = time.process_time()
    if summarize_bag(bag()).messages < SIZE // BLOCK:
        raise AssertionError('messages are missing')
    return time.process_time() - begin


def ours(topic: str) -> Callable[[], float]:
    """Return how to measure our reading of a topic. [s]"""

    def measure() -> float:
        begin = time.process_time()
        found = read_bag(bag())
        if sum(1 for _ in found.iterate_messages([topic])) != found.topics[topic].count:
            raise AssertionError('messages are missing')
        return time.process_time() - begin

    return measure


def theirs(topic: str) -> Callable[[], float]:
    """Return how to measure how rosbags reads it. [s]"""

    def measure() -> float:
        begin = time.process_time()
        with AnyReader([bag()]) as reader:
            wanted = [link for link in reader.connections if link.topic == topic]
            count = sum(1 for _ in reader.messages(connections=wanted))
        if count != sum(link.msgcount for link in wanted):
            raise AssertionError('messages are missing')
        return time.process_time() - begin

    return measure


MEMORY = """
import sys
from pathlib import Path
from lta_data.bag import read_bag, summarize_bag

def peak():
    lines = Path('/proc/self/status').read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith('VmHWM'))

before = peak()
summarize_bag(sys.argv[1])
for _ in read_bag(sys.argv[1]).iterate_messages():
    pass
print(peak() - before)
"""


def memory() -> float:
    """Return by how much listing and reading it raises the peak memory of a process. [MB]"""
    command = [sys.executable, '-c', MEMORY, str(bag())]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return int(done.stdout) * 1024e-6


def figures() -> list[Figure]:
    """Return what is measured here."""
    load_jazzy_types()  # loaded once, before anything is measured
    peer = f'rosbags {version("rosbags")}'
    found = [
        Figure('reading.list', 's', listing, rounds=3, choose=min),
        Figure('reading.memory', 'MB', memory, rounds=1, choose=min),
    ]
    for name, topic in (('one_topic', TOPIC), ('rare_topic', RARE)):
        own = f'reading.{name}'
        found += [
            Figure(own, 's', ours(topic), rounds=3, choose=min),
            Figure(f'rosbags.{name}', 's', theirs(topic), rounds=3, choose=min, of=own, peer=peer),
        ]
    return found
