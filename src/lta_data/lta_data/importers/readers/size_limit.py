"""What is too large to be read whole."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_config.limits import LOG_BYTES


def refuse_large_log(path: Path) -> None:
    """Raise BadInput for a log that would be read whole and is too large for that."""
    if path.stat().st_size > LOG_BYTES:
        raise BadInput(f"'{path}' is larger than {LOG_BYTES} bytes; cut the log into parts.")
