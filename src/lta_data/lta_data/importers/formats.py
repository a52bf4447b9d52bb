# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""List the formats that can be imported, and detect the format of a file from its content."""

from collections.abc import Callable
from functools import partial
import gzip
from pathlib import Path
import re
from typing import final, NamedTuple
import zlib

from lta_bag.bag_folder import PACKED_ADVICE
from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_data.importers.protocol import LogReader
from lta_data.importers.readers import (
    array_files,
    column_log,
    crazyflie_usd,
    dataflash,
    rosbags_bag,
    sensor_folder,
)
from lta_data.importers.readers.csv_text import detect_encoding, GZIP
from mcap.writer import MCAP0_MAGIC

FORMAT_HEAD_BYTES = 4096  # bytes read to detect the format
ULOG = b'ULog\x01\x12\x35'
SQLITE = b'SQLite format 3\0'
ZSTD = b'\x28\xb5\x2f\xfd'
# First bytes of what has to be unpacked -> what it is, and the remedy
PACKAGES = {
    b'PK': 'a zip archive or a spreadsheet; unpack it, or save the sheet as CSV',
    b'BZh': 'compressed with bzip2; decompress it with `bunzip2` first',
    b'\xfd7zXZ': 'compressed with xz; decompress it with `unxz` first',
}
PACKED_BAGS = ('.mcap.zstd', '.mcap.zst', '.db3.zstd', '.db3.zst')
JSON = re.compile(rb'\s*\[?\s*\{')
USD = bytes([crazyflie_usd.MAGIC])


@final
class LogFormat(NamedTuple):
    """One format."""

    about: str  # description for users
    mapping: str | None  # the shipped mapping of a format with fixed names
    # Opens a log; raises `BadInput` if the file has another format. Without a mapping only bags
    # can be opened, whose messages have names and units.
    opened: Callable[[Path, MappingFile | None], LogReader]


def _open_csv(path: Path, mapping: MappingFile | None) -> LogReader:
    assert mapping is not None  # select_mapping has found one or raised
    return column_log.open_text(path, mapping)


def _open_bag(path: Path, mapping: MappingFile | None) -> LogReader:
    if _is_mcap(path):
        return rosbags_bag.open_mcap_log(path, mapping)
    return rosbags_bag.open_rosbags_log(path, mapping)


def _open_columns(
    path: Path, mapping: MappingFile | None, read: Callable[[Path], array_files.READ]
) -> LogReader:
    assert mapping is not None  # select_mapping has found one or raised
    tables, notes = read(path)
    return column_log.ColumnLog(path, tables, notes, mapping)


LOG_FORMATS: dict[str, LogFormat] = {
    'csv': LogFormat('a text table such as CSV, also compressed with gzip', None, _open_csv),
    'usd': LogFormat(
        "a log from a Crazyflie's SD card", 'crazyflie_usd', crazyflie_usd.open_usd_log
    ),
    'ulog': LogFormat('a ULog of PX4', 'px4', dataflash.open_ulog),
    'bag': LogFormat('a bag of ROS 2 (MCAP or SQLite) or ROS 1', None, _open_bag),
    'mat': LogFormat(
        'a MATLAB file (version 5 to 7)',
        None,
        partial(_open_columns, read=array_files.read_mat_file),
    ),
    'numpy': LogFormat(
        'arrays of NumPy (npy, npz)',
        None,
        partial(_open_columns, read=array_files.read_numpy_file),
    ),
    'parquet': LogFormat(
        'a Parquet table', None, partial(_open_columns, read=array_files.read_parquet_file)
    ),
    'dataflash': LogFormat(
        'a DataFlash log of ArduPilot (.bin)', 'ardupilot', dataflash.open_dataflash
    ),
    'folder': LogFormat(
        'a folder with a file for each sensor',
        None,
        partial(_open_columns, read=sensor_folder.read_folder),
    ),
}


