# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a browser would make of a page: its elements, its scripts, the texts of its pictures."""

import base64
from collections.abc import Iterator
from html.parser import HTMLParser
import json
import zlib

MARK = 'xyzzy'  # in whatever a stranger wrote
EVIL = (
    f'<script>alert("{MARK}")</script>',
    f'</script><img src=x onerror={MARK}()>',
    f'"><svg onload={MARK}()>',
    f"' onmouseover='{MARK}()",
    f'<a href="javascript:{MARK}()">{MARK}</a>',
    f'<!--{MARK}',
    f'</title><style>{MARK}',
    f'${{{MARK}}} $title %{{{MARK}}}',
)
ALL = ''.join(EVIL)  # in one name, where making a page takes its time
WORDY = {'aria-label', 'title', 'value', 'data-channel', 'data-panel', 'alt'}  # hold any text


class Page(HTMLParser):
    """
    A page that holds a stranger's names.

    Attributes
    ----------
    words : str
        All text that is shown.
    data : dict
        What its scripts read, by id.

    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self._open: list[str] = []
        self.words, self.data = '', {}
        self._reads, self._size = '', 0
        self.feed(text)
        self.close()
        assert not [tag for tag in self._open if tag in ('script', 'style', 'title')]

    def handle_starttag(self, tag, attrs):
        """Look at an element: none is a stranger's, and none does what a stranger says."""
        assert MARK not in tag
        given = dict(attrs)
        for name, value in given.items():
            assert MARK not in name
            assert not name.startswith('on')
            assert MARK not in (value or '') or name in WORDY, (tag, name, value)
        self._open.append(tag)
        if tag == 'script':
            # Libraries have a name as well, and are no JSON
            self._reads = given.get('id', '') if given.get('type') == 'application/json' else ''
            self._size = int(given.get('data-size', 0))
            assert 'src' not in given

    def handle_endtag(self, tag):
        """Close an element."""
        while self._open and self._open.pop() != tag:
            pass

    def handle_data(self, data):
        """Look at text: in a script, or shown."""
        inside = self._open[-1] if self._open else ''
        if inside == 'script' and self._reads:
            if self._size:
                data = zlib.decompress(base64.b85decode(data)[: self._size])
            self.data[self._reads] = json.loads(data)
        elif inside in ('script', 'style'):
            assert MARK not in data, data[:200]
        else:
            self.words += data

    def handle_comment(self, data):
        """Look at a comment."""
        assert MARK not in data


def texts(part: object) -> Iterator[str]:
    """Yield all texts of what a script reads."""
    if isinstance(part, str):
        yield part
    elif isinstance(part, list):
        for each in part:
            yield from texts(each)
    elif isinstance(part, dict):
        for each in part.values():
            yield from texts(each)


def inert(text: str) -> Page:
    """Return a page after a look at all of it: what a stranger wrote is words and no more."""
    page = Page(text)
    for name, content in page.data.items():
        if name.startswith('figure-'):  # plotly takes some HTML in texts
            assert not [each for each in texts(content) if MARK in each and '<' in each], name
    return page
