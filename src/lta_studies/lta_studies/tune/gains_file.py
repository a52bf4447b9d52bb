"""A file of gains as `config/control` has them, with a word on where they come from."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from pydantic import BaseModel
import yaml

DIGITS = 4  # significant; more would claim more than a search finds


def round_gain(value: float) -> float:
    """Return a number as it is written."""
    return float(f'{value:.{DIGITS}g}')


def format_gains(gains: BaseModel, about: Sequence[str]) -> str:
    """
    Return the text of a parameter file.

    Parameters
    ----------
    gains : Settings
        What it holds.
    about : sequence of str
        Lines of the comment above.

    """
    lines = [f'# {line}' for line in about]
    lines += ['/**/controller:', '  ros__parameters:', '    gains:']
    for name, value in gains.model_dump().items():
        text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=1000)
        lines.append(f'      {name}: {text.splitlines()[0]}')
    return '\n'.join(lines) + '\n'


def write_gains(gains: BaseModel, about: Sequence[str], path: Path) -> None:
    """Write a parameter file; `BadInput` where that cannot be."""
    with _ensure_folder(path), replace_atomically(path) as part:
        part.write_text(format_gains(gains, about), encoding='utf-8')


def check_writable(path: Path) -> None:
    """Refuse a place where no file can be written, with `BadInput`; leave it as it was."""
    with _ensure_folder(path):
        was = path.exists()
        path.open('a', encoding='utf-8').close()
        if not was:
            path.unlink()


@contextmanager
def _ensure_folder(path: Path) -> Iterator[None]:
    """Make the folder of a file; what goes wrong there is a sentence."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        raise BadInput(
            f"The gains cannot be written to '{path}' ({error.strerror}); choose another --out."
        ) from None
