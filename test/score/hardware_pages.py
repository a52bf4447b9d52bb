"""The pages of docs/ on flights of emulated and real firmware, from the rows that are stored."""

from collections.abc import Callable, Mapping
import json
from pathlib import Path
from typing import Final

import add_paths  # noqa: F401
from campaign import read_stored
import end_to_end
import faults
import real_firmware

PAGES: Final[Mapping[Path, Callable[[], str]]] = {
    end_to_end.PAGE: lambda: end_to_end.compose_page(read_stored(end_to_end.RECORD)),
    faults.PAGE: lambda: faults.compose_page(read_stored(faults.RECORD)),
    real_firmware.PAGE: lambda: real_firmware.compose_page(
        json.loads(real_firmware.RECORD.read_text()), read_stored(real_firmware.FLIGHTS)
    ),
}

RECORDS: Final[Mapping[Path, Path]] = {
    end_to_end.PAGE: end_to_end.RECORD,
    faults.PAGE: faults.RECORD,
    real_firmware.PAGE: real_firmware.FLIGHTS,
}


def is_stored(page: Path) -> bool:
    """Return whether there are rows for a page; campaigns before they were kept left none."""
    return RECORDS[page].exists()


if __name__ == '__main__':
    for path in filter(is_stored, PAGES):
        path.write_text(PAGES[path](), encoding='utf-8')
