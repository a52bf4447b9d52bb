"""How long a step takes through a graph in lockstep, and whether a process's memory is flat."""

from collections.abc import Sequence
from pathlib import Path
import time
from typing import Final, NamedTuple

from lta_bridge.log_time_assigner import read_stamp
from lta_config.topics import load_topic_table
from lta_graph.ros.listener import join_graph
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
import numpy as np
from numpy.typing import NDArray
from rclpy.subscription import Subscription

LEAK: Final = 4.0  # MB/h, the most that counts as flat: 100 MB a day
TABLE: Final = load_topic_table()
ENDS: Final = ('imu', 'motors')  # of a step
NAP: Final = 0.001  # s


def measure_latency(seconds: float) -> NDArray[np.float64]:
    """
    Look on for a while [s], and return how long each step took, by the times of its messages.

    DDS sends with each message when it was written: whoever looks on may get it late, and out of
    turn.

    The result has shape (steps,) [s].
    """
    with join_graph('onlooker', '/lta1') as (node, _):
        readers = []
        for name in ENDS:
            row = TABLE[name]
            kind, quality = find_message_type(row), select_profile(row, lockstep=True)
            readers.append(node.create_subscription(kind, name, taken_by_hand, quality, raw=True))
        return timed(readers, seconds)


def taken_by_hand(data: bytes) -> None:
    """Never called: nobody spins."""


def timed(readers: Sequence[Subscription], seconds: float) -> NDArray[np.float64]:
    """Return how long each step took [s] that the readers of the two ends hear in a while. [s]"""
    began, until = time.time_ns(), time.monotonic() + seconds
    written: dict[str, dict[int, int]] = {name: {} for name in ENDS}
    while time.monotonic() < until:
        found = 0
        for reader, name in zip(readers, ENDS, strict=True):
            while (taken := reader.handle.take_message(reader.msg_type, True)) is not None:
                data, about = taken
                written[name][read_stamp(data) or 0] = about['source_timestamp']
                found += 1
        if not found:
            time.sleep(NAP)
    first, last = (written[name] for name in ENDS)
    both = [k for k in last if k in first and first[k] >= began]
    return np.array([1e-9 * (last[k] - first[k]) for k in both])


class Slope(NamedTuple):
    """How a process's memory changes: where it stands [MB], slope and half its interval [MB/h]."""

    held: float
    slope: float
    within: float

    @property
    def flat(self) -> bool:
        """Whether it is surely no leak, or too small to matter."""
        return self.slope - self.within < LEAK


def read_own_memory(pid: int) -> float:
    """Return the memory that is a process's own. [MB]"""
    for line in Path(f'/proc/{pid}/status').read_text().splitlines():
        if line.startswith('RssAnon:'):
            return float(line.split()[1]) / 1024.0
    raise ValueError(f'process {pid} has no memory')


def fit_slope(times: NDArray[np.float64], held: NDArray[np.float64]) -> Slope:
    """
    Return the slope of memory by least squares, its interval from blocks that hang together.

    `times`, shape (looks,) [s]. `held`, shape (looks,) [MB].
    """
    hours = times / 3600.0
    line = np.polyfit(hours, held, 1)
    rest = held - np.polyval(line, hours)
    # Neighbours are alike: one look in so many counts.
    alike = np.clip(np.corrcoef(rest[:-1], rest[1:])[0, 1], 0.0, 0.99) if rest.std() > 0.0 else 0.0
    counted = max(3.0, len(hours) * (1.0 - alike) / (1.0 + alike))
    spread = np.sqrt((rest**2).sum() / len(hours)) / (hours.std() * np.sqrt(counted - 2.0))
    return Slope(float(held.mean()), float(line[0]), float(2.0 * spread))
