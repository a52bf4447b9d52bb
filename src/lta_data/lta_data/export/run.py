"""Export a recording to one format, as one file per topic or one aligned file."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from csv import writer
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
import re
from typing import Final, final, Protocol

from lta_bridge.bag.writer import prepare_empty_folder
from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput, unknown_name_error
from lta_data.bag.packed_samples import LIGHT_BLOCK
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.export.mat_file import write_mat
from lta_data.export.source import build_table_source, build_topic_source, ExportSource
import pyarrow as arrow
from pyarrow import csv, parquet


def write_parquet(source: ExportSource, path: Path) -> Iterator[arrow.Table]:
    """Write a file with a row group for each part, and yield the parts."""
    parts = source.iterate_arrow()
    first = next(parts)
    with parquet.ParquetWriter(path, first.schema, compression='zstd') as file:
        for part in chain([first], parts):
            file.write_table(part)
            yield part


def write_csv(source: ExportSource, path: Path) -> Iterator[arrow.Table]:
    """Write one line of names and one per row, and yield the parts."""
    parts = source.iterate_arrow()
    first = next(parts)
    with csv.CSVWriter(path, first.schema.remove_metadata()) as file:
        for part in chain([first], parts):
            file.write_table(part)
            yield part


FORMATS: Final[dict[str, Callable[[ExportSource, Path], Iterator[arrow.Table]]]] = {
    'parquet': write_parquet,
    'csv': write_csv,
    'mat': write_mat,
}
ALIGNED: Final = 'aligned'
UNITS: Final = 'units.csv'  # beside the files of CSV


class ExportObserver(Protocol):
    """Observer of an export."""

    def show_topic(self, topic: str, done: int, total: int) -> None:
        """Report the topic being written, and how many are done."""
        ...


@final
@dataclass(frozen=True, slots=True)
class ExportRequest:
    """Options of an export."""

    form: str  # one of `FORMATS`
    topics: tuple[str, ...] = ()  # names; all if empty
    # Rate of the common clock, for one aligned file; None for a file per topic [Hz]
    rate: float | None = None
    method: str = 'previous'  # how columns are resampled to that clock; see `lta_data.bag.align`


@final
@dataclass(frozen=True, slots=True)
class ExportedFile:
    """One file: topic, path and size of its table."""

    topic: str
    file: Path
    rows: int
    columns: int


@final
@dataclass(frozen=True, slots=True)
class ExportResult:
    """The files, and a remark for everything left out."""

    files: list[ExportedFile]
    remarks: list[str]


def export_recording(
    flight: RecordedFlight, order: ExportRequest, folder: Path, watcher: ExportObserver
) -> ExportResult:
    """
    Write a recording to a folder.

    Raise `BadInput` if the format or a named topic is unknown, the topic cannot be decoded, the
    folder is not empty, or the files cannot be written.
    """
    if order.form not in FORMATS:
        raise unknown_name_error('format', order.form, list(FORMATS))
    topics = select_topics(flight, order.topics)
    done = ExportResult([], [])
    units: list[tuple[str, str, str, str]] = []
    try:
        if order.rate is not None:
            tables = align_export_topics(flight, topics, order, done)
            prepare_empty_folder(folder)
            watcher.show_topic(ALIGNED, 0, 1)
            units += write_source_file(tables, folder, order.form, done)
        else:
            prepare_empty_folder(folder)
            for index, topic in enumerate(topics):
                watcher.show_topic(topic, index, len(topics))
                try:
                    source = build_topic_source(flight, topic)
                except BadInput as fault:
                    # A topic named by the user must not be left out silently
                    if order.topics:
                        raise
                    done.remarks.append(f"Topic '{topic}' is left out: {fault}")
                    continue
                units += write_source_file(source, folder, order.form, done)
        if order.form == 'csv':
            write_units(units, folder)
        done.remarks.extend(flight.losses)  # some damage is detected only while reading
    except OSError as error:
        raise BadInput(
            f"The files cannot be written to '{folder}' ({error.strerror or error}); check "
            'that it is writable and has free space, or choose another folder with --out.'
        ) from error
    return done


def select_topics(flight: RecordedFlight, topics: Sequence[str]) -> list[str]:
    """Return the named topics, or all of the robot and the global ones."""
    for topic in topics:
        flight.message_type(topic)
    if topics:
        # Each topic once, in the given order
        return list(dict.fromkeys(topics))
    # A topic with one slash, such as /tf, belongs to no robot.
    shared = [name for name in flight.bag.topics if name.count('/') == 1]
    return flight.topics + (shared if flight.robot else [])


def align_export_topics(
    flight: RecordedFlight, topics: Sequence[str], order: ExportRequest, done: ExportResult
) -> ExportSource:
    """Align all topics; light blocks and topics that cannot be decoded are left out."""
    usable = []
    for topic in topics:
        try:
            if flight.message_type(topic) == LIGHT_BLOCK:
                raise BadInput(
                    'light blocks cannot be resampled; omit --rate to export this topic.'
                )
            flight[topic]
        except BadInput as fault:
            if order.topics:
                raise BadInput(f"Topic '{topic}' cannot be aligned: {fault}") from fault
            done.remarks.append(f"Topic '{topic}' is left out: {fault}")
            continue
        usable.append(topic)
    table = flight.align_topics(*usable, rate=order.rate, method=order.method)
    return build_table_source(table, ALIGNED)


def write_source_file(
    source: ExportSource, folder: Path, form: str, done: ExportResult
) -> list[tuple[str, str, str, str]]:
    """Write one file atomically; return its name, the topic, and name and unit of each column."""
    # Only letters, digits and underscores are safe in file names on every system
    name = re.sub(r'\W+', '_', source.name).strip('_') or 'topic'
    taken = {exported.file.stem for exported in done.files}
    # '/odom' and 'odom' would give the same file name.
    while name in taken:
        name += '_'
    path = folder / f'{name}.{form}'
    rows, columns = 0, list[str]()
    with replace_atomically(path) as part:
        for table in FORMATS[form](source, part):
            rows, columns = rows + len(table), table.column_names
    done.files.append(ExportedFile(source.name, path, rows, len(columns)))
    if source.remark:
        done.remarks.append(source.remark)
    return [(path.name, source.name, column, source.units.get(column, '')) for column in columns]


def write_units(rows: Iterable[tuple[str, str, str, str]], folder: Path) -> None:
    """Write the unit of each column of each file; '' if unknown."""
    with (folder / UNITS).open('w', newline='', encoding='utf-8') as file:
        writer(file).writerows([('file', 'topic', 'column', 'unit'), *rows])
