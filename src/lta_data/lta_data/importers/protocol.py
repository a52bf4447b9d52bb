"""What a reader of one format gives: tables of numbers, or messages to be passed on."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import final, NamedTuple, Protocol

from lta_bridge.bag.qos import OfferedQos
from lta_bridge.bag.schemas import MessageDefinition
from lta_data.importers.log_table import LogTable

Reached = Callable[[float], None]  # told how much of a log has been read, from 0 to 1


@final
class PassedMessage(NamedTuple):
    """A message that is passed on: its place in the log, topic there, log time in ns, and CDR."""

    order: int
    topic: str
    log_time: int
    data: bytes


@final
@dataclass(frozen=True, slots=True)
class RawTopic:
    """A topic of a bag: its definition, and the quality of service that was offered."""

    definition: MessageDefinition
    qos: Sequence[OfferedQos] = ()


class LogReader(Protocol):
    """An opened log."""

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """The columns of each table; a format with one table calls it ''."""
        ...

    @property
    def raw(self) -> Mapping[str, RawTopic]:
        """Topics that can be passed on as they are; empty where a format has none."""
        ...

    @property
    def notes(self) -> list[str]:
        """What is missing or odd, one sentence each; grows while it is read."""
        ...

    @property
    def facts(self) -> dict[str, str]:
        """What the log says of its own origin."""
        ...

    @property
    def timed(self) -> Sequence[str]:
        """Columns that became the times."""
        ...

    def iterate_tables(
        self, selection: Mapping[str, Collection[str]], reached: Reached
    ) -> Iterator[Mapping[str, LogTable]]:
        """Yield the wanted columns of the wanted tables, part by part of the log."""
        ...

    def iterate_messages(self, reached: Reached) -> Iterator[PassedMessage]:
        """Yield all messages of `raw` in the order of recording."""
        ...


@final
@dataclass(slots=True)
class TableLog:
    """A log that was read whole: every format but text and bags."""

    content: Mapping[str, LogTable]
    notes: list[str]
    facts: dict[str, str]
    raw: Mapping[str, RawTopic] = field(default_factory=dict)
    timed: Sequence[str] = ('timestamp_sample',)

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """The columns of each table."""
        return {name: list(table.columns) for name, table in self.content.items()}

    def iterate_tables(
        self, selection: Mapping[str, Collection[str]], reached: Reached
    ) -> Iterator[Mapping[str, LogTable]]:
        """Yield the wanted tables at once."""
        reached(0.5)
        yield {name: self.content[name] for name in selection}

    def iterate_messages(self, reached: Reached) -> Iterator[PassedMessage]:
        """Yield nothing: these logs have no messages of ROS."""
        yield from ()
