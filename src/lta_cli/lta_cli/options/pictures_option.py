"""Define the option --pictures, the folder for a page's figures as PNG files."""

from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_report.browser import find_chromium
import typer

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
