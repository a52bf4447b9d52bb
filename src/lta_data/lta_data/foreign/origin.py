"""What an imported bag says of its origin: the file, how it was read, and what it is."""

from datetime import datetime, UTC
import hashlib
from pathlib import Path

from lta_bridge.provenance import commit
from lta_config.files import find
from lta_config.schema.import_file import Mapping
from lta_config.version import VERSION

BLOCK = 1 << 20


def origin(
    source: Path, format_: str, mapping: Mapping | None, text: str, vehicle: str | None
) -> dict[str, str]:
    """
    Return the provenance of an imported bag.

    Parameters
    ----------
    source : Path
        What was imported.
    format_ : str
        Its format.
    mapping : Mapping or None
        How it was read.
    text : str
        The whole mapping file.
    vehicle : str or None
        The vehicle that flew, by name or file.

    """
    told = {
        'source': source.name,
        'source_sha256': digest(source),
        'source_size': str(size(source)),
        'format': format_,
        'importer': f'lta import {VERSION}',
        'data': 'measured' if mapping is None else mapping.data,
        'commit': commit(),
        'created': datetime.now(UTC).isoformat(timespec='seconds'),
    }
    if mapping is not None:
        told |= {'mapping': mapping.name, 'mapping_file': text}
    if vehicle is not None:
        path = find('vehicle', vehicle)
        told |= {'vehicle': vehicle, 'vehicle_file': path.read_text(encoding='utf-8')}
    return told


def files(source: Path) -> list[Path]:
    """Return the files that a source is made of."""
    if not source.is_dir():
        return [source]
    return sorted(path for path in source.rglob('*') if path.is_file())


def size(source: Path) -> int:
    """Return the size of a file, or of all files in a folder. [bytes]"""
    return sum(path.stat().st_size for path in files(source))


def digest(source: Path) -> str:
    """Return the SHA-256 of a file; of a folder, one line a file as `sha256sum` writes them."""
    if not source.is_dir():
        return _digest(source)
    return '\n'.join(f'{_digest(path)}  {path.relative_to(source)}' for path in files(source))


def _digest(path: Path) -> str:
    found = hashlib.sha256()
    with path.open('rb') as stream:
        while block := stream.read(BLOCK):
            found.update(block)
    return found.hexdigest()
