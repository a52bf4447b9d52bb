"""
The frame that every page shares: head, header, tiles, scripts.

A page of its own is a file in `assets`: its style between `<style>` and `</style>`, then what
stands in `main` below the tiles, both with the names of its parts.
"""

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Final

from lta_config.errors import BadInput
from lta_config.whole_file import whole
from lta_report.palette import DARK
from lta_report.pieces import embedded, ending
from plotly.offline import get_plotlyjs

BEGIN: Final = '<style>\n'
END: Final = '</style>\n'
NOTHING: Final[Mapping[str, str]] = {}
NOSCRIPT: Final = (
    '<noscript><p class="absent">The pictures need JavaScript; the tables do not.</p></noscript>\n'
)


def asset(name: str) -> str:
    """Return the text of a file in `assets`."""
    return (files('lta_report') / 'assets' / name).read_text(encoding='utf-8')


def framed(
    name: str,
    *,
    title: str,
    kicker: str,
    about: str,
    tiles: str,
    track: object = None,
    drawn: bool = True,
    facts: Mapping[str, str] = NOTHING,
    commands: Mapping[str, str] = NOTHING,
    files: Mapping[str, str] = NOTHING,
    **parts: str,
) -> str:
    """
    Return a whole page.

    Parameters
    ----------
    name : str
        Of its file in `assets`.
    title, kicker, about, tiles : str
        Of the header, as HTML.
    track : object
        What the page's one instant moves along; nothing by default.
    drawn : bool
        Whether anything is drawn by plotly, which is most of a page's size.
    facts, commands, files : mapping of str to str
        What the page ends with; see `ending`, which its file names.
    **parts : str
        What its file names besides, as HTML.

    """
    parts['ending'] = ending(facts, commands, files)
    style, main = (Template(text).substitute(parts) for text in halves(asset(name)))
    return Template(asset('frame.html')).substitute(
        title=title,
        kicker=kicker,
        about=about,
        tiles=tiles,
        style=style,
        noscript=NOSCRIPT if drawn else '',
        main=main.rstrip(),
        css=asset('page.css'),
        dark=embedded('dark', DARK),
        track=embedded('track', track or {}),
        plotly=f'<script>{get_plotlyjs()}</script>' if drawn else '',
        js=asset('page.js'),
    )


def halves(text: str) -> list[str]:
    """Return style and content of a page's own file."""
    return text.removeprefix(BEGIN).split(END, 1)


def written(content: str | bytes, out: Path) -> Path:
    """Write a page or picture and return where it is; `BadInput` where it cannot be written."""
    try:
        with whole(out) as part:
            part.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise BadInput(
            f"The page '{out}' cannot be written ({error.strerror}); make room, or choose "
            'another folder with --out.'
        ) from error
    return out
