"""
Limits on untrusted input: files, recordings and shapes of unknown origin.

Each is far above what a real file needs, and low enough for a machine with 4 GB. Beyond it a
command ends with one sentence. docs/security.md explains the limits.
"""

from pathlib import Path
from typing import Final

from lta_config.errors import BadInput

# YAML files
YAML_BYTES: Final = 1_000_000  # hand-written files are far smaller
YAML_DEPTH: Final = 50  # levels; thousands of them overflow the C stack of the YAML reader
YAML_DIGITS: Final = 400  # of a number; the largest double has 309

# Recordings
CHUNK_BYTES: Final = 1 << 27  # of a chunk or message, unpacked
NOTE_BYTES: Final = 1 << 24  # of a schema, channel or metadata record
CHANNELS: Final = 4000  # of a recording; the largest robots have hundreds
SUMMARY_BYTES: Final = 1 << 28  # of the directory at the end of a recording
GRID: Final = 150_000  # points of a time grid, 25 min at 100 Hz; more if a recording has more
DEFINITION_BYTES: Final = 250_000  # of the text that defines a message type
ARRAY_PARTS: Final = 4096  # elements of its fixed arrays, which the reader unrolls into code

# Logs of others
LOG_BYTES: Final = 1 << 29  # of a log that is read whole: ULog, Crazyflie's card
LINE_BYTES: Final = 1 << 20  # of a line of text with columns
COLUMNS: Final = 5000  # of a log; an autopilot's export has hundreds
INFLATION: Final = 200  # bytes out of one byte of gzip or zstd; text with columns has up to 20
INFLATED_FREELY: Final = 1 << 26  # bytes after which the ratio is checked
READER_MEMORY: Final = 1 << 31  # bytes that a third-party reader may allocate

# Shapes
STL_BYTES: Final = 150_000_000  # text; a binary file of as many triangles has a fifth
STL_TRIANGLES: Final = 500_000


def check_column_count(path: Path, count: int) -> None:
    """Raise BadInput for a log with more columns than the limit."""
    if count > COLUMNS:
        raise BadInput(
            f"'{path}' has {count} columns, and LTA reads up to {COLUMNS}; save only those that "
            'you need.'
        )


def check_log_size(path: Path) -> None:
    """Raise BadInput for a log above the size limit."""
    if path.stat().st_size > LOG_BYTES:
        raise BadInput(
            f"'{path}' is larger than {LOG_BYTES} bytes, the limit of an import; split the log."
        )
