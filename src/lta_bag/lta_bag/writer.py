# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write a rosbag2 bag that stays readable after a crash or a full disk.

The bag is a folder with metadata.yaml (version 9) and one MCAP file, readable on its own: profile
ros2, CDR messages, message definitions, zstd chunks with CRC, chunk and message indexes.
Everything up to the last `flush` survives the death of the process.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import final, Self

from lta_bag.mcap_file.output import McapFile
from lta_bag.metadata import (
    build_bag_metadata,
    format_offered_qos,
    METADATA_FILE,
    OfferedQos,
    TopicRecord,
    write_metadata,
)
from lta_bag.schemas import generate_definition, MessageDefinition
from lta_bag.storage import check_room, fsync_file, StorageFault
from lta_config.atomic_file import remove_dead_parts
from lta_config.errors import BadInput

LIBRARY = 'lta'


def prepare_empty_folder(path: Path) -> Path:
    """
    Create the folder if it is missing, and return it.

    What a killed command was writing there is removed. Raise `BadInput` if it is not empty or
    cannot be created.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        remove_dead_parts(path)
        # In the same try: a folder may be creatable but not readable
        busy = any(path.iterdir())
    except OSError as error:
        raise BadInput(
            f"The folder '{path}' cannot be created or read ({error.strerror}); choose another "
            'folder.'
        ) from error
    if busy:
        raise BadInput(f"The folder '{path}' is not empty; choose another folder.")
    return path


@final
class BagWriter:
    """
    Write one bag; use it as a context manager, or call `close`.

    Parameters
    ----------
    path : Path
        Folder of the bag; created if missing, must be empty.
    provenance : mapping of str to str
        Origin of the data (commit, seed, scenario); stored in metadata.yaml and the MCAP file.

    Raises
    ------
    BadInput
        If the folder cannot be used.
    StorageFault
        If the disk is full or broken.

    """

    def __init__(self, path: Path, provenance: Mapping[str, str]) -> None:
        self.path = prepare_empty_folder(Path(path))
        self._provenance = dict(provenance)
        self._topics: dict[str, TopicRecord] = {}
        self._described = 0
        self._fault: StorageFault | None = None
        self._open = True
        # rosbag2's naming; resolve() gives '.' and '..' a name
        name = f'{self.path.resolve().name}_0.mcap'
        self._mcap = McapFile(self.path / name, LIBRARY, self._provenance)
        self._write_metadata()

    @property
    def required_closing_space(self) -> int:
        """Space that `close` needs: stop recording before less is left [bytes]."""
        # Upper bound of metadata.yaml: head and topics
        return self._mcap.summary_size + 1024 * (4 + len(self._topics))

    def add_topic(
        self, name: str, type_name: str | MessageDefinition, qos: Sequence[OfferedQos]
    ) -> None:
        """
        Add a topic; the bag lists it even if it has no message.

        Parameters
        ----------
        name : str
            Absolute name, for example '/lta1/odom'.
        type_name : str or MessageDefinition
            For example 'nav_msgs/msg/Odometry'; a definition for a type that is not part of ROS 2
            Jazzy.
        qos : sequence of OfferedQos
            QoS profiles of the publishers; see `build_offered_qos`.

        Raises
        ------
        BadInput
            If the type is unknown or the topic was added before.
        StorageFault
            The earlier fault, if any.

        """
        if name in self._topics:
            raise BadInput(f"The topic '{name}' is in the bag already; add each topic only once.")
        definition = generate_definition(type_name) if isinstance(type_name, str) else type_name
        self._check_fault()
        channel = self._mcap.add_channel(name, definition, format_offered_qos(qos))
        self._topics[name] = TopicRecord(name, definition, list(qos), channel)

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Update a topic's offered QoS profiles, for metadata.yaml."""
        self._topics[name].qos = list(qos)

    def write(
        self, topic: str, data: bytes, log_time_ns: int, publish_time_ns: int | None = None
    ) -> None:
        """
        Record one message.

        Parameters
        ----------
        topic : str
            Name of an added topic.
        data : bytes
            The message as CDR with its encapsulation header.
        log_time_ns : int
            Time of reception, not negative. [ns]
        publish_time_ns : int, optional
            Time of publication if known; by default the log time. [ns]

        Raises
        ------
        KeyError
            If the topic was not added.
        StorageFault
            If the disk is full or broken: messages since the last whole chunk are lost, and
            every later call raises the same fault.

        """
        if self._fault is not None:
            raise self._fault
        record = self._topics[topic]
        # Counted before writing, so that lost_count includes a message whose write fails
        record.written += 1
        try:
            self._mcap.add_message(
                record.channel, record.written, log_time_ns, data, publish_time_ns
            )
        except StorageFault as fault:
            self._fault = fault
            raise

    def flush(self) -> None:
        """
        Hand everything written so far to the operating system.

        Raises
        ------
        StorageFault
            As `write` does.

        """
        self._check_fault()
        try:
            self._mcap.flush()
            # metadata.yaml lists the topics, so rewrite it only when one was added
            if self._described < len(self._topics):
                self._write_metadata()
        except StorageFault as fault:
            self._fault = fault
            raise

    def update_metadata(self) -> None:
        """Update metadata.yaml, so that it is right even after a SIGKILL."""
        self._write_metadata()

    def check_room(self) -> None:
        """Raise `DiskNearlyFull` if the disk has little more room than closing needs."""
        check_room(self.path, self.required_closing_space)

    def close(self) -> None:
        """
        Finish the bag; a second call does nothing.

        Raises
        ------
        StorageFault
            If the bag could not be finished and no earlier call raised the fault.

        """
        if not self._open:
            return
        self._open = False
        earlier_fault = self._fault
        # Try every step even after a fault: each makes the bag more complete.
        for step in (
            self._mcap.flush,
            self._mcap.close,
            self._write_metadata,
            self._fsync_metadata,
        ):
            try:
                step()
            except StorageFault as fault:
                self._fault = self._fault or fault
        # An earlier fault was raised when it happened
        if earlier_fault is None and self._fault is not None:
            raise self._fault

    @property
    def message_count(self) -> int:
        """Return the number of messages in the file."""
        return self._mcap.counts.total()

    @property
    def lost_count(self) -> int:
        """Return how many accepted messages are neither in a file nor waiting for a flush."""
        accepted = sum(record.written for record in self._topics.values())
        return accepted - self.message_count - self._mcap.pending_count

    def _check_fault(self) -> None:
        """Raise the earlier fault, if any."""
        if self._fault is not None:
            raise self._fault

    def _fsync_metadata(self) -> None:
        """Sync metadata.yaml, so that the bag survives a power cut; slow on a slow disk."""
        fsync_file(self.path / METADATA_FILE)

    def _write_metadata(self) -> None:
        """Write metadata.yaml with the present topics and messages."""
        topics = list(self._topics.values())
        write_metadata(self.path, build_bag_metadata(self._mcap, topics, self._provenance))
        self._described = len(topics)

    def __enter__(self) -> Self:
        """Return the writer."""
        return self

    def __exit__(self, *_: object) -> None:
        """Finish the bag, also after an error."""
        self.close()
