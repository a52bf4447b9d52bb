"""Define the options that commands share: the vehicle, where results go, and who computes them."""

from collections.abc import Callable, Mapping
import json
from pathlib import Path
import sys
from typing import Annotated, Any

from lta_config.files import FOLDERS, list_shipped_names
import typer


def complete_names(kind: str) -> Callable[[str], list[str]]:
    """Return the function with which a shell completes the name of a shipped file."""

    def find(incomplete: str) -> list[str]:
        return [name for name in list_shipped_names(FOLDERS[kind]) if name.startswith(incomplete)]

    return find


VehicleName = Annotated[
    str,
    typer.Argument(
        metavar='VEHICLE',
        help='Name of a shipped vehicle, or path of a vehicle file.',
        autocompletion=complete_names('vehicle'),
    ),
]
VehicleOption = Annotated[
    str, typer.Option(help='Vehicle name or file.', autocompletion=complete_names('vehicle'))
]
RobotOption = Annotated[str | None, typer.Option(help='Robot; needed if a bag has several.')]
# JSON goes to stdout, tables then go to stderr
Json = Annotated[bool, typer.Option('--json', help='Print the results as JSON.')]


def print_json(content: Any, page: Path | None = None) -> None:  # noqa: ANN401 - plain data
    """Print results, with the path of their page if they have names."""
    named = page is not None and isinstance(content, Mapping)
    output = {**content, 'page': str(page)} if named else content
    # One write for the whole text, so that other output cannot split it
    sys.stdout.write(json.dumps(output, indent=1) + '\n')


def parse_folder(text: str) -> Path:
    """Return a folder; refuse empty text (an unset shell variable), which would mean '.'."""
    if not text.strip():
        raise typer.BadParameter('the path is empty; give a folder or file')
    return Path(text)


def folder_option(text: str) -> Any:  # noqa: ANN401 - as typer.Option
    """Return the declaration of an option that takes a folder, with its help."""
    # A parser instead of Click's path type, to refuse empty text
    return typer.Option(help=text, parser=parse_folder, metavar='FOLDER')


Out = Annotated[Path | None, folder_option('Folder of the results; in runs/ by default.')]
Pictures = Annotated[
    Path | None,
    typer.Option(
        help='Write each figure as PNG to this folder; needs Chromium.', metavar='FOLDER'
    ),
]
