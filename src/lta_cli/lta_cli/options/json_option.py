"""The option --json, which prints the results for programs; the tables then go to stderr."""

import json
from pathlib import Path
import sys
from typing import Annotated, Any

import typer

Json = Annotated[bool, typer.Option('--json', help='Print the results as JSON.')]


def print_json(content: Any, page: Path | None = None) -> None:  # noqa: ANN401 - plain data
    """Print results, and where their page is."""
    told = content if page is None else {**content, 'page': str(page)}
    sys.stdout.write(json.dumps(told, indent=1) + '\n')


def print_json_text(text: str, page: Path) -> None:
    """Print the results that a file holds as JSON, and where their page is."""
    print_json(json.loads(text), page)
