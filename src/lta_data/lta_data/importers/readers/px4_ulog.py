"""
Read PX4's ULog with pyulog: each message type is a table, further instances are `name_1` etc.

Stamps are the sample times if a message has them (`timestamp_sample`), log times those of the
messages (`timestamp`); both in us since the autopilot was switched on.
"""

import contextlib
import io
from pathlib import Path
import struct
from typing import Any

from lta_config.errors import BadInput
from lta_config.limits import check_log_size, limit_memory
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_data.importers.log_provenance import CLOCK
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
    tables = {_format_table_name(data): _build_table(data.data) for data in timed}
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
    facts = {CLOCK: 'since the vehicle was switched on'} | {
        ours: str(log.msg_info_dict[key])
        for key, ours in FACTS.items()
        if key in log.msg_info_dict
    }
    return InMemoryLog(tables, notes, facts)


def _format_table_name(data: Any) -> str:  # noqa: ANN401 - pyulog has no types
    return f'{data.name}_{data.multi_id}' if data.multi_id else str(data.name)


def _build_table(columns: dict[str, Any]) -> LogTable:
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
