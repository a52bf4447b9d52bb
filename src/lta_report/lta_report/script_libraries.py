"""
The JavaScript libraries of pages, compressed: plotly.js for figures, three.js for 3-D.

Both come with Python packages, under the MIT licence: plotly.js in plotly, three.js in the viewer
of trimesh. A page contains them as zlib data in base 85, a third of their size, and `page.js`
unpacks them.
"""

from functools import cache
import hashlib
from importlib.util import find_spec
from pathlib import Path
import re
from typing import Final
import zipfile

from lta_config.atomic_file import replace_atomically
from lta_config.machine import find_cache_folder
from lta_report.html_elements import pack_text
from plotly.offline import get_plotlyjs

VIEWER: Final = 'resources/templates/viewer.zip'  # in trimesh: a page that starts with three.js
THREE: Final = re.compile(
    r'/\*\*\s*\* @license\s*\* Copyright [\d-]+ Three\.js Authors'
    r'.*?"__esModule",\{value:!0\}\)\}\)\);',
    re.DOTALL,
)


@cache
def read_three() -> str:
    """Return three.js with its licence text, or '' if trimesh comes without it."""
    # trimesh is not imported: that takes longer than writing a page
    package = find_spec('trimesh')
    if package is None or package.origin is None:
        return ''
    try:
        with zipfile.ZipFile(Path(package.origin).parent / VIEWER) as archive:
            texts = [archive.read(name).decode() for name in archive.namelist()]
    except (OSError, ValueError, zipfile.BadZipFile):
        return ''
    match = THREE.search(''.join(texts))
    return match[0] if match else ''


@cache
def embed_plotly() -> str:
    """Return plotly.js as an HTML element."""
    return embed_library('plotly', get_plotlyjs())


@cache
def embed_three() -> str:
    """Return three.js as an HTML element; '' if it is missing."""
    text = read_three()
    return embed_library('three', text) if text else ''


def embed_library(name: str, text: str) -> str:
    """Return a script as compressed data in an HTML element; packed once on each machine."""
    source = hashlib.sha256(text.encode()).hexdigest()[:16]
    try:
        stored = find_cache_folder('pages') / f'{name}-{source}.html'
        if not stored.exists():
            with replace_atomically(stored) as part:
                part.write_text(pack_text(name, text, 'text/plain'), encoding='ascii')
        return stored.read_text(encoding='ascii')
    except OSError:  # no cache: a full disk, or a folder of somebody else
        return pack_text(name, text, 'text/plain')
