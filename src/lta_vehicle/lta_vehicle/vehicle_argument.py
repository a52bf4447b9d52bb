"""Define the VEHICLE argument of the `lta vehicle` commands."""

from typing import Annotated

import typer

Named = Annotated[
    str,
    typer.Argument(
        metavar='VEHICLE', help='Name of a shipped vehicle, or path of a vehicle file.'
    ),
]
