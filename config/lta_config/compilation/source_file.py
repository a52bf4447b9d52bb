"""
Keep texts on disk under the hash of what they depend on, such as parts of a source file.

To parse and to rewrite functions takes most of the time in which a kernel is composed, and nearly
always the sources are those of the last run. A result depends only on the content of the file, the
rewriting code, the version of Python and the arguments, which are its key: it cannot be stale.
"""

import ast
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
import hashlib
import json
from pathlib import Path
import sys
import tempfile
from typing import Any, final, TypeVar

from lta_config.machine import find_cache_folder

Result = TypeVar('Result', str, list[str])


class StoredResults:
    """
    Texts kept on disk under the hash of all that they depend on, the version of Python included.

    `folder`: name of the cache folder. `inputs`: what the results depend on.
    """

    def __init__(self, folder: str, *inputs: bytes) -> None:
        key = hashlib.sha256(b'\0'.join((*inputs, sys.version.encode()))).hexdigest()
        self.path = find_cache_folder(folder) / f'{key[:32]}.json'
        self._results: dict[str, Any] = _read_results(self.path)
        self._stored = len(self._results)

    def recall(self, compute: Callable[[], Result], *key: Any) -> Result:  # noqa: ANN401 - JSON
        """Return the result stored under a key, computed at first; a text or a list of texts."""
        name = json.dumps(key)
        result: Result | None = self._results.get(name)
        if result is None:
            result = self._results[name] = compute()
        return result

    def store(self) -> None:
        """Write new results; if the folder cannot be written, the next run computes them again."""
        if self._stored == len(self._results):
            return
        # Those of another process that stored in between
        self._results = _read_results(self.path) | self._results
        with suppress(OSError):
            with tempfile.NamedTemporaryFile(
                'w', dir=self.path.parent, suffix='.tmp', delete=False
            ) as file:
                json.dump(self._results, file)
            # Atomic: another process reads the whole file or none
            Path(file.name).replace(self.path)
        self._stored = len(self._results)


@final
class SourceFile(StoredResults):
    """
    A file of Python whose functions are extracted.

    Parameters
    ----------
    content : bytes
        Of the file.
    code : bytes
        Source of the code whose results are stored: an edit of it makes them void.
    prepare : callable
        Applied to each function definition after parsing.

    """

    def __init__(
        self,
        content: bytes,
        code: bytes,
        prepare: Callable[[ast.FunctionDef], ast.FunctionDef],
    ) -> None:
        super().__init__('sources', content, code)
        self._content = content
        self._prepare = prepare
        _FILES.append(self)

    @cached_property
    def definitions(self) -> dict[str, ast.FunctionDef]:
        """The top-level functions of the file; parsed only if a result is missing."""
        return {
            node.name: self._prepare(node)
            for node in ast.parse(self._content).body
            if isinstance(node, ast.FunctionDef)
        }


_FILES: list[SourceFile] = []


def store_results() -> None:
    """Store the new results of all files."""
    for file in _FILES:
        file.store()


def _read_results(path: Path) -> dict[str, Any]:
    """Return stored results; none if there is no file or a broken disk damaged it."""
    try:
        results = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return {}
    return results if isinstance(results, dict) else {}
