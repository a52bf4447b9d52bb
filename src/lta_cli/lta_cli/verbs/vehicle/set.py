"""lta vehicle set: set numbers in a vehicle file, with their source."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_vehicle.number_edit import edit_vehicle_file
import typer


def set_(
    file: Annotated[Path, typer.Argument(help='Vehicle file to change.')],
    changes: Annotated[
        list[str],
        typer.Argument(metavar='PATH=VALUE...', help="Numbers to set: 'trim.heaviness=3 g'."),
    ],
    source: Annotated[
        str | None,
        typer.Option(
            help="Source of these numbers, such as 'kitchen scale'; by default the file's stay."
        ),
    ] = None,
) -> None:
    """
    Set numbers in a vehicle file, with their source; comments and order stay.

    Paths are those of --set. Warns if a number changed and its source did not. The file is
    replaced only if the result is a valid vehicle.

    Example: lta vehicle set my_blimp.yaml 'trim.heaviness=3 g' --source 'kitchen scale'
    """
    console = plain_console()
    for edit in edit_vehicle_file(file, changes, source):
        source_note = f', source: {edit.source}' if edit.source else ''
        lines = [f'{edit.path}: {edit.before} -> {edit.after}{source_note}']
        if edit.is_stale:
            lines.append(
                f'! {edit.path} changed, but its source is still "{edit.source}"; name the new '
                'one with --source.'
            )
        console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
