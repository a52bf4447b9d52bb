"""The option --json, which prints the results for programs; the tables then go to stderr."""

import json
from pathlib import Path
import sys
from typing import Annotated

import typer

Json = Annotated[bool, typer.Option('--json', help='Print the results as JSON.')]


def print_json(content: str, page: Path) -> None:
    """Print the results that a file holds as JSON, and where their page is."""
    sys.stdout.write(json.dumps({**json.loads(content), 'page': str(page)}) + '\n')
