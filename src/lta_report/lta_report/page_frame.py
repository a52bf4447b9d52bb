"""
Read the files of pages in `assets`, and write pages.

A file has a style between `<style>` and `</style>`, then further content. Those of the frame and
of reports have placeholders.
"""

from importlib.resources import files
from pathlib import Path
from typing import Final

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput

BEGIN: Final = '<style>\n'
END: Final = '</style>\n'


def read_asset(name: str) -> str:
    """Return the text of a file in `assets`."""
    return (files('lta_report') / 'assets' / name).read_text(encoding='utf-8')


def split_template(text: str) -> list[str]:
    """Return style and content of a page's file."""
    return text.removeprefix(BEGIN).split(END, 1)


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
