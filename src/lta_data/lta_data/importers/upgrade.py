# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Convert a bag of version 1, which had standard messages on four topics, to those of lta_msgs.

The data of all other messages are copied byte for byte, and the vehicle file gets one feedback
resistor. Messages of version 1 have fewer digits than those of today: nine in the energy balance.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
import shutil
from typing import Any, Final, final

from lta_bag.reader import Bag, read_bag
from lta_bag.schemas import generate_definition, load_jazzy_types
from lta_bag.storage import StorageFault
from lta_bag.version_1 import find_old_topics
from lta_bag.writer import BagWriter
from lta_config.errors import BadInput, format_count
from lta_config.files import parse_yaml
from lta_config.message_files import read_field_units
from lta_config.topics import load_topic_table
from lta_config.version import VERSION
from lta_data.importers.readers.rosbags_bag import list_raw_topics
import numpy as np
from numpy.typing import NDArray
import yaml

UPGRADER: Final = 'upgraded_by'  # key of the provenance
# The duties. An import has these as well, for commands that are forces or places
JOINTS: Final = 'sensor_msgs/msg/JointState'
FLOAT32: Final = 7  # sensor_msgs/PointField
ENERGY: Final = 'lta_msgs/msg/EnergyStatus'


class NotConvertible(Exception):
    """A message is not one of version 1; the text says why."""


@final
@dataclass(frozen=True, slots=True)
class BagUpgrade:
    """Result of an upgrade: messages in the new bag by topic, and what the old one lacks."""

    path: Path
    converted: Mapping[str, int]
    copied: int
    losses: list[str]

    def describe(self) -> str:
        """Return what was converted, in a sentence."""
        topics = ', '.join(f'{name} ({count})' for name, count in sorted(self.converted.items()))
        return (
            f'The messages of {topics} were converted, and {format_count(self.copied, "other")} '
            f'copied, to {self.path}.'
        )


def upgrade_bag(source: Path, out: Path) -> BagUpgrade:
    """
    Write a bag of version 1 anew, with the messages of lta_msgs.

    Parameters
    ----------
    source : Path
        A rosbag2 folder or an .mcap file; it is only read.
    out : Path
        Folder of the new bag; created if missing, refused if not empty.

    Raises
    ------
    BadInput
        If the bag needs no upgrade, a message is not one of version 1, a folder cannot be used,
        or the disk is full.

    """
    bag = read_bag(source)
    old = find_convertible_topics(bag)
    if not old:
        raise BadInput(
            f"'{source}' needs no upgrade: it has no messages of version 1; use it as it is."
        )
    folder = source.resolve()
    if folder.is_dir() and out.resolve().is_relative_to(folder):
        raise BadInput(
            f"The new folder '{out}' is inside the recording itself, which must not change; "
            'choose another folder.'
        )
    fresh = not out.exists()
    try:
        return write_upgraded_bag(bag, old, out)
    except (BadInput, StorageFault, KeyboardInterrupt) as reason:
        # Nothing half is left, but a folder of the user is never deleted
        if fresh:
            shutil.rmtree(out, ignore_errors=True)
        if isinstance(reason, StorageFault):
            raise BadInput(str(reason)) from None
        raise


def find_convertible_topics(bag: Bag) -> dict[str, str]:
    """Return the topics to convert: relative names, by absolute name."""
    old = find_old_topics(bag.types, bag.provenance)
    if 'importer' not in bag.provenance:
        old |= {
            name: 'motors'
            for name, kind in bag.types.items()
            if kind == JOINTS and name.rpartition('/')[2] == 'motors'
        }
    return old


def write_upgraded_bag(bag: Bag, old: Mapping[str, str], out: Path) -> BagUpgrade:
    """Write the new bag; see `upgrade_bag`. `old`: the topics to convert."""
    table, types = load_topic_table(), load_jazzy_types()
    converted, copied = Counter(dict.fromkeys(old, 0)), 0
    provenance = convert_vehicles(bag.provenance) | {UPGRADER: f'lta {VERSION}'}
    with BagWriter(out, provenance) as writer:
        for topic, raw in list_raw_topics(bag).items():
            definition = (
                generate_definition(table[old[topic]].type) if topic in old else raw.definition
            )
            writer.add_topic(topic, definition, raw.qos)
        for topic, log_time, data in bag.iterate_messages():
            if topic in old:
                try:
                    message = CONVERTERS[old[topic]](bag.decode(topic, data), types.types)
                except NotConvertible as reason:
                    raise BadInput(
                        f"The topic '{topic}' has a message that is not one of version 1, as "
                        f'{reason}; keep the bag as it is.'
                    ) from None
                data = bytes(types.serialize_cdr(message, table[old[topic]].type))
            writer.write(topic, data, log_time)
            converted[topic] += topic in old
            copied += topic not in old
    return BagUpgrade(out, {name: converted[name] for name in old}, copied, list(bag.losses))


