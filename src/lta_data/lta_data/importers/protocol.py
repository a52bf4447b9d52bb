"""Define the interface of log readers: tables of numbers, and messages to pass on unchanged."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import final, NamedTuple, Protocol

from lta_bridge.bag.qos import OfferedQos
from lta_bridge.bag.schemas import MessageDefinition
from lta_data.importers.log_table import LogTable

Reached = Callable[[float], None]  # called with the fraction of the log read so far, 0 to 1


@final
class PassThroughMessage(NamedTuple):
    """A message passed on unchanged: position in the log, its topic, log time in ns, and CDR."""

    order: int
    topic: str
    log_time: int
    data: bytes


@final
@dataclass(frozen=True, slots=True)
class RawTopic:
    """A topic of a bag: its definition and the offered quality of service."""

    definition: MessageDefinition
    qos: Sequence[OfferedQos] = ()


class LogReader(Protocol):
    """An opened log."""

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """The columns of each table; a format with a single table names it ''."""
        ...

    @property
    def raw(self) -> Mapping[str, RawTopic]:
        """Topics whose messages can be passed on unchanged; empty if a format has none."""
        ...

    @property
    def notes(self) -> list[str]:
        """Remarks on missing or odd data, one sentence each; grows while the log is read."""
        ...

    @property
    def facts(self) -> dict[str, str]:
        """The log's own provenance."""
        ...

    @property
    def timed(self) -> Sequence[str]:
        """Columns that were used as times."""
        ...

    def read_tables(self, selection: Mapping[str, Collection[str]]) -> Mapping[str, LogTable]:
        """Return the selected tables, with the selected columns at least; all if none is."""
        ...

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield all messages of `raw` in the order of recording."""
        ...


@final
@dataclass(slots=True)
class InMemoryLog:
    """A log whose tables are read on opening."""

    content: Mapping[str, LogTable]
    notes: list[str]
    facts: dict[str, str]
    raw: Mapping[str, RawTopic] = field(default_factory=dict)
    timed: Sequence[str] = ('timestamp_sample',)

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """The columns of each table."""
        return {name: list(table.columns) for name, table in self.content.items()}

    def read_tables(self, selection: Mapping[str, Collection[str]]) -> Mapping[str, LogTable]:
        """Return the selected tables."""
        return {name: self.content[name] for name in selection}

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield nothing: these logs contain no ROS messages."""
        yield from ()
