"""
Measure how fast a topic becomes columns, beside rosbags with numpy and with pandas.

One flight is simulated into a temporary folder. LTA and its peers then read one topic of it and
end with the same columns: every number of nav_msgs/Odometry but the covariances. The time is what
the process had, as others share the machine; opening the bag counts for all.
"""

import atexit
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path
import shutil
import tempfile
import time
from typing import Any

from bench import Figure
import lta_analysis
from lta_flight.flight_run import SilentObserver
from lta_flight.simulate import simulate_once, SimulationRequest
import numpy as np
import pandas
from rosbags.highlevel import AnyReader

TOPIC = 'ground_truth/odom'
PATHS = (
    *(f'pose.pose.position.{axis}' for axis in 'xyz'),
    *(f'pose.pose.orientation.{axis}' for axis in 'xyzw'),
    *(f'twist.twist.{part}.{axis}' for part in ('linear', 'angular') for axis in 'xyz'),
)


@cache
def bag() -> Path:
    """Return the bag of a flight."""
    folder = Path(tempfile.mkdtemp(prefix='lta-bench-'))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    order = SimulationRequest('gtmab', 'lamp_room', 'bag', '', 1, out=folder / 'flight')
    return simulate_once(order, SilentObserver())[0].bag


def ours() -> dict[str, np.ndarray[Any, Any]]:
    """Return the columns by LTA."""
    table = lta_analysis.open(bag())[TOPIC]
    return {path: table[path] for path in PATHS}


def objects() -> list[Any]:
    """Return the messages by rosbags."""
    with AnyReader([bag()]) as reader:
        connections = [each for each in reader.connections if each.topic == f'/lta1/{TOPIC}']
        found = reader.messages(connections)
        return [reader.deserialize(raw, connection.msgtype) for connection, _, raw in found]


def rows() -> list[list[float]]:
    """Return the columns' values of each message by rosbags."""
    found = []
    for message in objects():
        pose, twist = message.pose.pose, message.twist.twist
        place, turn, linear, angular = pose.position, pose.orientation, twist.linear, twist.angular
        found.append([
            place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w,
            linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
        ])  # fmt: skip
    return found


def peer() -> dict[str, np.ndarray[Any, Any]]:
    """Return the columns by rosbags and numpy."""
    return dict(zip(PATHS, np.array(rows()).T, strict=True))


def frame() -> dict[str, np.ndarray[Any, Any]]:
    """Return the columns by rosbags and pandas."""
    table = pandas.DataFrame(rows(), columns=list(PATHS))
    return {path: table[path].to_numpy() for path in PATHS}


def rate(read: Any) -> float:
    """Return messages a second."""
    bag()
    begin = time.process_time()
    columns = read()
    spent = time.process_time() - begin
    expected = ours()
    for path in PATHS:
        np.testing.assert_array_equal(columns[path], expected[path])
    return len(expected[PATHS[0]]) / spent


def figures() -> list[Figure]:
    """Return what is measured here."""
    name, unit = 'tables.one_topic', 'messages/s'
    rosbags = f'rosbags {version("rosbags")}'
    return [
        Figure(name, unit, partial(rate, ours), rounds=5),
        Figure(f'{name}.numpy', unit, partial(rate, peer), rounds=5, of=name, peer=rosbags),
        Figure(
            f'{name}.pandas', unit, partial(rate, frame), rounds=5, of=name,
            peer=f'{rosbags} with pandas {version("pandas")}',
        ),
    ]  # fmt: skip
