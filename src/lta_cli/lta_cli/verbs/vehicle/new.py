"""lta vehicle new: create a vehicle file from an existing one."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_vehicle.new_vehicle import write_new_vehicle
import typer


def new(
    name: Annotated[str, typer.Argument(help='Name of the new vehicle, for example my_blimp.')],
    model: Annotated[
        str, typer.Option('--from', metavar='VEHICLE', help='Vehicle to copy, name or file.')
    ] = 'gtmab',
    out: Annotated[
        Path | None, typer.Option(help='Vehicle file to write; NAME.yaml by default.')
    ] = None,
) -> None:
    """
    Create a vehicle file: a copy of an existing one, with its comments, under a new name.

    Existing files are not overwritten. Enter your own numbers, each with its source, and inspect
    the result with "lta vehicle show".

    Example: lta vehicle new my_blimp --from gtmab
    """
    path = out or Path(f'{name}.yaml')
    write_new_vehicle(name, model, path)
    console = plain_console()
    console.print(f'File {path}', highlight=False, soft_wrap=True)
    line = format_lta_command('vehicle', 'check', _format_explicit_path(path))
    console.print(
        f'Replace the numbers copied from {model} with your own, then run: {line}',
        highlight=False,
        soft_wrap=True,
    )


def _format_explicit_path(path: Path) -> str:
    """Format a path so that it cannot be mistaken for a shipped name."""
    text = str(relative_path(path))
    # A word without slash and ending is taken as the name of a shipped vehicle
    return text if '/' in text or text.endswith(('.yaml', '.yml')) else f'./{text}'
