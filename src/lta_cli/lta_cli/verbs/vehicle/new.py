"""lta vehicle new: begin a vehicle file with a copy of one that flies."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_vehicle.new_vehicle import write_new_vehicle
import typer


def new(
    name: Annotated[str, typer.Argument(help='Of the new vehicle, for example my_blimp.')],
    model: Annotated[
        str, typer.Option('--from', metavar='VEHICLE', help='Name or file to copy.')
    ] = 'gtmab',
    out: Annotated[Path | None, typer.Option(help='File to write; NAME.yaml by default.')] = None,
) -> None:
    """
    Begin a vehicle file: a copy of one that flies, comments kept, under a new name.

    Nothing is overwritten. Put in your own numbers, each with its source, and look at it with
    "lta vehicle show".

    Example: lta vehicle new my_blimp --from gtmab
    """
    path = out or Path(f'{name}.yaml')
    write_new_vehicle(name, model, path)
    console = plain_console()
    console.print(f'File {path}', highlight=False, soft_wrap=True)
    line = format_lta_command('vehicle', 'check', _format_path(path))
    console.print(f'Put in your own numbers, then: {line}', highlight=False, soft_wrap=True)


def _format_path(path: Path) -> str:
    """Return a path that nobody takes for a shipped name."""
    text = str(relative_path(path))
    return text if '/' in text or text.endswith(('.yaml', '.yml')) else f'./{text}'
