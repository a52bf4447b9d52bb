"""The option --pictures, which says where each picture of a page goes as PNG."""

from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_report.browser import find_chromium
import typer

Pictures = Annotated[
    Path | None,
    typer.Option(help='Folder for each picture as PNG; needs a Chromium.', metavar='FOLDER'),
]


def check_pictures(folder: Path | None) -> None:
    """Refuse, before any work, pictures that could not be taken or written."""
    if folder is not None:
        find_chromium()  # says what is missing
        prepare_empty_folder(folder)
