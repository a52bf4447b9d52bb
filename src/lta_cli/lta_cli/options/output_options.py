"""Define the output options of all commands: --json, --out and --pictures."""

from collections.abc import Mapping
import json
from pathlib import Path
import sys
from typing import Annotated, Any

from lta_bridge.bag.writer import prepare_empty_folder
from lta_report.browser import find_chromium
import typer

# JSON goes to stdout, tables then go to stderr
Json = Annotated[bool, typer.Option('--json', help='Print the results as JSON.')]


def print_json(content: Any, page: Path | None = None) -> None:  # noqa: ANN401 - plain data
    """Print results, with the path of their page if they have names."""
    named = page is not None and isinstance(content, Mapping)
    shown = {**content, 'page': str(page)} if named else content
    # One write for the whole text, so that other output cannot split it
    sys.stdout.write(json.dumps(shown, indent=1) + '\n')


def print_json_text(text: str, page: Path) -> None:
    """Print results that are already JSON text, with the path of their page."""
    print_json(json.loads(text), page)


def parse_folder(text: str) -> Path:
    """Return a folder; refuse empty text (an unset shell variable), which would mean '.'."""
    if not text.strip():
        raise typer.BadParameter('the path is empty; give a folder or file')
    return Path(text)


Out = Annotated[
    Path | None,
    typer.Option(
        help='Folder of the results; runs/<time>-<name> by default.',
        # A parser instead of Click's path type, to refuse empty text
        parser=parse_folder,
        metavar='FOLDER',
    ),
]
Pictures = Annotated[
    Path | None,
    typer.Option(
        help='Write each figure as PNG to this folder; needs Chromium.', metavar='FOLDER'
    ),
]


def check_picture_output(folder: Path | None) -> None:
    """Check, before any work, that pictures can be taken and written."""
    if folder is not None:
        find_chromium()  # raises BadInput if there is none
        # Also raises BadInput if the folder is not empty
        prepare_empty_folder(folder)
