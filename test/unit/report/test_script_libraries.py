# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The JavaScript libraries that pages contain: complete, with their licences, and small."""

import base64
import re
import zlib

from lta_report.report_page import embed_library, embed_plotly, embed_three, read_three
from plotly.offline import get_plotlyjs

ELEMENT = re.compile(r'<script type="text/plain" id="(\w+)" data-size="(\d+)">([^/]*)</script>')
MOST = 2_000_000  # bytes of a page without a 3-D view; most of it is plotly


def unpack(element):
    name, size, text = ELEMENT.fullmatch(element).groups()
    return name, zlib.decompress(base64.b85decode(text)[: int(size)]).decode()


def test_a_library_is_the_same_after_unpacking():
    assert unpack(embed_library('any', 'let a = 1;\n' * 7)) == ('any', 'let a = 1;\n' * 7)
    assert unpack(embed_plotly()) == ('plotly', get_plotlyjs())
    assert unpack(embed_three()) == ('three', read_three())


def test_the_libraries_bring_their_licences():
    assert 'Licensed under the MIT license' in get_plotlyjs()[:300]
    assert 'Three.js Authors' in read_three()[:200]
    assert 'SPDX-License-Identifier: MIT' in read_three()[:200]


def test_three_ends_where_the_viewer_of_trimesh_begins():
    assert 'WebGLRenderer' in read_three()
    assert 'TrackballControls' not in read_three()


def test_plotly_leaves_space_for_the_content_of_a_page():
    assert len(embed_plotly()) < MOST - 150_000


def test_a_library_is_packed_once_and_without_a_cache_each_time(tmp_path, monkeypatch):
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path))
    packed = embed_library('any', 'let a = 2;')
    (stored,) = (tmp_path / 'lta/pages').iterdir()
    assert stored.read_text() == packed
    stored.write_text('from the cache')
    assert embed_library('any', 'let a = 2;') == 'from the cache'
    assert unpack(embed_library('any', 'let a = 3;')) == ('any', 'let a = 3;')
    stored.unlink()
    stored.mkdir()  # cannot be read
    assert embed_library('any', 'let a = 2;') == packed
