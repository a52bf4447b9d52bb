"""The argument of verbs that look at a vehicle."""

from typing import Annotated

import typer

Named = Annotated[str, typer.Argument(metavar='VEHICLE', help='Shipped name or file.')]
