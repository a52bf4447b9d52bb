# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Export a recording to one format, as one file per topic or one aligned file.

Light blocks become one row per sample, lamp peaks one row per beacon and diode, a part of the
topic at a time. The packed bytes of other messages, such as pixels, are left out.

`odom.pose.pose.position.x` is a column, `odom.pose.covariance` a matrix with a row per message,
and `units.pose.pose.position.x` is 'm'. A MATLAB variable is written at once, so the topic must
fit into memory and into 2 GB.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from csv import writer
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
import re
from typing import Any, Final, final, NamedTuple, Protocol

from lta_bag.writer import prepare_empty_folder
from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput, unknown_name_error
from lta_config.topics import load_topic_table
from lta_data.bag.columns import Columns, LAMP_PEAKS, LIGHT_BLOCK
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import (
    find_unit,
    FIXED_UNITS,
    group_points,
    STAMP_COLUMN,
    Table,
    TIME_INDEX,
)
import numpy as np
from numpy.typing import NDArray
import pyarrow as arrow
from pyarrow import csv, parquet
from scipy.io import savemat

MAT_BYTES: Final = 2**31 - 1  # bytes of a variable in version 5
MAT_NAME_LENGTH: Final = 63  # characters of a name, namelengthmax of MATLAB
MAT_UNITS: Final = 'units'
_INDEX: Final = re.compile(r'\[(\d+)\]')
_LAST: Final = re.compile(r'(.*)\[(\d+)\]')

Struct = dict[str, Any]


def write_mat(source: 'ExportSource', path: Path) -> Iterator[arrow.Table]:
    """
    Write a file and yield its table.

    Raise `BadInput` if the topic is too large for the format.
    """
    parts, size = [], 0
    for part in source.iterate_arrow():
        size += part.nbytes
        if size > MAT_BYTES:
            raise BadInput(
                f"'{source.name}' is larger than the 2 GB that a MATLAB file can hold; leave it "
                'out with --topics, or export it with --format parquet.'
            )
        parts.append(part)
    whole = arrow.concat_tables(parts)
    columns = {name: whole.column(name).to_numpy() for name in whole.column_names}
    values: Struct = {}
    units: Struct = {}
    # Units are those of the first element of an array.
    for name, column in join_array_columns(columns).items():
        # savemat writes object arrays, as texts are, as cell arrays
        cells = column
        unit = source.units.get(name, source.units.get(f'{name}[0]', ''))
        # MATLAB has no one-dimensional arrays: make it a column.
        set_nested_value(values, name, cells if cells.ndim == 2 else cells[:, None])
        set_nested_value(units, name, unit)
    content = {format_matlab_name(source.name): values, MAT_UNITS: units}
    savemat(path, content, long_field_names=True, do_compression=True, oned_as='column')
    yield whole


def join_array_columns(
    columns: Mapping[str, np.ndarray[Any, Any]],
) -> dict[str, np.ndarray[Any, Any]]:
    """Join the elements of each numeric array into one matrix, shape (n, elements)."""
    joined: dict[str, Any] = {}
    for name, values in columns.items():
        element = _LAST.fullmatch(name)
        if element is None or values.dtype.kind == 'O':
            joined[name] = values
        else:
            joined.setdefault(element.group(1), []).append(values)
    return {
        name: np.stack(values, axis=1) if isinstance(values, list) else values
        for name, values in joined.items()
    }


def set_nested_value(struct: Struct, path: str, value: object) -> None:
    """Set a value in a struct of structs."""
    *outer, last = [format_matlab_name(part) for part in re.split('[./]', path)]
    for name in outer:
        inside = struct.setdefault(name, {})
        if not isinstance(inside, dict):  # the name already holds a value
            inside = struct.setdefault(f'{name}_'[:MAT_NAME_LENGTH], {})
        struct = inside
    while last in struct:
        last = f'{last}_'
    struct[last] = value


def format_matlab_name(name: str) -> str:
    """Return a valid MATLAB name: letters, digits and underscores, starting with a letter."""
    plain = re.sub(r'\W', '_', _INDEX.sub(r'_\1', name), flags=re.ASCII).strip('_')
    return (plain if plain[:1].isalpha() else f'x{plain}')[:MAT_NAME_LENGTH]


BLOCK_ROWS: Final = 512  # blocks of the photodiodes per part, 16 kB each
PACKED_TYPES: Final = ('sensor_msgs/msg/Image', 'sensor_msgs/msg/PointCloud2')


@final
class ExportSource(NamedTuple):
    """The columns of one file."""

    name: str  # the topic, or what else the file holds
    kind: str  # message type; '' if none
    units: Mapping[str, str]  # unit of the columns that have one
    parts: Iterator[Columns]  # one or more; each has the columns of the first
    remark: str = ''  # what is left out; '' if nothing

    def build_schema(self, part: Columns) -> Any:
        """Return the arrow schema of the columns, with their units."""
        fields = [
            arrow.field(
                name,
                arrow.string()
                if values.dtype.kind in 'UO'
                else arrow.from_numpy_dtype(values.dtype),
                metadata={'unit': self.units[name]} if name in self.units else None,
            )
            for name, values in part.items()
        ]
        return arrow.schema(fields, metadata={'topic': self.name, 'type': self.kind})

    def iterate_arrow(self) -> Iterator[Any]:
        """Yield the parts as `pyarrow.Table`."""
        schema = None
        for part in self.parts:
            schema = schema or self.build_schema(part)
            yield arrow.table([arrow.array(values) for values in part.values()], schema=schema)


