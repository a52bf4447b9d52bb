"""
Store the answers of a challenge in encoded form, so that nobody reads them by accident.

The file has three lines: a note, the SHA-256 of the answers, and the answers as compressed JSON
in base64. It is not encrypted. Only the score reads it, after discovery has run.
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
    # Sorted keys, so that equal answers have equal digests
    text = json.dumps(answers, sort_keys=True)
    digest = hashlib.sha256(text.encode()).hexdigest()
    data = base64.b64encode(zlib.compress(text.encode(), 9)).decode()
    path.write_text(f'{NOTE}\n{digest}\n{data}\n', encoding='utf-8')
    return digest


def read_digest(path: Path) -> str:
    """Return the SHA-256 of the answers; raises the errors of `read_answers`."""
    read_answers(path)  # verifies the digest
    return path.read_text(encoding='utf-8').splitlines()[1]


def read_answers(path: Path) -> dict[str, Any]:
    """Read the answers; raise BadInput if the file cannot be read or was changed."""
    try:
        # A wrong number of lines raises ValueError, handled below
        note, digest, data = path.read_text(encoding='utf-8').splitlines()
        text = zlib.decompress(base64.b64decode(data, validate=True)).decode()
    except OSError as error:
        raise BadInput(
            f"The answer key '{path}' cannot be read ({error.strerror}); create the challenge "
            'again with "lta challenge make".'
        ) from None
    except (ValueError, zlib.error):
        raise BadInput(
            f"'{path}' is not a valid answer key; create the challenge again with "
            '"lta challenge make".'
        ) from None
    if note != NOTE or hashlib.sha256(text.encode()).hexdigest() != digest:
        raise BadInput(
            f"The answer key '{path}' was changed after it was created; create the challenge "
            'again with "lta challenge make".'
        )
    answers: dict[str, Any] = json.loads(text)
    return answers
