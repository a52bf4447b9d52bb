"""Define the option --json: JSON goes to stdout, tables then go to stderr."""

import json
from pathlib import Path
import sys
from typing import Annotated, Any

import typer

Json = Annotated[bool, typer.Option('--json', help='Print the results as JSON.')]


def print_json(content: Any, page: Path | None = None) -> None:  # noqa: ANN401 - plain data
    """Print results, with the path of their page."""
    shown = content if page is None else {**content, 'page': str(page)}
    # One write for the whole text, so that other output cannot split it
    sys.stdout.write(json.dumps(shown, indent=1) + '\n')


def print_json_text(text: str, page: Path) -> None:
    """Print results that are already JSON text, with the path of their page."""
    print_json(json.loads(text), page)
