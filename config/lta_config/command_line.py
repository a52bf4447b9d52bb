"""How people call the command here, for advice that can be copied: `./lta`, or `lta`."""

import os
from pathlib import Path
import shlex

CALLED = 'LTA_CALLED'  # set by the script ./lta, which knows what was typed


def format_lta_command(*words: str | Path) -> str:
    """Return a command line of `lta`, to be typed in the present folder."""
    return shlex.join([os.environ.get(CALLED) or 'lta', *map(str, words)])


def relative_path(path: Path) -> Path:
    """Return a path from the present folder where it lies in that, else the whole path."""
    here = Path.cwd()
    return path.absolute().relative_to(here) if path.absolute().is_relative_to(here) else path
