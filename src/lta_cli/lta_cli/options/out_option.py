"""The option --out, which says where the results of a verb go."""

from pathlib import Path
from typing import Annotated

import typer


def parse_folder(text: str) -> Path:
    """Return a folder; the empty text of a variable that is not set would be the present one."""
    if not text.strip():
        raise typer.BadParameter('it is empty; give a folder')
    return Path(text)


Out = Annotated[
    Path | None,
    typer.Option(
        help='Folder of the results; runs/<time>-<name> by default.',
        parser=parse_folder,
        metavar='FOLDER',
    ),
]
