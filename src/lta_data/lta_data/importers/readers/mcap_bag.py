"""Read rosbag2 recordings in MCAP, including the intact part of damaged ones."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import final

from lta_config.errors import BadInput
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_data.bag.bag_folder import find_bag_files
from lta_data.bag.reader import Bag, read_bag, read_file_contents
from lta_data.bag.recover import parse_qos_profiles
from lta_data.importers.protocol import PassThroughMessage, RawTopic, Reached
from lta_data.importers.readers.bag_tables import (
    BagTableLog,
    build_tables,
    Decode,
    list_mapping_tables,
    read_bag_definition,
)

LOOK = 2000  # messages between two updates of the progress bar


def open_mcap_log(path: Path, mapping: MappingFile | None) -> 'McapLog':
    """Open a recording in MCAP; raise `BadInput` if there is none."""
    try:
        return McapLog(path, mapping)
    except UnicodeDecodeError:
        raise BadInput(
            f"The topic names in '{path}' are damaged; import an intact copy."
        ) from None


@final
class McapLog(BagTableLog):
    """An opened recording; see `protocol.LogReader`."""

    timed: Sequence[str] = ()

    def __init__(self, path: Path, mapping: MappingFile | None) -> None:
        self._bag = read_bag(path)
        self.notes: list[str] = []
        # Prefixed, since the new bag gets its own provenance
        self.facts = {f'original_{key}': text for key, text in self._bag.provenance.items()}
        self.raw: Mapping[str, RawTopic] = _list_raw_topics(self._bag, path)
        self._total = max(1, sum(topic.count for topic in self._bag.topics.values()))
        self._tables = build_tables(
            list_mapping_tables(mapping), self.raw, self._iterate_decodable()
        )
        if not any(topic.count for topic in self._bag.topics.values()):
            raise BadInput(f"'{path}' contains no message; give a bag with messages.")

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield all messages in the order of recording."""
        for order, (topic, log_time, data) in enumerate(
            self._bag.iterate_messages(list(self.raw))
        ):
            if order % LOOK == 0:
                reached(min(1.0, order / self._total))
            yield PassThroughMessage(order, topic, log_time, data)
        # At the end, since some damage is detected only while reading
        self.notes += [loss for loss in self._bag.losses if loss not in self.notes]

    def _iterate_decodable(self) -> Iterator[tuple[str, int, Decode]]:
        """Yield topic, log time in ns and a decoding function of every message."""
        for topic, log_time, data in self._bag.iterate_messages(list(self.raw)):
            yield topic, log_time, partial(self._decode_message, topic, data)

    def _decode_message(self, topic: str, data: bytes) -> object:
        try:
            return self._bag.decode(topic, data)
        except KeyError as part:
            raise BadInput(
                f"The message definition of topic '{topic}' lacks {part}; remove the topic "
                'from the mapping.'
            ) from None


def _list_raw_topics(bag: Bag, path: Path) -> dict[str, RawTopic]:
    """Return the topics with their definitions, whatever their encoding."""
    topics: dict[str, RawTopic] = {}
    for file in find_bag_files(path):
        contents = read_file_contents(file)
        for channel in contents.channels.values():
            # A channel without a schema gets None
            definition = read_bag_definition(channel, contents.schemas.get(channel.schema_id))
            qos = parse_qos_profiles(channel)
            topics.setdefault(channel.topic, RawTopic(definition, qos))
    return {name: raw for name, raw in topics.items() if name in bag.topics}
