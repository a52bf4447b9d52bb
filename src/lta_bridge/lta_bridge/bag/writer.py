"""
The bag a flight is recorded into.

A rosbag2 folder (metadata.yaml version 9) with one MCAP file, or several that can each be read
alone: profile ros2, messages as CDR, definitions inside, zstd chunks with CRC, chunk and message
indexes. Everything up to the last `flush` survives the death of the process; a full or broken disk
ends the recording, not the bag.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import final, Self

from lta_bridge.bag.chunk import CompressedChunk
from lta_bridge.bag.mcap_file import McapFile
from lta_bridge.bag.metadata import BagFileEntry, build_metadata, NAME, TopicRecord, write_metadata
from lta_bridge.bag.qos import format_offered_qos, OfferedQos
from lta_bridge.bag.records import PROVENANCE
from lta_bridge.bag.schemas import generate_definition, MessageDefinition
from lta_bridge.bag.split import SplitLimits, WHOLE
from lta_bridge.bag.storage import check_room, StorageFault, sync_file
from lta_config.errors import BadInput

LIBRARY = 'lta'


def prepare_empty_folder(path: Path) -> Path:
    """
    Return `path` as an empty folder, made if it was not there.

    Raises
    ------
    BadInput
        If it holds something or cannot be made.

    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        busy = any(path.iterdir())
    except OSError as error:
        raise BadInput(
            f"Folder '{path}' cannot be made ({error.strerror}); choose another place."
        ) from error
    if busy:
        raise BadInput(f"'{path}' is not empty; choose another folder.")
    return path


