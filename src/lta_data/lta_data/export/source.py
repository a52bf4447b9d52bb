"""
Prepare the columns of a topic for a file.

Light blocks become one row per sample, lamp peaks one row per beacon and diode, a part of the
topic at a time. The packed bytes of other messages, such as pixels, are left out.
"""

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any, Final, final, NamedTuple

from lta_config.topics import load_topic_table
from lta_data.bag.merge import Columns
from lta_data.bag.packed_samples import LAMP_PEAKS, LIGHT_BLOCK
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import FIXED_UNITS, name_columns, STAMP, Table, TIME
from lta_data.bag.units import find_unit
import numpy as np
from numpy.typing import NDArray
import pyarrow as arrow

BLOCK_ROWS: Final = 512  # blocks of the photodiodes per part, 16 kB each
POINT_ROWS: Final = 1024  # messages with points per part
PACKED: Final = ('sensor_msgs/msg/Image', 'sensor_msgs/msg/PointCloud2')


@final
class ExportSource(NamedTuple):
    """The columns of one file."""

    name: str  # the topic, or what else the file holds
    kind: str  # message type; '' if none
    units: Mapping[str, str]  # unit of the columns that have one
    parts: Iterator[Columns]  # one or more; each has the columns of the first
    remark: str = ''  # what is left out; '' if nothing

    def build_schema(self, part: Columns) -> Any:  # noqa: ANN401 - pyarrow has no types
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
        parts = _iterate_point_rows(flight, topic)
        units = {field: find_unit(kind, field, topic) for field in
                 ('x', 'y', 'z', 'amplitude', 'snr', 'frequency')}  # fmt: skip
        return _build_part_source(flight, topic, kind, parts, units)
    if kind == LIGHT_BLOCK:
        parts, counts = _iterate_sample_rows(flight, topic), find_unit(kind, 'counts')
        return _build_part_source(flight, topic, kind, parts, {'diode': counts})
    series = flight.read_series(topic)
    columns, units = name_columns(series, kind, topic)
    columns = _build_clock_columns(flight, series.stamps) | columns
    remark = f"Of the messages on '{topic}', the data are not exported." if kind in PACKED else ''
    return ExportSource(topic, kind, FIXED_UNITS | units, iter([columns]), remark)


def build_table_source(table: Table, name: str) -> ExportSource:
    """Return the source of a `pandas.DataFrame` as of `lta_data.bag.table`."""
    columns = {STAMP: table[STAMP].to_numpy(), TIME: table.index.to_numpy()}
    columns |= {name: table[name].to_numpy() for name in table}
    return ExportSource(name, '', table.attrs['units'], iter([columns]))


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


def _iterate_point_rows(flight: RecordedFlight, topic: str) -> Iterator[Columns]:
    """Yield lamp peaks, one row per beacon and diode; padding is dropped."""
    for time, fields in flight.iterate_points(topic, POINT_ROWS):
        if not fields:
            continue
        table = np.stack(list(fields.values()))
        _, count, most = table.shape
        # Messages with fewer points are padded with NaN points.
        there = ~np.isnan(table).all(axis=0).ravel()
        stamps = np.repeat(_compute_stamps(flight, time), most)[there]
        index = np.tile(np.arange(most), count)[there]
        columns = {name: values.ravel()[there] for name, values in fields.items()}
        yield _build_clock_columns(flight, stamps) | {'point': index} | columns


def _build_clock_columns(flight: RecordedFlight, stamps: NDArray[np.int64]) -> Columns:
    """Return the columns of the time."""
    return {STAMP: stamps, TIME: (stamps - flight.start).astype(np.float64) * 1e-9}


def _compute_stamps(flight: RecordedFlight, time: NDArray[np.float64]) -> NDArray[np.int64]:
    """Convert times since the start to stamps. [ns]"""
    return flight.start + np.rint(time * 1e9).astype(np.int64)