def detect_format(path: Path) -> str:
    """
    Detect the format of a file or folder from its content.

    Raise `BadInput` if it is missing, empty, or of no known format.
    """
    if not path.exists():
        raise BadInput(f"'{path}' does not exist; give a log file or the folder of a bag.")
    if path.is_dir():
        # Without metadata.yaml too, which a killed recorder does not write
        if any(path.glob('*.mcap')) or any(path.glob('*.db3')):
            return 'bag'
        if packed := sorted(file for end in PACKED_BAGS for file in path.glob(f'*{end}')):
            raise BadInput(f"'{packed[0]}' is {PACKED_ADVICE}.")
        if sensor_folder.list_run_files(path):
            return 'folder'
        raise BadInput(
            f"Folder '{path}' contains no bag and no data file; give a log file or such a folder."
        )
    if not path.is_file():
        raise BadInput(f"'{path}' is not a regular file; give a log file or the folder of a bag.")
    head = _read_head(path)
    if not head:
        raise BadInput(f"'{path}' is empty; give a log with data.")
    if head.startswith((MCAP0_MAGIC, SQLITE, rosbags_bag.ROS1)):
        return 'bag'
    if head.startswith(ZSTD):
        raise BadInput(f"'{path}' is {PACKED_ADVICE}.")
    _refuse_pickle(path, head)
    if binary := _detect_binary(path, head):
        return binary
    if head.startswith(ULOG):
        return 'ulog'
    # One byte only, so test it after the longer magic numbers.
    if head.startswith(USD):
        return 'usd'
    if JSON.match(head):
        raise BadInput(
            f"'{path}' is JSON; write it as a table, as with pandas.json_normalize(...).to_csv."
        )
    if detect_encoding(head):
        return 'csv'
    for begin, what in PACKAGES.items():
        if head.startswith(begin):
            raise BadInput(f"'{path}' is {what}.")
    formats = '; '.join(f'{name}: {format_.about}' for name, format_ in LOG_FORMATS.items())
    raise BadInput(f"'{path}' is not in a known format ({formats}); convert it to one of these.")


def _detect_binary(path: Path, head: bytes) -> str | None:
    """Return the format of arrays or of ArduPilot by the first bytes; None if it is another."""
    if arrays := array_files.detect_arrays(head, path.suffix):
        return arrays
    # The first message defines the type of all definitions
    return (
        'dataflash' if head.startswith(dataflash.DATAFLASH_HEAD + bytes([dataflash.FMT])) else None
    )


def _refuse_pickle(path: Path, head: bytes) -> None:
    """Raise BadInput for a pickle, of any version."""
    named = path.suffix.lower() in ('.pkl', '.pickle', '.p')
    if named or (head[0] == 0x80 and len(head) > 1 and 2 <= head[1] <= 5):
        raise BadInput(
            f"'{path}' is a pickle, and LTA does not unpickle files, since a pickle can run any "
            'program; save its table with DataFrame.to_csv, DataFrame.to_parquet or np.savez.'
        )


def find_format(name: str) -> LogFormat:
    """Return a format; raise `BadInput` with the known names if it is unknown."""
    if name not in LOG_FORMATS:
        raise unknown_name_error('format', name, list(LOG_FORMATS))
    return LOG_FORMATS[name]


def _read_head(path: Path) -> bytes:
    """Return the first bytes of a file, decompressed."""
    try:
        with path.open('rb') as stream:
            head = stream.read(FORMAT_HEAD_BYTES)
        if head.startswith(GZIP):
            with gzip.open(path) as unpacked:
                return unpacked.read(FORMAT_HEAD_BYTES)
    except (OSError, EOFError, zlib.error) as error:
        raise BadInput(
            f"'{path}' cannot be read ({error}); check its permissions, or copy it again if it is "
            'damaged.'
        ) from None
    return head


def _is_mcap(path: Path) -> bool:
    if path.is_dir():
        return any(path.glob('*.mcap'))
    with path.open('rb') as stream:
        return stream.read(len(MCAP0_MAGIC)) == MCAP0_MAGIC
