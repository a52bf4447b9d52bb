# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write the `metadata.yaml` of a rosbag2 folder, version 9 (ROS 2 Jazzy), and its QoS profiles."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final, Literal, TypedDict

from lta_bag.mcap_file.output import McapFile
from lta_bag.schemas import MessageDefinition
from lta_bag.storage import to_storage_fault
from lta_config.atomic_file import replace_atomically
import yaml


class QosDuration(TypedDict):
    """A duration of a QoS profile."""

    sec: int
    nsec: int


class OfferedQos(TypedDict):
    """QoS profile of one publisher; keys and order are those of rosbag2."""

    history: str
    depth: int
    reliability: str
    durability: str
    deadline: QosDuration
    lifespan: QosDuration
    liveliness: str
    liveliness_lease_duration: QosDuration
    avoid_ros_namespace_conventions: bool


def infinite_duration() -> QosDuration:
    """Return the duration that means no limit: 2^63 - 1 ns."""
    return {'sec': 9223372036, 'nsec': 854775807}


def build_offered_qos(
    reliability: Literal['reliable', 'best_effort'],
    durability: Literal['volatile', 'transient_local'],
    depth: int,
) -> OfferedQos:
    """Return a keep-last profile without deadline, lifespan or liveliness lease."""
    return {
        'history': 'keep_last',
        'depth': depth,
        'reliability': reliability,
        'durability': durability,
        'deadline': infinite_duration(),
        'lifespan': infinite_duration(),
        'liveliness': 'automatic',
        'liveliness_lease_duration': infinite_duration(),
        'avoid_ros_namespace_conventions': False,
    }


def has_mixed_durability(profiles: Sequence[OfferedQos]) -> bool:
    """Return whether only some publishers of a topic are transient local."""
    return len({each['durability'] for each in profiles}) > 1


def format_offered_qos(profiles: Sequence[OfferedQos]) -> str:
    """Return the YAML text of a channel's `offered_qos_profiles`; empty without profiles."""
    if not profiles:
        return ''
    return yaml.safe_dump([dict(profile) for profile in profiles], sort_keys=False).strip()


METADATA_FILE = 'metadata.yaml'


@final
@dataclass(slots=True)
class TopicRecord:
    """One recorded topic: type, offered QoS profiles, channel and number of messages so far."""

    name: str
    definition: MessageDefinition
    qos: Sequence[OfferedQos]
    channel: int
    written: int = 0


def build_topic_metadata(topic: TopicRecord, count: int) -> dict[str, object]:
    """Return one entry of `topics_with_message_count`."""
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.definition.type_name,
            'serialization_format': topic.definition.message_encoding,
            'offered_qos_profiles': [dict(profile) for profile in topic.qos],
            'type_description_hash': topic.definition.rihs01,
        },
        'message_count': count,
    }


def build_bag_metadata(
    file: McapFile, topics: Sequence[TopicRecord], provenance: Mapping[str, str]
) -> dict[str, object]:
    """Return the content of `metadata.yaml`; the provenance becomes `custom_data`."""
    time_range = build_time_range(file.start, file.end, file.counts.total())
    return {
        'rosbag2_bagfile_information': {
            'version': 9,
            'storage_identifier': 'mcap',
            **time_range,
            'topics_with_message_count': [
                build_topic_metadata(topic, file.counts[topic.channel]) for topic in topics
            ],
            'compression_format': '',
            'compression_mode': '',
            'relative_file_paths': [file.path.name],
            'files': [{'path': file.path.name, **time_range}],
            # rosbag2 writes null, not an empty map
            'custom_data': dict(provenance) or None,
            'ros_distro': 'jazzy',
        }
    }


def build_time_range(start: int, end: int, messages: int) -> dict[str, object]:
    """Return the time range and message count of the bag and its file; log times in ns."""
    return {
        'duration': {'nanoseconds': end - start},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': messages,
    }


def write_metadata(folder: Path, content: Mapping[str, object]) -> None:
    """
    Replace a folder's `metadata.yaml` atomically.

    Raises
    ------
    StorageFault
        If there is no room; the old file stays.

    """
    text = yaml.dump(content, Dumper=AliasFreeDumper, sort_keys=False, allow_unicode=True)
    try:
        # A crash must leave either the old or the new file
        with replace_atomically(folder / METADATA_FILE) as part:
            part.write_text(text, encoding='utf-8')
    except OSError as error:
        raise to_storage_fault(error, folder / METADATA_FILE) from error


class AliasFreeDumper(yaml.CSafeDumper):
    """Write YAML without anchors and aliases, which rosbag2's reader need not support."""

    def ignore_aliases(self, data: object) -> bool:
        """Write every value in full."""
        return True
