"""Where the results of a verb go: their folder, what is written into it, how a page is named."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from datetime import datetime
import json
import os
from pathlib import Path
import shlex
import shutil
from typing import Any, Final

from lta_bridge.bag.writer import prepare_empty_folder
from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput

PART: Final = '.part'  # within the folder: the one beside it may be somebody else's


def resolve_folder(out: Path | None, name: str) -> Path:
    """Return the whole path of the folder that was asked for, else of runs/<time>-<name>."""
    stamp = datetime.now().astimezone().strftime('%Y%m%d-%H%M%S')
    return (out or Path('runs') / f'{stamp}-{name}').absolute()


def check_creatable(folder: Path) -> None:
    """Refuse, before any work, a folder that holds something or could not be made."""
    if folder.exists():
        prepare_empty_folder(folder)
    above = next(one for one in (folder, *folder.parents) if one.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        raise BadInput(
            f"'{folder}' cannot be made: '{above}' takes no files; choose another folder with "
            '--out.'
        )


@contextmanager
def stage_results(folder: Path, last: str) -> Iterator[Path]:
    """
    Yield where to write results; they appear in their folder when all are there, or none does.

    Parameters
    ----------
    folder : Path
        Of the results; a new one is gone again where the writing fails.
    last : str
        File that appears last: where it is, the others are.

    """
    new, part = not folder.exists(), folder / PART
    try:
        part.mkdir(parents=True)
    except OSError as error:
        raise BadInput(
            f"'{folder}' cannot be made ({error.strerror}); choose another folder with --out."
        ) from error
    try:
        yield part
        for one in sorted(part.iterdir(), key=lambda one: one.name == last):
            one.rename(folder / one.name)
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if new:
            with suppress(OSError):  # holds the results
                folder.rmdir()


def write_json(content: Mapping[str, Any] | list[Any], place: Path) -> str:
    """Write results as JSON and return the text; `BadInput` where the disk does not take it."""
    text = json.dumps(content, indent=1) + '\n'
    try:
        with replace_atomically(place) as part:
            part.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"'{place}' cannot be written ({error.strerror}); make room, or choose another folder "
            'with --out.'
        ) from error
    return text


def format_page_line(page: Path) -> str:
    """Return the line that says where a page is and how to look at it."""
    return f'Page {page}  (open it in a browser: xdg-open {shlex.quote(str(page))})'
