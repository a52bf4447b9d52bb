# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Format `lta` commands as the user calls them, `./lta` or `lta`, so that advice can be copied."""

import os
from pathlib import Path
import shlex

CALLED_VARIABLE = 'LTA_CALLED'  # set by the script ./lta to how it was called


def format_lta_command(*words: str | Path) -> str:
    """Return a command line of `lta` for the current folder, quoted for a shell."""
    return shlex.join([os.environ.get(CALLED_VARIABLE) or 'lta', *map(str, words)])


def relative_path(path: Path) -> Path:
    """Return a path relative to the current folder if it lies within it, else without `..`."""
    here = Path.cwd()
    # Not os.path.normpath, which removes a symbolic link together with the `..` after it
    whole = path.resolve() if '..' in path.parts else path.absolute()
    return whole.relative_to(here) if whole.is_relative_to(here) else whole
