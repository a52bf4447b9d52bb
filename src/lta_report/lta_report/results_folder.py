# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The results folder of a command: its name, atomic writing, and the templates of its pages.

A file in `assets` has a style between `<style>` and `</style>`, then further content. Those of the
frame and of reports have placeholders.
"""

from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib.resources import files
import json
import os
from pathlib import Path
import shlex
from typing import Any, Final

from lta_bag.writer import prepare_empty_folder
from lta_config.atomic_file import replace_atomically, reserve_folder
from lta_config.errors import BadInput

BEGIN: Final = '<style>\n'
STYLE_END: Final = '</style>\n'


def read_asset(name: str) -> str:
    """Return the text of a file in `assets`."""
    return (files('lta_report') / 'assets' / name).read_text(encoding='utf-8')


def split_template(text: str) -> list[str]:
    """Return style and content of a page's file."""
    return text.removeprefix(BEGIN).split(STYLE_END, 1)


def write_file(content: str | bytes, out: Path) -> Path:
    """Write a page or picture and return its path; raise `BadInput` if that fails."""
    try:
        with replace_atomically(out) as part:
            part.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise BadInput(
            f"'{out}' cannot be written ({error.strerror}); free disk space, or write elsewhere."
        ) from error
    return out


def resolve_folder(out: Path | None, name: str) -> Path:
    """
    Return the absolute path of the given folder, or of a new folder runs/<time>-<name>.

    The new folder exists, so that no other command gets it (see `reserve_folder`).
    """
    if out is not None:
        return out.absolute()
    # Local time, as the user sees it; names sort by time
    stamp = datetime.now().astimezone().strftime('%Y%m%d-%H%M%S')
    return reserve_folder(Path('runs').absolute() / f'{stamp}-{name}')


def check_creatable(folder: Path) -> None:
    """Raise `BadInput`, before any work, for a folder that is not empty or cannot be created."""
    if folder.exists():
        prepare_empty_folder(folder)
    # The nearest existing parent decides whether the folder can be created
    above = next(one for one in (folder, *folder.parents) if one.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        raise BadInput(
            f"'{folder}' cannot be created: '{above}' is not a writable folder; choose another "
            'folder.'
        )


def write_json(content: Mapping[str, Any] | Sequence[Any], place: Path) -> str:
    """Write results as JSON and return the text; raise `BadInput` if writing fails."""
    text = json.dumps(content, indent=1) + '\n'
    try:
        with replace_atomically(place) as part:
            part.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"'{place}' cannot be written ({error.strerror}); free disk space, or choose another "
            'folder with --out.'
        ) from error
    return text


def format_page_line(page: Path) -> str:
    """Return the line with the path of a page and the command to open it."""
    return f'Page {page}  (open it in a browser: xdg-open {shlex.quote(str(page))})'
