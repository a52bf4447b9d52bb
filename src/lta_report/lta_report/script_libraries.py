"""
The JavaScript libraries of pages, compressed: plotly.js for figures, three.js for 3-D.

Both come with Python packages, under the MIT licence: plotly.js in plotly, three.js in the viewer
of trimesh. A page contains them as zlib data in base 85, a third of their size, and `page.js`
unpacks them.
"""

from base64 import b85encode
from functools import cache
from importlib.util import find_spec
from pathlib import Path
import re
from typing import Final
import zipfile
import zlib

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
    found = THREE.search(''.join(texts))
    return found[0] if found else ''


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
    """Return a script as compressed data in an HTML element."""
    data = zlib.compress(text.encode(), 9)
    # The alphabet of base 85 has no slash, so no text in it can close the element
    packed = b85encode(data, pad=True).decode()
    return f'<script type="text/plain" id="{name}" data-size="{len(data)}">{packed}</script>'
