"""rosbag2 recordings in MCAP, by our own reader: of a damaged one, what is whole."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import cast, final

from lta_bridge.bag.qos import Profile
from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_config.schema.import_file import Mapping as MappingFile
from lta_data.bag.folder import bag_files
from lta_data.bag.reader import Bag, file_contents, read_bag
from lta_data.foreign.protocol import Passed, Raw, Reached
from lta_data.foreign.readers.bag_rows import BagTables, Decode, tables_of, wanted_tables
from lta_data.foreign.readers.definitions import from_bag

LOOK = 2000  # messages between two movements of the bar


def opened(path: Path, mapping: MappingFile | None) -> 'McapLog':
    """Return a recording in MCAP; `BadInput` if there is none."""
    try:
        return McapLog(path, mapping)
    except UnicodeDecodeError:
        raise BadInput(
            f"The names in '{path}' are damaged; import what is left of it from a copy."
        ) from None


@final
class McapLog(BagTables):
    """An opened recording; see `protocol.Log`."""

    timed: Sequence[str] = ()

    def __init__(self, path: Path, mapping: MappingFile | None) -> None:
        self._bag = read_bag(path)
        self.notes: list[str] = []
        self.facts = {f'original_{key}': text for key, text in self._bag.provenance.items()}
        self.raw: Mapping[str, Raw] = _raw(self._bag, path)
        self._total = max(1, sum(topic.count for topic in self._bag.topics.values()))
        self._tables = tables_of(wanted_tables(mapping), self.raw, self._each())
        if not any(topic.count for topic in self._bag.topics.values()):
            raise BadInput(f"'{path}' holds no message; nothing to import.")

    def messages(self, reached: Reached) -> Iterator[Passed]:
        """Yield all messages in the order of recording."""
        for order, (topic, log_time, data) in enumerate(self._bag.messages(list(self.raw))):
            if order % LOOK == 0:
                reached(min(1.0, order / self._total))
            yield Passed(order, topic, log_time, data)
        self.notes += [loss for loss in self._bag.losses if loss not in self.notes]

    def _each(self) -> Iterator[tuple[str, int, Decode]]:
        """Yield topic, log time in ns and how to decode it, of every message."""
        for topic, log_time, data in self._bag.messages(list(self.raw)):
            yield topic, log_time, partial(self._message, topic, data)

    def _message(self, topic: str, data: bytes) -> object:
        """Return a decoded message."""
        try:
            return self._bag.decode(topic, data)
        except KeyError as part:
            raise BadInput(
                f"The definition of '{topic}' lacks {part}; take it out of the mapping."
            ) from None


def _raw(bag: Bag, path: Path) -> dict[str, Raw]:
    """Return the topics with their definitions, whatever they are written in."""
    found: dict[str, Raw] = {}
    for file in bag_files(path):
        contents = file_contents(file)
        for channel in contents.channels.values():
            known = from_bag(channel, contents.schemas.get(channel.schema_id))
            qos = profiles(channel.metadata.get('offered_qos_profiles', ''))
            found.setdefault(channel.topic, Raw(known, qos))
    return {name: raw for name, raw in found.items() if name in bag.topics}


def profiles(text: str) -> list[Profile]:
    """Return the profiles that rosbag2 wrote from version 9 on; older ones are numbers."""
    try:
        told = parse_yaml(text, 'the QoS')
    except BadInput:
        return []
    named = isinstance(told, list) and all(
        isinstance(one, dict) and isinstance(one.get('history'), str) for one in told
    )
    return cast('list[Profile]', told) if named else []
