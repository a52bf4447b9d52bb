# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read logs that a Crazyflie writes to its micro SD card, versions 1 and 2.

Little endian. The header is 0xBC, version (u16) and number of event types (u16). For each event
type follow its number (u16), its name, the number of its variables (u16), and for each variable
`group.name(t)`, with t its type as in Python's `struct`; texts end with a zero byte. Then come
events to the end: type number (u16), time (version 1: u32 in ms, version 2: u64 in us) and the
packed variables: first those of the event itself, whose names have no group (`id` of
`estDistance`), then the configured ones. The last four bytes are the CRC-32 of everything before;
a drone that loses power while logging does not write them. Checked against the writer and decoder
in Bitcraze's crazyflie-firmware: `usdWriteTask` in src/deck/drivers/src/usddeck.c, and
tools/usdlog/cfusdlog.py. Time counts since the drone was switched on.
"""

from collections.abc import Mapping
from pathlib import Path
import re
import struct
from typing import final, NamedTuple
import zlib

from lta_config.errors import BadInput
from lta_config.limits import check_log_size
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_config.topics import load_topic_table
from lta_data.importers.log_provenance import CLOCK_KEY
from lta_data.importers.protocol import InMemoryLog, LogTable
import numpy as np

MAGIC = 0xBC
USD_HEAD = struct.Struct('<BHH')  # magic, version, event types
CRC = 4  # bytes
# Head of an event, by version of the format
STARTS = {
    1: np.dtype([('id', '<u2'), ('time', '<u4')]),
    2: np.dtype([('id', '<u2'), ('time', '<u8')]),
}
TICK_LENGTHS = {1: 1_000_000, 2: 1_000}  # ns per unit of time, by version
STRUCT_CODES = 'BbHhIiQqefd'  # type codes of Python's struct
VARIABLE = re.compile(rf'(.+)\(([{STRUCT_CODES}])\)')


@final
class UsdEvent(NamedTuple):
    """One event type: its name, its variables, and the layout of a record."""

    name: str
    variables: list[str]
    record: np.dtype[np.void]


def open_usd_log(path: Path, mapping: MappingFile | None) -> InMemoryLog:
    """
    Read a log of the card completely.

    Raise `BadInput` if its header is invalid, or it contains no event.
    """
    check_log_size(path)
    data = path.read_bytes()
    events, at, version = _read_header(data, path)
    # The last four bytes are a CRC only if it is right; otherwise they may be data.
    whole = len(data) >= at + CRC and zlib.crc32(data[:-CRC]) == int.from_bytes(
        data[-CRC:], 'little'
    )
    notes = []
    end = len(data) - CRC if whole else len(data)
    places, stopped = _locate_events(data, at, end, events)
    if not whole:
        left = end - stopped
        notes.append(
            'The checksum (CRC) does not match: the log was cut short or is damaged; its last '
            f'{left} bytes are not a complete event and are left out.'
        )
    elif stopped < end:
        notes.append(
            f'The log has an unknown event type at byte {stopped}; the {end - stopped} bytes from '
            'there on are left out.'
        )
    tables: dict[str, LogTable] = {}
    for number, event_places in places.items():
        name = events[number].name
        name = f'{name} ({number})' if name in tables else name
        tables[name] = _build_table(data, events[number], event_places, version)
    if not tables:
        raise BadInput(f"'{path}' is a Crazyflie log without events; give a log with data.")
    facts = {
        'usd_version': str(version),
        'crc': 'fits' if whole else 'does not fit',
        CLOCK_KEY: 'since the drone was switched on',
    }
    _note_shift(notes)
    return InMemoryLog(tables, notes, facts)


def _read_header(data: bytes, path: Path) -> tuple[dict[int, UsdEvent], int, int]:
    """Return the event types by number, the offset of the first event, and the version."""
    try:
        magic, version, count = USD_HEAD.unpack_from(data)
        if magic != MAGIC or version not in STARTS:
            raise BadInput(
                f"'{path}' is not a Crazyflie log of version 1 or 2 (byte {magic:#x}, version "
                f'{version}); record a log with a firmware that writes one of these versions.'
            )
        at = USD_HEAD.size
        events = {}
        for _ in range(count):
            number, name, variables, at = _read_event_header(data, at)
            names: list[str] = []
            fields = [*STARTS[version].descr]
            for index in range(1, variables + 1):
                text, at = _read_text(data, at)
                variable, kind = _parse_field(text, path)
                names.append(variable if variable not in names else f'{variable} ({index})')
                fields.append(
                    (f'variable {index}', kind)
                )  # not by name, which may be 'id' or 'time'
            events[number] = UsdEvent(name, names, np.dtype(fields))
    except (struct.error, ValueError, UnicodeDecodeError) as error:
        if isinstance(error, BadInput):
            raise
        raise BadInput(f"The header of '{path}' is cut short or damaged; copy it again.") from None
    return events, at, version


def _read_event_header(data: bytes, at: int) -> tuple[int, str, int, int]:
    """Return number, name and variable count of an event type, and the offset of its variables."""
    (number,) = struct.unpack_from('<H', data, at)
    name, at = _read_text(data, at + 2)
    (variables,) = struct.unpack_from('<H', data, at)
    return number, name, variables, at + 2


def _read_text(data: bytes, at: int) -> tuple[str, int]:
    """Return a zero-terminated text, and the offset behind it."""
    end = data.index(b'\0', at)
    return data[at:end].decode(), end + 1


def _parse_field(text: str, path: Path) -> tuple[str, str]:
    """Return a variable's name and numpy type."""
    match = VARIABLE.fullmatch(text)
    if match is None:
        raise BadInput(
            f"In the header of '{path}', the variable '{text}' has an unknown type, so the file "
            'is probably damaged; copy it again.'
        )
    return match[1], np.dtype(f'<{match[2]}').str


def _locate_events(
    data: bytes, at: int, end: int, events: Mapping[int, UsdEvent]
) -> tuple[dict[int, list[tuple[int, int]]], int]:
    """Return (position in the log, offset) of each event by type, and where they stop."""
    sizes = {number: event.record.itemsize for number, event in events.items()}
    places: dict[int, list[tuple[int, int]]] = {}
    rank = 0
    while at + 2 <= end:
        number = data[at] | data[at + 1] << 8
        size = sizes.get(number)
        # Records have no length field, so nothing after an unknown type can be read.
        if size is None or at + size > end:
            break
        places.setdefault(number, []).append((rank, at))
        rank += 1
        at += size
    return places, at


def _build_table(
    data: bytes, event: UsdEvent, places: list[tuple[int, int]], version: int
) -> LogTable:
    """Return the events of one type as a table."""
    size = event.record.itemsize
    # Records of all types are interleaved, so gather those of one type first
    rows = np.frombuffer(b''.join(data[at : at + size] for _, at in places), dtype=event.record)
    stamps = rows['time'].astype(np.int64) * TICK_LENGTHS[version] + load_topic_table().start_ns
    columns = {
        name: rows[f'variable {index}'].astype(np.float64)
        for index, name in enumerate(event.variables, 1)
    }
    order = np.array([rank for rank, _ in places], dtype=np.int64)
    return LogTable(stamps, stamps, order, columns)


def _note_shift(notes: list[str]) -> None:
    """Add the remark that times count from the start of the drone."""
    start = load_topic_table().start_ns / 1e9
    notes.append(
        'The times in the log start when the drone was switched on. '
        f'{start:g} s were added to all times, since in ROS time 0 means "no clock yet".'
    )
