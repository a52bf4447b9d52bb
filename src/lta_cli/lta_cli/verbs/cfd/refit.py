"""lta cfd refit: fit an aero file to a stored sweep, without OpenFOAM."""

from pathlib import Path
import sys
from typing import Annotated

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from lta_config.files import share_folder
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.sweep_table import read_sweep
import typer


def refit(
    sweep: Annotated[
        str,
        typer.Argument(
            metavar='SWEEP',
            help='CFD results to fit: a .sweep.json file, or the name of one in config/aero.',
        ),
    ],
    file: Annotated[
        Path | None, typer.Option(help='Aero file to write; printed by default.', metavar='FILE')
    ] = None,
) -> None:
    """
    Refit the coefficients of a sweep that "lta cfd run" wrote, without solving anything.

    Exit status 0: done. 2: bad input.

    Example: lta cfd refit gtmab
    """
    path = Path(sweep)
    # A plain word is a shipped name, anything else a path
    if '/' not in sweep and not sweep.endswith('.json'):
        path = share_folder() / 'aero' / f'{sweep}.sweep.json'
    text = format_aero_file(read_sweep(path))
    if file is None:
        sys.stdout.write(text)
        return
    try:
        # An interrupted write must not leave half a file that a vehicle refers to
        with replace_atomically(file) as part:
            part.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"'{file}' cannot be written ({error.strerror}); choose another one with --file."
        ) from error
