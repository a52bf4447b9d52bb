# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""HTML elements of pages: tiles, tables, figures, definition lists and embedded data."""

from base64 import b85encode
from collections.abc import Mapping
from html import escape
import json
import re
from typing import Final
import zlib

from lta_report.palette import DARK
from plotly.graph_objects import Figure

ALLOWED_TAGS: Final = (
    'br|/?(b|i|sub|sup|extra)|span style="color:#[0-9a-f]{6}"|/span'  # tags we use
)
JSON_TYPE: Final = 'application/json'  # type of an element with data
MARKUP: Final = re.compile(f'<(?!({ALLOWED_TAGS})>)')  # the start of any other tag


def embed_data(name: str, content: object) -> str:
    """Return data for the page's script as an HTML element."""
    return embed_json(name, format_json(content))


def format_json(content: object) -> str:
    """Return data as JSON without spaces."""
    return json.dumps(content, separators=(',', ':'), allow_nan=False)


def pack_text(name: str, text: str, kind: str) -> str:
    """Return text as zlib data in base 85 in an HTML element, which `page.js` unpacks."""
    data = zlib.compress(text.encode(), 9)
    # The alphabet of base 85 has no slash, so no text in it can close the element
    packed = b85encode(data, pad=True).decode()
    return f'<script type="{kind}" id="{name}" data-size="{len(data)}">{packed}</script>'


def embed_json(name: str, text: str) -> str:
    """Return JSON for the page's script; no text in it can close the element."""
    # The same character to a JSON parser, but "</script>" no longer occurs
    safe = text.replace('<', '\\u003c')
    return f'<script type="{JSON_TYPE}" id="{name}">{safe}</script>'


def render_colors(colors: Mapping[str, str]) -> str:
    """Return the style that defines colours, by name without its dashes, in both themes."""
    light, dark = (
        ' '.join(f'--{name}: {each(color)};' for name, color in colors.items())
        for each in (str, DARK.__getitem__)
    )
    return f"<style>:root {{ {light} }} :root[data-theme='dark'] {{ {dark} }}</style>"


def render_tile(name: str, value: str, unit: str, note: str) -> str:
    """Return one large number as HTML."""
    return (
        f'<div class="tile"><dt>{escape(name)}</dt><dd><b>{escape(value)}</b> '
        f'<span>{escape(unit)}</span><small>{escape(note)}</small></dd></div>'
    )


def render_section(
    name: str,
    heading: str,
    caption: str,
    picture: Figure,
    *,
    timed: bool = False,
    height: int | None = None,
    more: str = '',
    packed: bool = False,
) -> str:
    """
    Return one figure with heading, caption and data.

    Parameters
    ----------
    name : str
        Id of the figure on its page.
    heading, caption : str
        Plain text.
    timed : bool
        Whether x is time: such figures share a cursor and zoom together.
    height : int, optional
        Height of the figure; by default that of the page's style. [px]
    more : str
        HTML below the caption.
    packed : bool
        Whether to compress the data of the figure; the page's own script then finds it late.

    """
    words, about = escape(heading), escape(caption)
    style = '' if height is None else f'style="height: {height}px" '
    below = f'<figcaption>{about}</figcaption>' if about else ''
    text, place = format_json(sanitize_figure(picture)), f'figure-{name}'
    data = pack_text(place, text, JSON_TYPE) if packed else embed_json(place, text)
    return (
        f'<figure class="panel" id="panel-{name}" aria-labelledby="title-{name}">'
        f'<h2 id="title-{name}">{words}</h2><div class="plot" data-panel="{name}" '
        f'data-timed="{str(timed).lower()}" {style}role="img" aria-label="{words}. {about}"></div>'
        f'{below}{data}{more}</figure>'
    )


def sanitize_figure(picture: Figure) -> object:
    """
    Return a figure as JSON content with all markup escaped except the tags we use.

    Plotly renders some HTML in texts, including links, and names may come from untrusted files.
    """
    return _sanitize_part(json.loads(picture.to_json()))


def _sanitize_part(part: object) -> object:
    if isinstance(part, str):
        return MARKUP.sub('&lt;', part)
    if isinstance(part, list):
        return [_sanitize_part(each) for each in part]
    if isinstance(part, dict):
        return {key: _sanitize_part(each) for key, each in part.items()}
    return part


def render_definition_list(content: Mapping[str, str], code: bool = False) -> str:
    """Return a definition list; with `code`, the values are commands to type."""
    mark = ('<code>', '</code>') if code else ('', '')
    return '\n'.join(
        f'<div><dt>{escape(name.replace("_", " "))}</dt>'
        f'<dd>{mark[0]}{escape(text)}{mark[1]}</dd></div>'
        for name, text in content.items()
    )


def render_footer(
    facts: Mapping[str, str], commands: Mapping[str, str], files: Mapping[str, str]
) -> str:
    """
    Return the footer of a page.

    `facts`: origin of the results. `commands`: next steps: what to do, and the command for it.
    `files`: whole files by name, collapsed.
    """
    lists = [f'<dl class="facts">\n{render_definition_list(facts)}\n</dl>'] if facts else []
    if commands:
        lists.append(
            f'<dl class="facts commands">\n{render_definition_list(commands, code=True)}\n</dl>'
        )
    folded = [
        f'<details><summary>{escape(name)}</summary>'
        f'<pre tabindex="0">{escape(text)}</pre></details>'
        for name, text in files.items()
    ]
    # The heading names only what the footer has
    words = [
        *(['origin'] if facts else []),
        *(['next steps'] if commands else []),
    ]
    inside = '\n'.join(lists) if len(lists) < 2 else f'<div class="halves">{"".join(lists)}</div>'
    return (
        '<section class="panel ending" aria-labelledby="title-ending">'
        f'<h2 id="title-ending">{" and ".join(words).capitalize()}</h2>\n'
        f'{inside}{"".join(folded)}</section>'
    )
