"""The `metadata.yaml` of a rosbag2 folder, version 9 (ROS 2 Jazzy)."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
import os
from pathlib import Path
from typing import final

from lta_bridge.bag.qos import Profile
from lta_bridge.bag.schemas import Definition
from lta_bridge.bag.storage import storage_fault
import yaml

NAME = 'metadata.yaml'


@final
@dataclass(slots=True)
class TopicRecord:
    """One recorded topic: its type, what its publishers offered, and its messages so far."""

    name: str
    definition: Definition
    qos: Sequence[Profile]
    channel: int
    written: int = 0


def topic_entry(topic: TopicRecord, count: int) -> dict[str, object]:
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


def bag_metadata(
    file_name: str,
    topics: Sequence[TopicRecord],
    counts: Mapping[int, int],
    span: tuple[int, int],
    provenance: Mapping[str, str],
) -> dict[str, object]:
    """
    Return the content of `metadata.yaml` for a bag of one file.

    Parameters
    ----------
    file_name : str
        Name of the MCAP file in the folder.
    topics : sequence of TopicRecord
        The recorded topics.
    counts : mapping of int to int
        Messages in the file by channel.
    span : tuple of int
        First and last log time. [ns]
    provenance : mapping of str to str
        Goes to `custom_data`.

    """
    start, end = span
    times: dict[str, object] = {
        'duration': {'nanoseconds': end - start},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': sum(counts.values()),
    }
    return {
        'rosbag2_bagfile_information': {
            'version': 9,
            'storage_identifier': 'mcap',
            **times,
            'topics_with_message_count': [
                topic_entry(topic, counts.get(topic.channel, 0)) for topic in topics
            ],
            'compression_format': '',
            'compression_mode': '',
            'relative_file_paths': [file_name],
            'files': [{'path': file_name, **times}],
            'custom_data': dict(provenance) or None,
            'ros_distro': 'jazzy',
        }
    }


def write_metadata(folder: Path, content: Mapping[str, object]) -> None:
    """
    Replace a folder's `metadata.yaml` in one step: readers see the old one or the new one.

    Raises
    ------
    StorageFault
        If there is no room; the old one stays.

    """
    text = yaml.dump(content, Dumper=PlainDumper, sort_keys=False, allow_unicode=True)
    fresh = folder / f'{NAME}.tmp'
    try:
        with fresh.open('w', encoding='utf-8') as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
        fresh.replace(folder / NAME)
    except OSError as error:
        with suppress(OSError):
            fresh.unlink(missing_ok=True)
        raise storage_fault(error, folder / NAME) from error


class PlainDumper(yaml.CSafeDumper):
    """YAML without anchors: rosbag2's reader need not know them."""

    def ignore_aliases(self, data: object) -> bool:
        """Write every value out."""
        return True
