# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read ArduPilot's DataFlash logs (.bin): each message type is a table.

Each message begins with 0xA3 0x95 and the number of its type. The messages FMT (number 128) define
the types: number, length, name, a format character and a name for each field. Times (`TimeUS`) are
in us since the autopilot was switched on. Checked against pymavlink's DFReader.

Stamps are the sample times if a message has them (`timestamp_sample`), log times those of the
messages (`timestamp`); both in us since the autopilot was switched on.
"""

import contextlib
import io
from pathlib import Path
import struct
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.limits import check_log_size, limit_memory
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_data.importers.log_provenance import CLOCK_KEY
from lta_data.importers.protocol import InMemoryLog, LogTable, Times
import numpy as np
from pyulog import ULog
from pyulog.exceptions import ULogException

MICROSECOND = 1_000  # ns
# Errors that pyulog raises on invalid files.
FAULTS = (
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    ArithmeticError,
    MemoryError,
    RecursionError,
)
FACTS = {
    'sys_name': 'system',
    'ver_hw': 'hardware',
    'ver_sw': 'software',
}  # ULog key -> provenance key


def open_ulog(path: Path, mapping: MappingFile | None) -> InMemoryLog:
    """Read a PX4 log completely; raise BadInput if it cannot be read, or contains no message."""
    check_log_size(path)
    output = io.StringIO()
    try:
        # pyulog prints warnings, and does not close files that it opens itself.
        with contextlib.redirect_stdout(output), path.open('rb') as stream, limit_memory():
            log = ULog(stream, None, True)
    except (ULogException, struct.error, *FAULTS) as error:
        reason = ' '.join(str(error).split()) or type(error).__name__
        raise BadInput(
            f"'{path}' cannot be read as a ULog ({reason}); it is probably damaged, so copy it "
            'again.'
        ) from None
    timed = [data for data in log.data_list if 'timestamp' in data.data]
    tables = {_format_table_name(data): _build_ulog_table(data.data) for data in timed}
    if not tables:
        raise BadInput(f"'{path}' is a ULog without messages; give a log with data.")
    notes = []
    if log.file_corruption:
        notes.append('The log is damaged; unreadable parts are left out.')
    if log.dropouts:
        lost = sum(dropout.duration for dropout in log.dropouts)
        notes.append(
            f'The PX4 logger lost data {len(log.dropouts)} times, for {lost} ms in total.'
        )
    facts = {CLOCK_KEY: 'since the vehicle was switched on'} | {
        ours: str(log.msg_info_dict[key])
        for key, ours in FACTS.items()
        if key in log.msg_info_dict
    }
    return InMemoryLog(tables, notes, facts)


def _format_table_name(data: Any) -> str:
    return f'{data.name}_{data.multi_id}' if data.multi_id else str(data.name)


def _build_ulog_table(columns: dict[str, Any]) -> LogTable:
    """Return a logged message as a table."""
    times: Times = columns['timestamp'].astype(np.int64) * MICROSECOND
    sampled = columns.get('timestamp_sample')
    stamps = times
    if sampled is not None:
        own = sampled.astype(np.int64) * MICROSECOND
        # PX4 writes 0 if a sample time is unknown.
        stamps = np.where(own > 0, own, times)
    numbers = {
        name: np.asarray(values, dtype=np.float64)
        for name, values in columns.items()
        if name != 'timestamp'
    }
    return LogTable(stamps, times, times, numbers)


DATAFLASH_HEAD: Final = b'\xa3\x95'
FMT: Final = 128
FMT_BYTES: Final = 89
TIME_FIELDS: Final = {'TimeUS': 1_000, 'TimeMS': 1_000_000}  # times of messages, in ns
SDLOG2: Final = 'StartTime'  # of the messages TIME in the logs of old PX4
# Format character -> type and factor; texts and arrays are skipped
FIELD_CODES: Final[dict[str, tuple[str, float]]] = {
    'b': ('i1', 1.0), 'B': ('u1', 1.0), 'M': ('u1', 1.0), 'h': ('<i2', 1.0), 'H': ('<u2', 1.0),
    'i': ('<i4', 1.0), 'I': ('<u4', 1.0), 'q': ('<i8', 1.0), 'Q': ('<u8', 1.0),
    'f': ('<f4', 1.0), 'd': ('<f8', 1.0), 'g': ('<f2', 1.0),
    'c': ('<i2', 0.01), 'C': ('<u2', 0.01), 'e': ('<i4', 0.01), 'E': ('<u4', 0.01),
    'L': ('<i4', 1e-7), 'n': ('V4', 0.0), 'N': ('V16', 0.0), 'Z': ('V64', 0.0), 'a': ('V64', 0.0),
}  # fmt: skip


@final
class MessageFormat(NamedTuple):
    """One message type: name, fields with their factors, and the layout of a message."""

    name: str
    factors: dict[str, float]
    record: np.dtype[np.void]


def open_dataflash(path: Path, mapping: MappingFile | None) -> InMemoryLog:
    """Read a DataFlash log completely; raise BadInput if it contains no message with a time."""
    check_log_size(path)
    data = path.read_bytes()
    formats, places, skipped = _locate_messages(data)
    tables = {
        formats[kind].name: _build_table(data, formats[kind], kind_places)
        for kind, kind_places in places.items()
        if {*TIME_FIELDS} & {*formats[kind].factors}
    }
    if any(SDLOG2 in form.factors for form in formats.values()):
        raise BadInput(
            f"'{path}' is a log of PX4 before 2016 (sdlog2), which is not read; convert it to CSV "
            "with PX4's sdlog2_dump.py, and import that with --draft."
        )
    if not tables:
        raise BadInput(f"'{path}' is a DataFlash log without messages; give a log with data.")
    notes = []
    if skipped:
        notes.append(f'{skipped} bytes of the log are not a complete message and are left out.')
    clock = {CLOCK_KEY: 'since the vehicle was switched on'}
    return InMemoryLog(tables, notes, clock, timed=(*TIME_FIELDS,))


def _locate_messages(
    data: bytes,
) -> tuple[dict[int, MessageFormat], dict[int, list[int]], int]:
    """Return the types, the offsets of the messages of each, and the bytes skipped."""
    formats: dict[int, MessageFormat] = {}
    places: dict[int, list[int]] = {}
    at = skipped = 0
    while at + 3 <= len(data):
        kind = data[at + 2]
        size = 0
        if data[at : at + 2] == DATAFLASH_HEAD:
            message_type = formats.get(kind)
            size = (
                FMT_BYTES if kind == FMT else message_type.record.itemsize if message_type else 0
            )
        if not size or at + size > len(data):
            # Damaged or unknown: search for the next head
            following = data.find(DATAFLASH_HEAD, at + 1)
            following = len(data) if following < 0 else following
            skipped += following - at
            at = following
            continue
        if kind == FMT:
            if message_format := _read_format(data[at : at + size]):
                formats.setdefault(*message_format)
        else:
            places.setdefault(kind, []).append(at)
        at += size
    return formats, places, skipped + len(data) - at


def _read_format(message: bytes) -> tuple[int, MessageFormat] | None:
    """Return number and layout of a type; None if its definition is inconsistent."""
    kind, size = message[3], message[4]
    name, codes, labels = (
        part.rstrip(b'\0').decode('ascii', errors='replace')
        for part in (message[5:9], message[9:25], message[25:89])
    )
    names = labels.split(',') if labels else []
    if len(names) != len(codes) or len(set(names)) != len(names) or not {*codes} <= {*FIELD_CODES}:
        return None
    fields = [('head', 'V3'), *((n, FIELD_CODES[c][0]) for n, c in zip(names, codes, strict=True))]
    record = np.dtype(fields)
    if record.itemsize != size:
        return None
    factors = {
        n: FIELD_CODES[c][1] for n, c in zip(names, codes, strict=True) if FIELD_CODES[c][1]
    }
    return kind, MessageFormat(name, factors, record)


def _build_table(data: bytes, form: MessageFormat, places: list[int]) -> LogTable:
    """Return all messages of a type as a table."""
    offsets = np.array(places)
    raw = np.frombuffer(data, dtype=np.uint8)
    # Shape (messages, bytes)
    rows = raw[offsets[:, None] + np.arange(form.record.itemsize)]
    records = np.ascontiguousarray(rows).view(form.record).reshape(-1)
    time = next(name for name in TIME_FIELDS if name in form.factors)
    times = records[time].astype(np.int64) * TIME_FIELDS[time]
    numbers = {
        name: records[name].astype(np.float64) * factor
        for name, factor in form.factors.items()
        if name != time
    }
    return LogTable(times, times, offsets.astype(np.int64), numbers)