@final
class BagWriter:
    """
    Writes one bag; use it as a context manager, or call `close`.

    Parameters
    ----------
    path : Path
        Folder of the bag; made if missing, refused if it holds anything.
    provenance : mapping of str to str
        Where the data come from (commit, seed, scenario); kept in metadata.yaml and in each MCAP.
    split : Split
        When the next file begins: never, unless it says so.

    Raises
    ------
    BadInput
        If the folder cannot be used.
    StorageFault
        If the disk cannot even take the beginning.

    """

    def __init__(
        self, path: Path, provenance: Mapping[str, str], split: SplitLimits = WHOLE
    ) -> None:
        self.path = prepare_empty_folder(Path(path))
        self._provenance = dict(provenance)
        self._split = split
        self._topics: dict[str, TopicRecord] = {}
        self._described = 0
        self._fault: StorageFault | None = None
        self._open = True
        self._parts: list[BagFileEntry] = []
        self._first: int | None = None
        self._mcap = self._create_file(0)
        self._write_metadata()

    @property
    def closing_size(self) -> int:
        """Space that `close` still needs: stop recording before less is left. [bytes]"""
        described = 1024 * (4 + len(self._topics)) + 256 * len(self._parts)
        return self._mcap.summary_size + described

    def add_topic(
        self, name: str, type_name: str | MessageDefinition, qos: Sequence[OfferedQos]
    ) -> None:
        """
        Announce a topic; it appears in the bag even if no message ever comes.

        Parameters
        ----------
        name : str
            Absolute name, for example '/lta1/odom'.
        type_name : str or Definition
            For example 'nav_msgs/msg/Odometry'; a type that ROS 2 Jazzy does not have comes with
            its definition.
        qos : sequence of Profile
            What its publishers offer; see `offered_qos`.

        Raises
        ------
        BadInput
            If the type is unknown or the topic is announced already.
        StorageFault
            If the disk is full or broken.

        """
        if name in self._topics:
            raise BadInput(f"Topic '{name}' is in the bag already; announce each topic once.")
        found = generate_definition(type_name) if isinstance(type_name, str) else type_name
        self._check_fault()
        try:
            channel = self._mcap.add_channel(name, found, format_offered_qos(qos))
        except StorageFault as fault:
            self._fault = fault
            raise
        self._topics[name] = TopicRecord(name, found, list(qos), channel)

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Tell what a topic's publishers offer by now, for metadata.yaml and the next file."""
        self._topics[name].qos = list(qos)

    def write(
        self, topic: str, data: bytes, log_time_ns: int, publish_time_ns: int | None = None
    ) -> None:
        """
        Record one message.

        Parameters
        ----------
        topic : str
            An announced topic; another one is a KeyError.
        data : bytes
            The message as CDR with its encapsulation header.
        log_time_ns : int
            When it was received, not negative. [ns]
        publish_time_ns : int, optional
            When it was published, if that is known to be another time. [ns]

        Raises
        ------
        StorageFault
            If the disk is full or broken: messages since the last whole chunk are lost, and
            nothing more is taken.

        """
        if self._fault is not None:
            raise self._fault
        record = self._topics[topic]
        record.written += 1
        try:
            if self._split is not WHOLE:
                self._split_if_due(log_time_ns)
            self._mcap.add_message(
                record.channel, record.written, log_time_ns, data, publish_time_ns
            )
        except StorageFault as fault:
            self._fault = fault
            raise

    def add_chunk(self, compressed: CompressedChunk) -> None:
        """Record packed messages, channels numbered as the topics here; raises as `write` does."""
        self.flush()
        for record in self._topics.values():
            record.written += compressed.message_counts.get(record.channel, 0)
        try:
            self._mcap.add_chunk(compressed)
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
            if self._described < len(self._topics):
                self._write_metadata()
        except StorageFault as fault:
            self._fault = fault
            raise

    def update_metadata(self) -> None:
        """Bring metadata.yaml up to date, for whoever finds the bag after a SIGKILL."""
        self._write_metadata()

    def check_room(self) -> None:
        """Raise `NearlyFull` when the disk has little more room than closing needs."""
        check_room(self.path, self.closing_size)

    def close(self) -> None:
        """
        Finish the bag; closing twice does nothing.

        Raises
        ------
        StorageFault
            If the bag could not be finished and no earlier call has said so.

        """
        if not self._open:
            return
        self._open = False
        told = self._fault
        for step in (self._mcap.flush, self._mcap.close, self._write_metadata, self._sync_files):
            try:
                step()
            except StorageFault as fault:
                self._fault = self._fault or fault
        if told is None and self._fault is not None:
            raise self._fault

    @property
    def message_count(self) -> int:
        """Messages in the files."""
        return sum(part.message_count for part in self._parts) + self._mcap.counts.total()

    @property
    def lost_count(self) -> int:
        """Messages that were accepted and are neither in a file nor waiting for a flush."""
        accepted = sum(record.written for record in self._topics.values())
        return accepted - self.message_count - self._mcap.pending_count

    def _check_fault(self) -> None:
        """Refuse to go on after a fault."""
        if self._fault is not None:
            raise self._fault

    def _create_file(self, number: int) -> McapFile:
        """Return a file, with everything in it that reading it alone takes."""
        name = f'{self.path.resolve().name}_{number}.mcap'
        mcap = McapFile(self.path / name, LIBRARY)
        try:
            mcap.add_metadata(PROVENANCE, self._provenance)
            for record in self._topics.values():  # in the order of their channels' numbers
                mcap.add_channel(record.name, record.definition, format_offered_qos(record.qos))
        except BaseException:
            mcap.discard()
            raise
        return mcap

    def _split_if_due(self, log_time_ns: int) -> None:
        """Go on in the next file before a message, if that is due. [ns]"""
        self._first = log_time_ns if self._first is None else self._first
        size = self._mcap.size if self._mcap.counts else 0  # what all files begin with fills none
        if self._split.is_exceeded(size, log_time_ns - self._first):
            self._mcap.flush()
            # The old file is closed once the next one stands, and no message is in a file that
            # metadata.yaml does not list: whenever the process dies, the bag is whole.
            following, full = self._create_file(len(self._parts) + 1), self._mcap
            self._parts.append(self._describe_file(full))
            self._mcap = following
            self._first = log_time_ns
            full.close(sync=False)  # a slow disk must not keep the next messages waiting
            self._write_metadata()

    def _describe_file(self, mcap: McapFile) -> BagFileEntry:
        """Return what metadata.yaml tells of a file as it stands."""
        return BagFileEntry(mcap.path.name, mcap.start, mcap.end, Counter(mcap.counts))

    def _sync_files(self) -> None:
        """Make the whole bag safe from a power cut; a slow disk may take long."""
        for name in (*(part.name for part in self._parts), NAME):
            sync_file(self.path / name)

    def _write_metadata(self) -> None:
        """Write metadata.yaml as things stand."""
        topics = list(self._topics.values())
        parts = [*self._parts, self._describe_file(self._mcap)]
        write_metadata(self.path, build_metadata(parts, topics, self._provenance))
        self._described = len(topics)

    def __enter__(self) -> Self:
        """Return the writer."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the bag, whatever happened."""
        self.close()
