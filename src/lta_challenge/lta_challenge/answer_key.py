"""
Answers in a file that nobody reads by accident.

A line that says what it is, the SHA-256 of the answers, and the answers as JSON, compressed and in
base64: not secret, only out of sight. Discovery opens no such file; the score does, afterwards.
"""

import base64
from collections.abc import Mapping
import hashlib
import json
from pathlib import Path
from typing import Any, Final
import zlib

from lta_config.errors import BadInput

NOTE: Final = 'Answers of a challenge, sealed; `lta challenge score` opens them after the study.'
NAME: Final = 'answers.sealed'


def write_answers(answers: Mapping[str, Any], path: Path) -> str:
    """Write answers and return their SHA-256."""
    text = json.dumps(answers, sort_keys=True)
    digest = hashlib.sha256(text.encode()).hexdigest()
    data = base64.b64encode(zlib.compress(text.encode(), 9)).decode()
    path.write_text(f'{NOTE}\n{digest}\n{data}\n', encoding='utf-8')
    return digest


def read_digest(path: Path) -> str:
    """Return the SHA-256 of sealed answers; errors as `read_answers`."""
    read_answers(path)  # which holds the answers against it
    return path.read_text(encoding='utf-8').splitlines()[1]


def read_answers(path: Path) -> dict[str, Any]:
    """
    Return sealed answers.

    Raises
    ------
    BadInput
        If there are none, or they are not what was sealed.

    """
    try:
        note, digest, data = path.read_text(encoding='utf-8').splitlines()
        text = zlib.decompress(base64.b64decode(data, validate=True)).decode()
    except OSError as error:
        raise BadInput(
            f"'{path}' cannot be read ({error.strerror}); make the challenge again."
        ) from None
    except (ValueError, zlib.error):
        raise BadInput(f"'{path}' is not an answer key; make the challenge again.") from None
    if note != NOTE or hashlib.sha256(text.encode()).hexdigest() != digest:
        raise BadInput(f"'{path}' was changed after it was made; make the challenge again.")
    found: dict[str, Any] = json.loads(text)
    return found