def convert_vehicles(provenance: Mapping[str, str]) -> dict[str, str]:
    """Return a provenance with the first of the resistors that version 1 let a scene choose."""
    converted = dict(provenance)
    for key in provenance:
        # Of one robot, or with its name before it
        if key.rpartition('/')[2] == 'vehicle_file':
            content = parse_yaml(provenance[key], f"The bag's {key}")
            with suppress(KeyError, TypeError):  # a vehicle without diodes
                feedback = content['sensors']['diodes']['feedback']
                if isinstance(feedback['value'], list):
                    feedback['value'] = feedback['value'][0]
                    converted[key] = yaml.safe_dump(content, sort_keys=False)
    return converted


def convert_block(image: Any, types: Mapping[str, Any]) -> object:
    """Return a LightBlock of an image with a row for each sample."""
    if image.encoding != '16UC1' or image.is_bigendian:
        raise NotConvertible(f"it has the encoding '{image.encoding}', not 16UC1")
    if len(image.data) != 2 * image.height * image.width or not image.width <= 0xFFFF:
        raise NotConvertible(
            f'{image.height} x {image.width} samples do not fit {len(image.data)} bytes'
        )
    return types['lta_msgs/msg/LightBlock'](
        header=image.header,
        sample_rate=load_topic_table().light.sample_rate.si,
        diodes=image.width,
        counts=image.data.view('<u2').astype(np.uint16),
    )


def convert_peaks(cloud: Any, types: Mapping[str, Any]) -> object:
    """Return the LampPeaks of a cloud with a row for each beacon, a point for each diode."""
    fields = read_points(cloud)
    if missing := {'x', 'y', 'z', 'amplitude', 'snr'} - fields.keys():
        raise NotConvertible(f'its points have no {min(missing)}')
    unknown = np.full_like(fields['snr'], np.nan)
    axes = np.stack([fields[name] for name in 'xyz'], axis=-1)[:1].reshape(-1, 3).astype(float)
    beacons = zip(
        fields['amplitude'], fields['snr'], fields.get('frequency', unknown), strict=True
    )
    return types['lta_msgs/msg/LampPeaks'](
        header=cloud.header,
        axis=[types['geometry_msgs/msg/Vector3'](*axis) for axis in axes.tolist()],
        beacon=[
            types['lta_msgs/msg/BeaconPeaks'](*(np.ascontiguousarray(each) for each in beacon))
            for beacon in beacons
        ],
    )


def read_points(cloud: Any) -> dict[str, NDArray[np.float32]]:
    """Return the float32 fields of a cloud, each of shape (rows, points)."""
    offsets = {field.name: field.offset for field in cloud.fields if field.datatype == FLOAT32}
    whole = (
        (cloud.width or not cloud.height)
        and cloud.row_step == cloud.width * cloud.point_step
        and len(cloud.data) == cloud.height * cloud.row_step
        and not cloud.is_bigendian
        and not cloud.point_step % 4
        and all(not at % 4 and at + 4 <= cloud.point_step for at in offsets.values())
    )
    if not whole:
        raise NotConvertible('the layout of its points does not fit its data')
    words = cloud.data.view('<f4').astype(np.float32)
    points = words.reshape(cloud.height, cloud.width, cloud.point_step // 4)
    return {name: points[..., offset // 4] for name, offset in offsets.items()}


def convert_duties(joints: Any, types: Mapping[str, Any]) -> object:
    """Return the ActuatorDuty of joints whose effort is the duty."""
    if len(joints.position) or len(joints.velocity):
        raise NotConvertible('it has positions or velocities')
    return types['lta_msgs/msg/ActuatorDuty'](
        header=joints.header, name=joints.name, duty=joints.effort
    )


def convert_status(array: Any, types: Mapping[str, Any]) -> object:
    """Return the EnergyStatus of an array whose keys are the names of fields with their units."""
    if [status.name for status in array.status] != ['energy', 'meters']:
        raise NotConvertible('its statuses are not energy and meters')
    battery, meters = array.status
    numbers = dict.fromkeys(read_field_units()[ENERGY], np.nan)
    for item in battery.values:
        name = item.key.rpartition('_')[0]
        with suppress(ValueError):  # as NaN
            numbers |= {name: float(item.value)} if name in numbers else {}
    return types[ENERGY](
        header=array.header,
        level=battery.level & 0xFF,  # a byte, which is decoded with a sign
        message=battery.message,
        meters_level=meters.level & 0xFF,
        meters_message=meters.message,
        **numbers,
    )


CONVERTERS: Final[Mapping[str, Callable[[Any, Mapping[str, Any]], object]]] = {
    'photodiodes': convert_block,
    'light/peaks': convert_peaks,
    'motors': convert_duties,
    'energy/status': convert_status,
}
