"""Define the option --out, the folder of a verb's results."""

from pathlib import Path
from typing import Annotated

import typer


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
