"""lta effects new: write the skeleton of an effect of one's own."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_config.command_line import relative_path
from lta_vehicle.effect_skeleton import write_skeleton
import typer


def new(
    name: Annotated[str, typer.Argument(help='Name of the new effect, for example guide_rope.')],
    out: Annotated[Path | None, typer.Option(help='Folder to write; NAME by default.')] = None,
) -> None:
    """
    Write the skeleton of an effect: a Python file, and the package that installs it.

    Replace its example by the equations of the cause, such as of a force that "lta discover"
    names. After "pip install", "lta effects" lists it, and vehicle files can use it.

    Example: lta effects new guide_rope
    """
    folder = out or Path(name)
    files = write_skeleton(name, folder)
    console = plain_console()
    for path in files:
        console.print(f'File {path}', highlight=False, soft_wrap=True)
    console.print(
        f'Enter equations, bounds and sources, then run: .venv/bin/pip install '
        f'{relative_path(folder)}, and lta effects {name}',
        highlight=False,
        soft_wrap=True,
    )
