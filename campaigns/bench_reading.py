"""
Measure reading: opening a bag of 1 GB, topics of it, and Odometry as columns, beside rosbags.

The large bag has light blocks of noise that does not compress, and what a flight records beside
them. All is by processor time, as others share the machine; opening the bag counts.
"""

import atexit
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile
import time

import lta_analysis
from lta_bridge.bag import BagWriter, build_offered_qos
from lta_bridge.bag.schemas import load_jazzy_types
from lta_data.bag import read_bag, summarize_bag
from lta_flight.flight_spec import load_spec
from lta_flight.progress import FlightProgress
from lta_flight.simulate import simulate_once
import numpy as np
from rich.console import Console
from rosbags.highlevel import AnyReader

from campaigns.bench import Figure

SIZE = 1_000_000_000  # of the bag [bytes]
BLOCK = 160_000  # of a light block: 8 diodes of 10 kS/s for 1 s, 16 bits each [bytes]
STEPS = 100  # control steps a block
TYPES = {
    '/lta1/photodiodes': 'lta_msgs/msg/LightBlock',
    '/lta1/odom': 'nav_msgs/msg/Odometry',
    '/lta1/imu': 'sensor_msgs/msg/Imu',
    '/lta1/energy/reserve': 'std_msgs/msg/Bool',
}
TRUTH = 'ground_truth/odom'
PATHS = (
    *(f'pose.pose.position.{axis}' for axis in 'xyz'),
    *(f'pose.pose.orientation.{axis}' for axis in 'xyzw'),
    *(f'twist.twist.{part}.{axis}' for part in ('linear', 'angular') for axis in 'xyz'),
)
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


@cache
def make_folder() -> Path:
    """Return a folder that is removed at the end."""
    folder = Path(tempfile.mkdtemp(prefix='lta-bench-'))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@cache
def write_large_bag(size: int = SIZE) -> Path:
    """Write a bag of about that many bytes; the readers hand out bytes as they are."""
    rng, folder = np.random.default_rng(1), make_folder() / 'large'
    qos = [build_offered_qos('reliable', 'volatile', 10)]
    odometry, imu = rng.bytes(720), rng.bytes(330)
    load_jazzy_types()  # loaded once, before anything is measured
    with BagWriter(folder, {'seed': '1'}) as writer:
        for topic, type_name in TYPES.items():
            writer.add_topic(topic, type_name, qos)
        now = 10**9
        for block in range(size // BLOCK):
            writer.write('/lta1/photodiodes', b'\0\1\0\0' + rng.bytes(BLOCK), now)
            for _ in range(STEPS):
                now += 10**7
                writer.write('/lta1/odom', b'\0\1\0\0' + odometry, now)
                writer.write('/lta1/imu', b'\0\1\0\0' + imu, now)
            if block % 1000 == 0:
                writer.write('/lta1/energy/reserve', b'\0\1\0\0\1', now)
            if block % 10 == 0:
                writer.flush()
    return folder


def list_content() -> float:
    """Return how long a listing takes. [s]"""
    bag, begin = write_large_bag(), time.process_time()
    if summarize_bag(bag).messages < SIZE // BLOCK:
        raise AssertionError('messages are missing')
    return time.process_time() - begin


def read_topic(topic: str) -> float:
    """Return how long our reading of a topic takes. [s]"""
    bag, begin = write_large_bag(), time.process_time()
    opened = read_bag(bag)
    if sum(1 for _ in opened.iterate_messages([topic])) != opened.topics[topic].count:
        raise AssertionError('messages are missing')
    return time.process_time() - begin


def read_by_rosbags(topic: str) -> float:
    """Return how long rosbags takes to read a topic. [s]"""
    bag, begin = write_large_bag(), time.process_time()
    with AnyReader([bag]) as reader:
        links = [link for link in reader.connections if link.topic == topic]
        if sum(1 for _ in reader.messages(links)) != sum(link.msgcount for link in links):
            raise AssertionError('messages are missing')
    return time.process_time() - begin


def measure_memory() -> float:
    """Return by how much listing and reading it raises the peak memory of a process. [MB]"""
    command = [sys.executable, '-c', MEMORY, str(write_large_bag())]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return int(done.stdout) * 1024e-6


def list_reading() -> list[Figure]:
    """Return the figures of a large bag."""
    peer = f'rosbags {version("rosbags")}'
    figures = [
        Figure('reading.list', 's', list_content, 'listing the content of a bag of 1 GB', min),
        Figure('reading.memory', 'MB', measure_memory,
               'rise of the peak memory by listing and reading all of it', min),
    ]  # fmt: skip
    for name, topic in (('one_topic', '/lta1/odom'), ('rare_topic', '/lta1/energy/reserve')):
        own, about = f'reading.{name}', f'reading {name.replace("_", " ")} of it'
        figures += [
            Figure(own, 's', partial(read_topic, topic), about, min),
            Figure(f'{own}.rosbags', 's', partial(read_by_rosbags, topic), choose=min, of=own,
                   peer=peer),
        ]  # fmt: skip
    return figures


@cache
def simulate_flight() -> Path:
    """Return the bag of a flight."""
    spec, out = load_spec('gtmab', 'lamp_room', 'bag', ''), make_folder() / 'flight'
    return simulate_once(spec, 1, out, FlightProgress(Console(quiet=True)))[0].bag


def tabulate() -> float:
    """Return how many messages a second become columns by LTA."""
    bag, begin = simulate_flight(), time.process_time()
    table = lta_analysis.open(bag)[TRUTH]
    columns = {path: table[path] for path in PATHS}
    return len(columns[PATHS[0]]) / (time.process_time() - begin)


def tabulate_by_rosbags() -> float:
    """Return how many messages a second become the same columns by rosbags and numpy."""
    bag, begin = simulate_flight(), time.process_time()
    with AnyReader([bag]) as reader:
        links = [link for link in reader.connections if link.topic == f'/lta1/{TRUTH}']
        messages = [
            reader.deserialize(raw, link.msgtype) for link, _, raw in reader.messages(links)
        ]
    rows = []
    for message in messages:
        pose, twist = message.pose.pose, message.twist.twist
        place, turn, linear, angular = pose.position, pose.orientation, twist.linear, twist.angular
        rows.append([
            place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w,
            linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
        ])  # fmt: skip
    columns = np.array(rows).T
    spent = time.process_time() - begin
    table = lta_analysis.open(bag)[TRUTH]
    for path, values in zip(PATHS, columns, strict=True):
        np.testing.assert_array_equal(table[path], values)
    return len(rows) / spent


def list_tables() -> list[Figure]:
    """Return the figures of a topic as columns."""
    name, unit = 'tables.one_topic', 'messages/s'
    return [
        Figure(name, unit, tabulate, 'Odometry as columns'),
        Figure(f'{name}.rosbags', unit, tabulate_by_rosbags, of=name,
               peer=f'rosbags {version("rosbags")}'),
    ]  # fmt: skip
