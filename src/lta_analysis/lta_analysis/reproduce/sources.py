"""What a row rests on: the code and files of all packages, those of other rows left out."""

from collections.abc import Iterator
import hashlib
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from lta_config.files import share

PACKAGES: Final = (
    'lta_analysis', 'lta_bridge', 'lta_config', 'lta_control', 'lta_energy', 'lta_sim', 'lta_vlc',
)  # fmt: skip
OF_ROWS: Final = ('studies', 'paper')  # folders with one file a row


def digest(name: str) -> str:
    """Return a hash that changes when the figures of a row may."""
    found = hashlib.sha256()
    for path in sources(name):
        found.update(f'{path.parent.name}/{path.name}'.encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def sources(name: str) -> Iterator[Path]:
    """Yield the files that a row rests on, in the same order everywhere."""
    roots = [(share(), '*.yaml')]
    for package in PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        roots.append((Path(spec.origin).parent, '*.py'))
    for root, pattern in roots:
        for path in sorted(root.rglob(pattern)):
            if path.parent.name not in OF_ROWS or path.stem == name:
                yield path
