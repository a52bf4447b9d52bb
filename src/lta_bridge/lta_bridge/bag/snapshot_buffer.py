"""The last seconds of everything, kept in memory until somebody wants them on the disk."""

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

GRAIN_NS = 500_000_000  # log time in a chunk at most: by so much more than asked for is kept
WHY = 'snapshot'  # key of the provenance under which a snapshot says what it was written for


class Snapshot(NamedTuple):
    """A bag of what was in memory: where it is, and its messages."""

    path: Path
    messages: int


@final
class SnapshotBuffer:
    """
    Takes what a `BagWriter` takes, and forgets what is old.

    Whole chunks are forgotten, so that a little more than the span is kept where memory allows.
    The last message of a topic whose publishers all keep it for late joiners is never forgotten.

    Parameters
    ----------
    folder : Path
        Where the snapshots go, each a bag of its own; made if missing, refused if not empty.
    provenance : mapping of str to str
        Goes into each snapshot.
    span_ns : int
        Log time to keep. [ns]
    room : int
        Most memory of the chunks. [bytes]

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
        self._latched: dict[str, tuple[bytes, int]] = {}
        self._newest = 0
        self.size = 0
        self.saved = 0

    def add_topic(self, name: str, type_name: str, qos: Sequence[OfferedQos]) -> None:
        """Announce a topic, as to a `BagWriter`."""
        record = TopicRecord(
            name, generate_definition(type_name), list(qos), len(self._topics) + 1
        )
        self._topics[name] = record

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Tell what a topic's publishers offer by now."""
        self._topics[name].qos = list(qos)

    def write(self, topic: str, data: bytes, log_time_ns: int) -> None:
        """Keep one message for a while."""
        record = self._topics[topic]
        record.written += 1
        self._builder.add(record.channel, record.written, log_time_ns, data)
        if is_latched(record.qos):
            self._latched[topic] = data, log_time_ns
        self._newest = max(self._newest, log_time_ns)
        if self._builder.size >= CHUNK_SIZE or self._builder.span >= GRAIN_NS:
            self._pack_chunk()

    def flush(self) -> None:
        """Do nothing: what is in memory dies with the process."""

    def update_metadata(self) -> None:
        """Do nothing: a snapshot is described when it is written."""

    def check_room(self) -> None:
        """Do nothing: a snapshot finds out."""

    def close(self) -> None:
        """Forget everything."""
        self._chunks.clear()
        self._latched.clear()

    @property
    def is_empty(self) -> bool:
        """Whether nothing is kept."""
        return not (self._chunks or self._builder.size or self._latched)

    @property
    def lost_count(self) -> int:
        """Messages that a fault of the disk cost: none."""
        return 0

    def write_snapshot(self, why: str) -> Snapshot:
        """
        Write a bag of everything in memory, which stays there.

        Parameters
        ----------
        why : str
            What for; goes into the provenance.

        Raises
        ------
        StorageFault
            If the disk takes no more; what it took is a bag that can be read.

        """
        if self._builder.size:
            self._pack_chunk()
        path = self.path / f'{WHY}_{self.saved}'
        self.saved += 1
        counts: Counter[int] = Counter()
        for chunk in self._chunks:
            counts.update(chunk.message_counts)
        with BagWriter(path, self._provenance | {WHY: why}) as bag:
            for record in self._topics.values():
                bag.add_topic(record.name, record.definition.type_name, record.qos)
            for name, (data, log_time) in self._latched.items():
                if not counts[self._topics[name].channel]:
                    bag.write(name, data, log_time)
            for chunk in self._chunks:
                bag.check_room()
                bag.add_chunk(chunk)
            bag.flush()
            return Snapshot(path, bag.message_count)

    def _pack_chunk(self) -> None:
        """Pack what has come since the last chunk, and forget what is too old or too much."""
        chunk = self._builder.build_chunk()
        self._chunks.append(chunk)
        self.size += chunk.memory_size
        oldest = self._newest - self._span_ns
        while self._chunks and (self._chunks[0].end < oldest or self.size > self._room):
            self.size -= self._chunks.popleft().memory_size
