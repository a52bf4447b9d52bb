# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Describe the origin of an imported bag: source file, mapping and kind of data."""

from collections.abc import Mapping
from datetime import datetime, UTC
import hashlib
from pathlib import Path
from typing import Final

from lta_bag.provenance import read_commit
from lta_config.files import find_file
from lta_config.schema.import_file import ImportMapping
from lta_config.version import VERSION

HASHED_BYTES = 1 << 20  # bytes
CLOCK_KEY: Final = 'clock'  # provenance key of logs whose stamps share no clock with others


def have_separate_clocks(a: Mapping[str, str], b: Mapping[str, str]) -> bool:
    """
    Return whether two recordings have separate clocks, so that equal stamps mean nothing.

    One source imported twice counts as one clock.
    """
    sources = a.get('source_sha256'), b.get('source_sha256')
    return CLOCK_KEY in a and CLOCK_KEY in b and sources[0] != sources[1]


def build_provenance(
    source: Path, format_: str, mapping: ImportMapping | None, text: str, vehicle: str | None
) -> dict[str, str]:
    """
    Return the provenance of an imported bag.

    `text` is the whole mapping file; `vehicle` is the flown vehicle, by name or file.
    """
    facts = {
        'source': source.name,
        'source_sha256': source_digest(source),
        'source_size': str(source_size(source)),
        'format': format_,
        'importer': f'lta import {VERSION}',
        'commit': read_commit(),
        'created': datetime.now(UTC).isoformat(timespec='seconds'),
    }
    if mapping is not None:
        facts |= {'data': mapping.data, 'mapping': mapping.name, 'mapping_file': text}
    if vehicle is not None:
        path = find_file('vehicle', vehicle)
        facts |= {'vehicle': vehicle, 'vehicle_file': path.read_text(encoding='utf-8')}
    return facts


def list_source_files(source: Path) -> list[Path]:
    """Return the files of a source."""
    if not source.is_dir():
        return [source]
    # Sorted, so that the digest does not depend on the file system
    return sorted(path for path in source.rglob('*') if path.is_file())


def source_size(source: Path) -> int:
    """Return the size of a file, or of all files in a folder [bytes]."""
    return sum(path.stat().st_size for path in list_source_files(source))


def source_digest(source: Path) -> str:
    """Return the SHA-256 of a file; for a folder, one line per file as `sha256sum` writes them."""
    if not source.is_dir():
        return _hash_file(source)
    return '\n'.join(
        f'{_hash_file(path)}  {path.relative_to(source)}' for path in list_source_files(source)
    )


def _hash_file(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open('rb') as stream:
        while block := stream.read(HASHED_BYTES):
            digest.update(block)
    return digest.hexdigest()
