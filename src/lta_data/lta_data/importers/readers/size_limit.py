"""Refuse logs that are too large to be read at once."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_config.limits import LOG_BYTES


def check_log_size(path: Path) -> None:
    """Raise BadInput for a log above the size limit."""
    if path.stat().st_size > LOG_BYTES:
        raise BadInput(
            f"'{path}' is larger than {LOG_BYTES} bytes, the limit of an import; split the log."
        )
