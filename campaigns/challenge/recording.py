# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write a challenge flight as a bag that does not reveal the hidden effects."""

from collections.abc import Mapping, Sequence
from heapq import merge
from pathlib import Path
from typing import Any, Final

from lta_bag.metadata import build_offered_qos
from lta_bag.writer import BagWriter
from lta_config.topics import load_topic_table, robot_topic
from lta_data.importers.entry_plan import CdrTemplate, WRENCH
from lta_flight.flight_run import SIMULATED_ROBOT
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BEGUN: Final = 1_000_000_000  # ns; stamp of the start, since a stamp of 0 means "not set"
QOS: Final = [build_offered_qos('reliable', 'volatile', 10)]
PUSHED: Final = 'wrench_command'
POSE: Final = tuple(f'pose.pose.position.{axis}' for axis in 'xyz') + tuple(
    f'pose.pose.orientation.{axis}' for axis in 'xyzw'
)
# Message fields of the columns of each topic
COLUMNS: Final[dict[str, tuple[str, ...]]] = {
    'ground_truth/odom': POSE,
    'imu': tuple(
        f'{kind}.{axis}' for kind in ('angular_velocity', 'linear_acceleration') for axis in 'xyz'
    ),
    'range': ('range',),
    'pressure': ('fluid_pressure',),
    'battery': ('voltage',),
    PUSHED: tuple(f'wrench.{kind}.{axis}' for kind in ('force', 'torque') for axis in 'xyz'),
}
# Constant fields; a first covariance of -1 marks the twist and the orientation as unknown
SAID: Final[dict[str, dict[str, Any]]] = {
    'ground_truth/odom': {'child_frame_id': 'base_link', 'twist.covariance[0]': -1.0},
    'imu': {'orientation_covariance[0]': -1.0},
    'range': {'radiation_type': 1, 'min_range': 0.04, 'max_range': 4.0},
    'battery': {'present': 1},
}


def _encode_messages(
    topic: str, rotors: Sequence[str], time: Array, values: Array
) -> tuple[str, Any]:
    """Return the type of a topic and an iterator of its messages (time in ns, name, bytes)."""
    # The wrench command is not a topic of a flight's graph
    entry = load_topic_table()[topic] if topic != PUSHED else None
    kind, frame = (entry.type, entry.frame) if entry else (WRENCH.type_name, WRENCH.frame)
    constants: dict[str, Any] = {'header.frame_id': frame, **SAID.get(topic, {})}
    lengths = {}
    columns = COLUMNS.get(topic, ())
    if topic == 'motors':
        constants['name'], lengths['duty'] = list(rotors), len(rotors)
        columns = tuple(f'effort[{k}]' for k in range(len(rotors)))
    # All messages of a topic have the same size; fill them in one array operation
    layout = CdrTemplate(kind, constants, lengths)
    stamps = BEGUN + np.round(time * 1e9).astype(np.int64)
    numbers: dict[str, Any] = {
        'header.stamp.sec': stamps // 1_000_000_000,
        'header.stamp.nanosec': stamps % 1_000_000_000,
        **{path: values[:, k] for k, path in enumerate(columns)},
    }
    data, size = layout.serialize_messages(len(time), numbers), layout.size
    name = robot_topic(SIMULATED_ROBOT, topic)
    messages = (
        (stamp, name, data[k * size : (k + 1) * size]) for k, stamp in enumerate(stamps.tolist())
    )
    return kind, messages


def write_bag(
    bag: Path,
    streams: Mapping[str, tuple[Array, Array]],
    rotors: Sequence[str],
    metadata: Mapping[str, str],
) -> None:
    """
    Write a bag.

    Parameters
    ----------
    bag : Path
        Folder of the bag.
    streams : mapping of topic to (times, values)
        Times since the start [s], values as columns.
    rotors : sequence of str
        Names of the actuators.
    metadata : mapping of str to str
        Provenance to store in the bag.

    """
    with BagWriter(bag, metadata) as writer:
        all_made = []
        for topic, (time, values) in streams.items():
            kind, messages = _encode_messages(topic, rotors, time, values)
            writer.add_topic(robot_topic(SIMULATED_ROBOT, topic), kind, QOS)
            all_made.append(messages)
        # A bag is written in the order of time; each stream is sorted already
        for stamp, name, data in merge(*all_made, key=lambda one: one[0]):
            writer.write(name, data, stamp)
