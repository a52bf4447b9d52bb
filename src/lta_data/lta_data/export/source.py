"""
Prepare the columns of a topic for a file, one part at a time.

A topic larger than one part is read twice: once to collect the columns of all messages, once to
write them. So memory holds one part, whatever the size of the bag.

Light blocks become one row per sample, lamp peaks one row per beacon and diode. The packed bytes
of other messages, such as pixels, are left out.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any, Final, final, NamedTuple

from lta_config.topics import load_topic_table
from lta_data.bag.merge import Columns
from lta_data.bag.packed_samples import LAMP_PEAKS, LIGHT_BLOCK
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.recording import build_topic_table, map_joint_names
from lta_data.bag.table import RecordingTable, STAMP, TIME
from lta_data.bag.units import find_unit
import numpy as np
from numpy.typing import NDArray

ROWS: Final = 16384  # messages per part
BLOCK_ROWS: Final = 512  # blocks of the photodiodes per part, 16 kB each
POINT_ROWS: Final = 1024  # messages with points per part
PACKED: Final = ('sensor_msgs/msg/Image', 'sensor_msgs/msg/PointCloud2')
FIXED: Final = {STAMP: 'ns', TIME: 's'}  # columns of every file, with their units


@final
class ExportSource(NamedTuple):
    """The columns of one file."""

    name: str  # the topic, or what else the file holds
    kind: str  # message type; '' if none
    declared: dict[str, np.dtype[Any]]  # all columns in order; text columns are of kind U
    units: dict[str, str]  # unit of the columns that have one
    # Returns an iterator over the parts; each part has all columns
    parts: Callable[[], Iterator[Columns]]
    remark: str = ''  # what is left out; '' if nothing


def build_topic_source(flight: RecordedFlight, topic: str) -> ExportSource:
    """Return the source of a topic; raise `BadInput` if the topic cannot be decoded."""
    kind = flight.message_type(topic)
    if kind == LAMP_PEAKS:
        units = partial(find_unit, kind, topic=topic)
        return build_column_source(topic, kind, partial(iterate_point_rows, flight, topic), units)
    if kind == LIGHT_BLOCK:
        rows = partial(iterate_sample_rows, flight, topic)
        return build_column_source(topic, kind, rows, find_column_unit)
    remark = f"Of the messages on '{topic}', the data are not exported." if kind in PACKED else ''
    return build_series_source(flight, topic, kind)._replace(remark=remark)


def build_table_source(table: RecordingTable, name: str) -> ExportSource:
    """Return the source of a table."""
    columns = {STAMP: table.stamp_ns, TIME: table.time} | {each: table[each] for each in table}
    declared = {column: values.dtype for column, values in columns.items()}
    return ExportSource(name, '', declared, FIXED | table.units, lambda: iter([columns]))


def build_column_source(
    topic: str, kind: str, rows: Callable[[], Iterator[Columns]], unit: Callable[[str], str]
) -> ExportSource:
    """Return a source of columns that need no renaming."""
    declared: dict[str, np.dtype[Any]] = {}
    # First pass: files declare their columns before the first row
    for part in rows():
        widen_column_types(declared, part)
    whole = add_clock_columns(declared)
    units = {column: unit(column) for column in whole if unit(column)} | FIXED
    return ExportSource(topic, kind, whole, units, partial(fill_missing_columns, rows, whole))


def build_series_source(flight: RecordedFlight, topic: str, kind: str) -> ExportSource:
    """Return a source of numeric messages; joint columns get the names of the joints."""
    parts = partial(flight.iterate_series, topic, ROWS)
    # A small topic is decoded once and kept for both passes.
    if flight.bag.topics[flight.absolute_name(topic)].count <= ROWS:
        sections = list(parts())
        parts = partial(iter, sections)
    joints: dict[str, str] | None = None
    declared: dict[str, np.dtype[Any]] = {}
    units: dict[str, str] = {}
    for series in parts():
        part_joints = map_joint_names(series)
        # Names apply only if they are the same in all parts.
        joints = part_joints if joints is None or joints == part_joints else {}
        table = build_topic_table(flight, topic, series, {})
        units |= table.units
        widen_column_types(declared, {column: table[column] for column in table})
    names = joints or {}

    def iterate_rows() -> Iterator[Columns]:
        for series in parts():
            table = build_topic_table(flight, topic, series, names)
            yield {STAMP: table.stamp_ns, TIME: table.time} | {each: table[each] for each in table}

    renamed = add_clock_columns({names.get(path, path): type_ for path, type_ in declared.items()})
    units = {names.get(path, path): unit for path, unit in units.items()} | FIXED
    return ExportSource(
        topic, kind, renamed, units, partial(fill_missing_columns, iterate_rows, renamed)
    )


def add_clock_columns(declared: Mapping[str, np.dtype[Any]]) -> dict[str, np.dtype[Any]]:
    """Return the columns with those of the time first."""
    return {STAMP: np.dtype(np.int64), TIME: np.dtype(np.float64), **declared}


def widen_column_types(declared: dict[str, np.dtype[Any]], part: Columns) -> None:
    """Update the declared columns to types that fit all parts so far."""
    for column in declared.keys() - part.keys():
        # Floats have NaN and texts have '': only integers need a wider type
        if declared[column].kind not in 'fU':
            declared[column] = np.dtype(np.float64)  # NaN where it is missing
    started = bool(declared)
    for column, values in part.items():
        column_type = declared.get(column)
        if column_type is None:
            # A column that starts late needs a type with NaN for the rows before.
            missing = started and values.dtype.kind not in 'fU'
            declared[column] = np.dtype(np.float64) if missing else values.dtype
        elif column_type != values.dtype:
            declared[column] = np.promote_types(column_type, values.dtype)


def fill_missing_columns(
    rows: Callable[[], Iterator[Columns]], declared: Mapping[str, np.dtype[Any]]
) -> Iterator[Columns]:
    """Yield parts with all columns; missing ones are NaN or ''."""
    for part in rows():
        count = len(part[STAMP])
        yield {
            column: part[column].astype(kind, copy=False)
            if column in part
            else np.full(count, '' if kind.kind == 'U' else np.nan, kind)
            for column, kind in declared.items()
        }


def iterate_sample_rows(flight: RecordedFlight, topic: str) -> Iterator[Columns]:
    """Yield the samples of light blocks, one row per sample."""
    period = round(1e9 / load_topic_table().light.sample_rate.si)
    for time, samples in flight.iterate_blocks(topic, BLOCK_ROWS):
        count = samples.shape[1]
        inside = np.tile(np.arange(count), len(samples))
        # A block's stamp is that of its first sample
        stamps = np.repeat(compute_stamps(flight, time), count) + inside * period
        # From (blocks, samples, diodes) to one row per sample
        table = samples.reshape(-1, samples.shape[2])
        diodes = {f'diode[{index}]': column for index, column in enumerate(table.T)}
        yield build_clock_columns(flight, stamps) | {'sample': inside} | diodes


def find_column_unit(column: str) -> str:
    """Return the unit of a column of samples."""
    return find_unit(LIGHT_BLOCK, 'counts') if column.startswith('diode') else ''


def iterate_point_rows(flight: RecordedFlight, topic: str) -> Iterator[Columns]:
    """Yield lamp peaks, one row per beacon and diode; padding is dropped."""
    for time, fields in flight.iterate_points(topic, POINT_ROWS):
        if not fields:
            continue
        table = np.stack(list(fields.values()))
        _, count, most = table.shape
        # Messages with fewer points are padded with NaN points.
        there = ~np.isnan(table).all(axis=0).ravel()
        stamps = np.repeat(compute_stamps(flight, time), most)[there]
        index = np.tile(np.arange(most), count)[there]
        columns = {name: values.ravel()[there] for name, values in fields.items()}
        yield build_clock_columns(flight, stamps) | {'point': index} | columns


def build_clock_columns(flight: RecordedFlight, stamps: NDArray[np.int64]) -> Columns:
    """Return the columns of the time."""
    return {STAMP: stamps, TIME: (stamps - flight.start).astype(np.float64) * 1e-9}


def compute_stamps(flight: RecordedFlight, time: NDArray[np.float64]) -> NDArray[np.int64]:
    """Convert times since the start to stamps. [ns]"""
    return flight.start + np.rint(time * 1e9).astype(np.int64)