def build_topic_source(flight: RecordedFlight, topic: str) -> ExportSource:
    """Return the source of a topic; raise `BadInput` if the topic cannot be decoded."""
    kind = flight.message_type(topic)
    if kind == LAMP_PEAKS:
        parts = iter([_build_point_rows(flight, topic)])
        units = {field: find_unit(kind, field, topic) for field in
                 ('x', 'y', 'z', 'amplitude', 'snr', 'frequency')}  # fmt: skip
        return _build_part_source(flight, topic, kind, parts, units)
    if kind == LIGHT_BLOCK:
        parts, counts = _iterate_sample_rows(flight, topic), find_unit(kind, 'counts')
        return _build_part_source(flight, topic, kind, parts, {'diode': counts})
    remark = (
        f"Of the messages on '{topic}', the data are not exported." if kind in PACKED_TYPES else ''
    )
    (table,) = flight.read_tables([topic]).values()
    return build_table_source(table, topic, kind, remark)


def build_table_source(table: Table, name: str, kind: str = '', remark: str = '') -> ExportSource:
    """Return the source of a `pandas.DataFrame` as of `lta_data.bag.table`."""
    columns = {STAMP_COLUMN: table[STAMP_COLUMN].to_numpy(), TIME_INDEX: table.index.to_numpy()}
    columns |= {name: table[name].to_numpy() for name in table}
    return ExportSource(name, kind, table.attrs['units'], iter([columns]), remark)


def _build_part_source(
    flight: RecordedFlight,
    topic: str,
    kind: str,
    parts: Iterator[Columns],
    units: Mapping[str, str],
) -> ExportSource:
    """Return a source of parts; `units` are those of columns, also with an index behind."""
    # Read ahead, so that a topic that cannot be decoded is refused
    first = next(parts, _build_clock_columns(flight, np.empty(0, np.int64)))
    units = {name: unit for name in first if (unit := units.get(name.partition('[')[0]))}
    return ExportSource(topic, kind, FIXED_UNITS | units, chain([first], parts))


def _iterate_sample_rows(flight: RecordedFlight, topic: str) -> Iterator[Columns]:
    """Yield the samples of light blocks, one row per sample."""
    period = round(1e9 / load_topic_table().light.sample_rate.si)
    for time, samples in flight.iterate_blocks(topic, BLOCK_ROWS):
        count = samples.shape[1]
        inside = np.tile(np.arange(count), len(samples))
        # A block's stamp is that of its first sample
        stamps = np.repeat(_compute_stamps(flight, time), count) + inside * period
        # From (blocks, samples, diodes) to one row per sample
        table = samples.reshape(-1, samples.shape[2])
        diodes = {f'diode[{index}]': column for index, column in enumerate(table.T)}
        yield _build_clock_columns(flight, stamps) | {'sample': inside} | diodes


def _build_point_rows(flight: RecordedFlight, topic: str) -> Columns:
    """Return lamp peaks, one row per beacon and diode; padding is dropped."""
    (table,) = flight.read_tables([topic]).values()
    stamps, fields = table[STAMP_COLUMN].to_numpy(), group_points(table)
    if not fields:
        return _build_clock_columns(flight, stamps[:0])
    points = np.stack(list(fields.values()))
    # Messages with fewer points are padded with NaN points.
    there = ~np.isnan(points).all(axis=0).ravel()
    rows = np.repeat(stamps, points.shape[2])[there]
    index = np.tile(np.arange(points.shape[2]), len(stamps))[there]
    columns = {name: values.ravel()[there] for name, values in fields.items()}
    return _build_clock_columns(flight, rows) | {'point': index} | columns


def _build_clock_columns(flight: RecordedFlight, stamps: NDArray[np.int64]) -> Columns:
    """Return the columns of the time."""
    return {STAMP_COLUMN: stamps, TIME_INDEX: (stamps - flight.start).astype(np.float64) * 1e-9}


def _compute_stamps(flight: RecordedFlight, time: NDArray[np.float64]) -> NDArray[np.int64]:
    """Convert times since the start to stamps [ns]."""
    return flight.start + np.rint(time * 1e9).astype(np.int64)


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


EXPORT_FORMATS: Final[dict[str, Callable[[ExportSource, Path], Iterator[arrow.Table]]]] = {
    'parquet': write_parquet,
    'csv': write_csv,
    'mat': write_mat,
}
ALIGNED: Final = 'aligned'
UNITS_FILE: Final = 'units.csv'  # beside the files of CSV


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
    if order.form not in EXPORT_FORMATS:
        raise unknown_name_error('format', order.form, list(EXPORT_FORMATS))
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
        for table in EXPORT_FORMATS[form](source, part):
            rows, columns = rows + len(table), table.column_names
    done.files.append(ExportedFile(source.name, path, rows, len(columns)))
    if source.remark:
        done.remarks.append(source.remark)
    return [(path.name, source.name, column, source.units.get(column, '')) for column in columns]


def write_units(rows: Iterable[tuple[str, str, str, str]], folder: Path) -> None:
    """Write the unit of each column of each file; '' if unknown."""
    with (folder / UNITS_FILE).open('w', newline='', encoding='utf-8') as file:
        writer(file).writerows([('file', 'topic', 'column', 'unit'), *rows])
