"""
The frame that all pages about many flights share: head, header, tiles, scripts.

A page of its own is a file in `assets`: its style between `<style>` and `</style>`, then what
stands in `main` below the tiles, both with the names of its parts.
"""

from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Final

from lta_analysis.report.page import embedded
from lta_analysis.report.palette import DARK
from lta_config.errors import BadInput
from plotly.offline import get_plotlyjs

BEGIN: Final = '<style>\n'
END: Final = '</style>\n'


def asset(name: str) -> str:
    """Return the text of a file in `assets`."""
    return (files('lta_analysis.report') / 'assets' / name).read_text(encoding='utf-8')


def framed(name: str, *, title: str, kicker: str, about: str, tiles: str, **parts: str) -> str:
    """
    Return a whole page.

    Parameters
    ----------
    name : str
        Of its file in `assets`.
    title, kicker, about, tiles : str
        Of the header, as HTML.
    **parts : str
        What its file names, as HTML.

    """
    style, main = asset(name).removeprefix(BEGIN).split(END, 1)
    return Template(asset('frame.html')).substitute(
        title=title,
        kicker=kicker,
        about=about,
        tiles=tiles,
        style=style,
        main=Template(main).substitute(parts).rstrip(),
        css=asset('page.css'),
        dark=embedded('dark', DARK),
        plotly=get_plotlyjs(),
        js=asset('page.js'),
    )


def written(text: str, out: Path) -> Path:
    """Write a page and return where it is; `BadInput` where it cannot be written."""
    try:
        out.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"The page '{out}' cannot be written ({error.strerror}); make room, or choose "
            'another folder with --out.'
        ) from error
    return out
