"""Keep the most recent messages in memory and write them to a bag on request."""

from collections import Counter, deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import final, NamedTuple

from lta_bridge.bag.chunk import ChunkBuilder, CompressedChunk
from lta_bridge.bag.mcap_file import CHUNK_SIZE
from lta_bridge.bag.metadata import TopicRecord
from lta_bridge.bag.qos import is_latched, OfferedQos
from lta_bridge.bag.schemas import generate_definition
from lta_bridge.bag.writer import BagWriter, prepare_empty_folder

GRAIN_NS = 500_000_000  # longest chunk in log time: up to this much beyond the span is kept
ACCUMULATED = '/tf_static'  # a message does not replace those before it
WHY = 'snapshot'  # provenance key of the reason for a snapshot


class Snapshot(NamedTuple):
    """A written snapshot: the folder of the bag and its number of messages."""

    path: Path
    messages: int


@final
class SnapshotBuffer:
    """
    Buffer messages like a `BagWriter`, and discard old ones.

    Whole chunks are discarded, so slightly more than the span is kept if memory allows. The last
    message of a latched (transient local) topic is always kept, and every message on /tf_static,
    where each robot publishes its own.

    Parameters
    ----------
    folder : Path
        Parent folder of the snapshots, each a separate bag; created if missing, must be empty.
    provenance : mapping of str to str
        Stored in each snapshot.
    span_ns : int
        Log time to keep. [ns]
    room : int
        Memory limit of the chunks. [bytes]

    Raises
    ------
    BadInput
        If the folder cannot be used.

    """

    def __init__(
        self, folder: Path, provenance: Mapping[str, str], span_ns: int, room: int
    ) -> None:
        self.path = prepare_empty_folder(Path(folder))
        self._provenance = dict(provenance)
        self._span_ns = span_ns
        self._room = room
        self._topics: dict[str, TopicRecord] = {}
        self._builder = ChunkBuilder()
        self._chunks: deque[CompressedChunk] = deque()
        self._latched: dict[str, dict[bytes, int]] = {}  # by topic: messages and log times
        self._newest = 0
        self.size = 0
        self.saved = 0

    def add_topic(self, name: str, type_name: str, qos: Sequence[OfferedQos]) -> None:
        """Add a topic; see `BagWriter.add_topic`."""
        record = TopicRecord(
            name, generate_definition(type_name), list(qos), len(self._topics) + 1
        )
        self._topics[name] = record

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Update the QoS profiles that a topic's publishers offer."""
        self._topics[name].qos = list(qos)

    def write(self, topic: str, data: bytes, log_time_ns: int) -> None:
        """Buffer one message."""
        record = self._topics[topic]
        record.written += 1
        self._builder.add(record.channel, record.written, log_time_ns, data)
        # Latched messages are sent once, so keep the last one beyond the span
        if is_latched(record.qos):
            messages = self._latched.get(topic, {}) if topic == ACCUMULATED else {}
            self._latched[topic] = messages | {data: log_time_ns}
        self._newest = max(self._newest, log_time_ns)
        if self._builder.size >= CHUNK_SIZE or self._builder.span >= GRAIN_NS:
            self._pack_chunk()

    def flush(self) -> None:
        """Do nothing: the buffer is in memory only."""

    def update_metadata(self) -> None:
        """Do nothing: each snapshot writes its own metadata."""

    def check_room(self) -> None:
        """Do nothing: `write_snapshot` checks the room on the disk."""

    def close(self) -> None:
        """Discard all messages."""
        self._chunks.clear()
        self._latched.clear()

    @property
    def is_empty(self) -> bool:
        """Whether the buffer holds no message."""
        return not (self._chunks or self._builder.size or self._latched)

    @property
    def lost_count(self) -> int:
        """Number of messages lost to a storage fault: always 0."""
        return 0

    def write_snapshot(self, why: str) -> Snapshot:
        """
        Write all buffered messages to a new bag; the buffer keeps them.

        `why` is the reason, which is stored in the provenance.

        Raises
        ------
        StorageFault
            If the disk is full or broken; the part that was written is a readable bag.

        """
        if self._builder.size:
            self._pack_chunk()
        path = self.path / f'{WHY}_{self.saved}'
        # Before writing: a failed snapshot leaves its folder, so the next needs another name
        self.saved += 1
        counts: Counter[int] = Counter()
        for chunk in self._chunks:
            counts.update(chunk.message_counts)
        with BagWriter(path, self._provenance | {WHY: why}) as bag:
            for record in self._topics.values():
                bag.add_topic(record.name, record.definition.type_name, record.qos)
            # Latched messages are older than the chunks: write them unless the chunks have them.
            for name, messages in self._latched.items():
                if counts[self._topics[name].channel] < len(messages):
                    for data, log_time in messages.items():
                        bag.write(name, data, log_time)
            for chunk in self._chunks:
                bag.check_room()
                bag.add_chunk(chunk)
            bag.flush()
            return Snapshot(path, bag.message_count)

    def _pack_chunk(self) -> None:
        """Compress the pending messages into a chunk, and discard the oldest chunks."""
        chunk = self._builder.build_chunk()
        self._chunks.append(chunk)
        self.size += chunk.memory_size
        oldest = self._newest - self._span_ns
        # Whole chunks only: their messages are compressed together
        while self._chunks and (self._chunks[0].end < oldest or self.size > self._room):
            self.size -= self._chunks.popleft().memory_size
