"""
Assemble pages from a shared frame: head, header, tiles and scripts.

Each kind of page has a file in `assets`: its style between `<style>` and `</style>`, then the
content below the tiles. Both have placeholders for the page's parts.
"""

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Final

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from lta_report.html_elements import embed_data, render_footer
from lta_report.palette import DARK
from lta_report.script_libraries import embed_plotly, embed_three

BEGIN: Final = '<style>\n'
END: Final = '</style>\n'
NOTHING: Final[Mapping[str, str]] = {}
NOSCRIPT: Final = (
    '<noscript><p class="absent">The figures need JavaScript; the tables do not.</p></noscript>\n'
)


def read_asset(name: str) -> str:
    """Return the text of a file in `assets`."""
    return (files('lta_report') / 'assets' / name).read_text(encoding='utf-8')


def assemble_page(
    name: str,
    *,
    title: str,
    kicker: str,
    about: str,
    tiles: str,
    track: object = None,
    has_plots: bool = True,
    has_scene: bool = False,
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
        Name of its file in `assets`.
    title, kicker, about, tiles : str
        Header as HTML.
    track : object
        Curves that the time cursor follows; none by default.
    has_plots : bool
        Whether to include plotly, which is most of a page's size.
    has_scene : bool
        Whether to include what a 3-D view needs.
    facts, commands, files : mapping of str to str
        Content of the footer; see `render_footer`.
    **parts : str
        Values of the placeholders in its file, as HTML.

    """
    parts['ending'] = render_footer(facts, commands, files)
    # Two steps: values are not searched for placeholders of the frame
    style, main = (Template(text).substitute(parts) for text in split_template(read_asset(name)))
    return Template(read_asset('frame.html')).substitute(
        title=title,
        kicker=kicker,
        about=about,
        tiles=tiles,
        style=style,
        noscript=NOSCRIPT if has_plots else '',
        main=main.rstrip(),
        css=read_asset('page.css'),
        # Colours of the dark theme, for page.js
        dark=embed_data('dark', DARK),
        track=embed_data('track', track or {}),
        plotly=embed_plotly() if has_plots else '',
        three=f'{embed_three()}\n<script>{read_asset("scene.js")}</script>' if has_scene else '',
        js=read_asset('page.js'),
    )


def split_template(text: str) -> list[str]:
    """Return style and content of a page's file."""
    return text.removeprefix(BEGIN).split(END, 1)


def write_file(content: str | bytes, out: Path) -> Path:
    """Write a page or picture and return its path; raise `BadInput` if that fails."""
    try:
        with replace_atomically(out) as part:
            part.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise BadInput(
            f"'{out}' cannot be written ({error.strerror}); free disk space, or choose another "
            'folder with --out.'
        ) from error
    return out
