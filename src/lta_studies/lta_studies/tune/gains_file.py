"""Write gains as a ROS parameter file like those in `config/control`, with their origin."""

from collections.abc import Sequence
from pathlib import Path

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from pydantic import BaseModel
import yaml

DIGITS = 4  # significant digits; the search is not more precise


def round_gain(value: float) -> float:
    """Round a gain to the digits that are written."""
    return float(f'{value:.{DIGITS}g}')


def format_gains(gains: BaseModel, about: Sequence[str]) -> str:
    """Return the text of a parameter file; the lines in `about` become the comment on top."""
    lines = [f'# {line}' for line in about]
    lines += ['/**/controller:', '  ros__parameters:', '    gains:']
    for name, value in gains.model_dump().items():
        # Flow style puts each loop on one line; the large width prevents a line break.
        text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=1000)
        # For a bare number `safe_dump` adds a second line '...', which is dropped.
        lines.append(f'      {name}: {text.splitlines()[0]}')
    return '\n'.join(lines) + '\n'


def write_gains(gains: BaseModel, about: Sequence[str], path: Path) -> None:
    """Write a parameter file; raise `BadInput` if that fails."""
    try:
        # An interrupt leaves either the old file or the whole new one.
        with replace_atomically(path) as part:
            part.write_text(format_gains(gains, about), encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"The gains cannot be written to '{path}' ({error.strerror}); choose another --out."
        ) from None
