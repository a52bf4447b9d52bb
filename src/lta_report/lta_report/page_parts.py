"""The pieces that every page is put together from, as HTML: tiles, pictures, terms, data."""

from collections.abc import Mapping, Sequence
from html import escape
import json
import re
from typing import Final

from plotly.graph_objects import Figure

OWN: Final = 'br|/?(b|i|sub|sup|extra)|span style="color:#[0-9a-f]{6}"|/span'  # in our own texts
MARKUP: Final = re.compile(f'<(?!({OWN})>)')


def embed_data(name: str, content: object) -> str:
    """Return data for the page's script."""
    return embed_json(name, json.dumps(content, separators=(',', ':'), allow_nan=False))


def embed_json(name: str, text: str) -> str:
    """Return JSON for the page's script; no text in it can end the element."""
    safe = text.replace('<', '\\u003c')
    return f'<script type="application/json" id="{name}">{safe}</script>'


def render_tile(name: str, value: str, unit: str, note: str) -> str:
    """Return one large figure."""
    return (
        f'<div class="tile"><dt>{escape(name)}</dt><dd><b>{escape(value)}</b> '
        f'<span>{escape(unit)}</span><small>{escape(note)}</small></dd></div>'
    )


def render_html_table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table of results: heads, and lines of as many cells, all of it plain text."""
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in heads)
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(each)}</td>" for each in cells)}</tr>' for cells in lines
    )
    return f'<table class="results"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'


def render_section(
    name: str, heading: str, caption: str, picture: Figure | str, *, timed: bool = False
) -> str:
    """
    Return one picture with heading and caption.

    Parameters
    ----------
    name : str
        Of the picture on its page.
    heading, caption : str
        Plain text.
    picture : Figure or str
        What to draw, or as HTML why there is nothing to draw.
    timed : bool
        Whether x is time: such pictures share one cursor and zoom together.

    """
    words, about = escape(heading), escape(caption)
    body = (
        picture if isinstance(picture, str) else embed_picture(name, words, about, picture, timed)
    )
    return (
        f'<figure class="panel" id="panel-{name}" aria-labelledby="title-{name}">'
        f'<h2 id="title-{name}">{words}</h2>{body}</figure>'
    )


def sanitize_figure(picture: Figure) -> object:
    """
    Return a figure for the page's script, in which no text is more than a word in bold.

    Plotly takes some HTML in texts, links and styles among it, and a name may be a stranger's.
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


def embed_picture(name: str, words: str, about: str, picture: Figure, timed: bool) -> str:
    """Return the place of a picture, its caption and its data; words are HTML already."""
    return (
        f'<div class="plot" data-panel="{name}" data-timed="{str(timed).lower()}" '
        f'role="img" aria-label="{words}. {about}"></div>'
        f'<figcaption>{about}</figcaption>{embed_data(f"figure-{name}", sanitize_figure(picture))}'
    )


def render_terms(content: Mapping[str, str], code: bool = False) -> str:
    """Return a list of terms; what is code is what a person types."""
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
    Return what every page ends with.

    Parameters
    ----------
    facts : mapping of str to str
        Where the page comes from.
    commands : mapping of str to str
        How to go on: what to do, and what to type for it.
    files : mapping of str to str
        Whole files by name, folded.

    """
    lists = [f'<dl class="facts">\n{render_terms(facts)}\n</dl>'] if facts else []
    if commands:
        lists.append(f'<dl class="facts commands">\n{render_terms(commands, code=True)}\n</dl>')
    folded = [
        f'<details><summary>{escape(name)}</summary>'
        f'<pre tabindex="0">{escape(text)}</pre></details>'
        for name, text in files.items()
    ]
    words = [
        *(['where this comes from'] if facts else []),
        *(['how to go on'] if commands else []),
    ]
    inside = '\n'.join(lists) if len(lists) < 2 else f'<div class="halves">{"".join(lists)}</div>'
    return (
        '<section class="panel ending" aria-labelledby="title-ending">'
        f'<h2 id="title-ending">{", and ".join(words).capitalize()}</h2>\n'
        f'{inside}{"".join(folded)}</section>'
    )
