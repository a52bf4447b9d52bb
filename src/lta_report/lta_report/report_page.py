# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Render a report as one self-contained HTML page, and write all files of its folder."""

from collections.abc import Mapping, Sequence
from functools import cache
import hashlib
from html import escape
from importlib.util import find_spec
from pathlib import Path
import re
from string import Template
from typing import Final
import zipfile

from lta_config.atomic_file import replace_atomically
from lta_config.machine import find_cache_folder
from lta_report.formatting import MISSING, Tile
from lta_report.html_elements import (
    embed_data,
    pack_text,
    render_footer,
    render_section,
    render_tile,
)
from lta_report.palette import DARK
from lta_report.report import (
    Block,
    CellColor,
    Emphasis,
    Grid,
    HtmlBlock,
    Picture,
    Report,
    ReportSection,
    TextSection,
    TextTable,
)
from lta_report.results_folder import read_asset, split_template, write_file, write_json
from lta_report.screenshots import write_pictures
from plotly.offline import get_plotlyjs

PAGE: Final = 'report.html'
# A cell that starts like a number (but not like a heading, '1. Title'), or is a dash or empty
NUMERIC_CELL: Final = re.compile(
    rf'(?!\d+\. )[-+\N{{MINUS SIGN}}<>≤≥±~]?\s?(?:\.?\d|[∞{MISSING}])|-?$|none$|never\b'
)
MARKS: Final = re.compile(r'\*\*(.+?)\*\*|\*(.+?)\*|`(.+?)`')  # strong, emphasis, code
LEAST_LISTED_SECTIONS: Final = 5  # sections of a page that get a list of contents
NOSCRIPT: Final = (
    '<noscript><p class="absent">The figures need JavaScript; the tables do not.</p></noscript>\n'
)
TAGS: Final = ('b', 'i', 'code')


def render_report(report: Report) -> str:
    """Return the HTML of a report's page."""
    subject = f' · {report.subject}' if report.subject else ''
    style, script = split_template(read_asset(report.asset)) if report.asset else ('', '')
    parts = {
        'tile_width': f'{choose_tile_width(report.tiles)}',
        'blocks': '\n'.join([render_contents(report.blocks), *map(render_block, report.blocks)]),
        'scene': report.scene,
        'bar': report.time_bar,
        'more_style': style,
        'more': script.rstrip(),
        'ending': render_footer(report.facts, report.commands, report.files),
    }
    three = f'{embed_three()}\n<script>{read_asset("scene.js")}</script>'
    # Plotly is most of a page's size
    has_plots = 'class="plot"' in parts['blocks']
    # Two steps: values are not searched for placeholders of the frame
    style, main = (
        Template(text).substitute(parts) for text in split_template(read_asset('report.html'))
    )
    return Template(read_asset('frame.html')).substitute(
        title=escape(report.headline),
        kicker=escape(report.command + subject),
        about=escape(report.introduction),
        tiles='\n'.join(render_tile(*each) for each in report.tiles),
        style=style,
        noscript=NOSCRIPT if has_plots else '',
        main=main.rstrip(),
        css=read_asset('page.css'),
        # Colours of the dark theme, for page.js
        dark=embed_data('dark', DARK),
        track=embed_data('track', report.track or {}),
        plotly=embed_plotly() if has_plots else '',
        three=three if report.scene else '',
        js=read_asset('page.js'),
    )


def choose_tile_width(tiles: Sequence[Tile]) -> int:
    """Return the least width of a tile [px]."""
    # Ten tiles fit one line of a wide window; long words, such as channels, need more
    usual = 140 if len(tiles) <= 8 else 118
    longest = max((len(word) for each in tiles for word in each.name.split()), default=0)
    return max(usual, min(28 + 6 * longest, 200))


def render_contents(blocks: Sequence[Block]) -> str:
    """Return links to the sections of a long page; empty on a short one."""
    headings = [each.heading for each in blocks if isinstance(each, ReportSection)]
    if len(headings) < LEAST_LISTED_SECTIONS:
        return ''
    links = ''.join(
        f'<li><a href="#{name_section(each)}">{escape(each)}</a></li>' for each in headings
    )
    return f'<nav class="panel contents"><h2>Contents</h2><ul>{links}</ul></nav>'


def name_section(heading: str) -> str:
    """Return the id of a section on the page."""
    return 'section-' + re.sub(r'\W+', '-', heading.lower()).strip('-')


def render_block(block: Block) -> str:
    """Return one block as HTML."""
    match block:
        case Picture():
            command = f'<p class="note"><code>{escape(block.command)}</code></p>'
            return render_section(
                block.name, block.heading, block.caption, block.figure, timed=block.timed,
                height=block.height, more=command if block.command else '', packed=True,
            )  # fmt: skip
        case TextTable():
            return render_table_section(block)
        case TextSection():
            return render_text_section(block)
        case HtmlBlock():
            return render_panel(block.heading, block.html) if block.heading else block.html
        case Grid():
            inside = '\n'.join(map(render_block, block.blocks))
            style = f'grid-template-columns: repeat({block.columns}, minmax(0, 1fr))'
            name = f' id="panel-{block.name}"' if block.name else ''
            return f'<div class="grid"{name} style="{style}">\n{inside}\n</div>'
        case ReportSection():
            inside = '\n'.join(map(render_block, block.blocks))
            if block.folded:
                summary = f'<summary>{escape(block.heading)}</summary>'
                return f'<details class="group">{summary}\n{inside}</details>'
            return render_panel(block.heading, inside, 'panel group', name_section(block.heading))


def render_panel(heading: str, body: str, kind: str = 'panel', name: str = '') -> str:
    """Return a panel; without a heading or an id if that is empty."""
    words = escape(heading)
    named = (f' aria-label="{words}"', f'<h2>{words}</h2>') if heading else ('', '')
    place = f' id="{name}"' if name else ''
    return f'<section class="{kind}"{place}{named[0]}>{named[1]}{body}</section>'


def render_table_section(table: TextTable) -> str:
    """Return a table in its own panel; columns of words are left-aligned and may wrap."""
    if not table.rows:
        return render_panel(table.heading, '<p class="note">None.</p>')
    classes = ['' if is_numeric(column) else ' class="text"' for column in list_columns(table)]
    heads = ''.join(
        f'<th scope="col"{kind}>{escape(each)}</th>'
        for each, kind in zip(table.heads, classes, strict=True)
    )
    top = ''.join(
        f'<th scope="colgroup" colspan="{span}">{escape(name)}</th>' if name
        else f'<td colspan="{span}"></td>'
        for name, span in table.groups
    )  # fmt: skip
    rows = [f'<tr>{render_cells(row, classes, table.colors)}</tr>' for row in table.rows]
    words = escape(table.heading)
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ''
    return render_panel(
        table.heading,
        f'<div class="wide"><table class="report"><caption class="hidden">{words}</caption>'
        f'<thead>{f"<tr>{top}</tr>" if top else ""}<tr>{heads}</tr></thead>'
        f'<tbody>{"".join(rows)}</tbody></table></div>{note}',
    )


def list_columns(table: TextTable) -> list[list[str]]:
    """Return the cells of each column."""
    return [[row[place] for row in table.rows] for place in range(len(table.heads))]


def is_numeric(cells: Sequence[str]) -> bool:
    """Return whether a column holds numbers, with units or intervals perhaps."""
    return all(NUMERIC_CELL.match(cell) for cell in cells)


def render_cells(
    row: Sequence[str], classes: Sequence[str], colors: Mapping[str, CellColor]
) -> str:
    """Return the cells of a row; the first one is its head."""
    first, *rest = row
    cells = ''.join(
        f'<td{kind}>{render_text(cell, colors.get(cell))}</td>'
        for cell, kind in zip(rest, classes[1:], strict=True)
    )
    return f'<th scope="row">{render_text(first)}</th>{cells}'


def render_text(cell: str, color: CellColor | None = None) -> str:
    """Return the text of a cell."""
    if color:
        return f'<span class="{color}">{escape(cell)}</span>'
    return f'<b>{escape(cell)}</b>' if isinstance(cell, Emphasis) else escape(cell)


def render_text_section(section: TextSection) -> str:
    """Return paragraphs, or a list of points, in their own panel."""
    texts = map(render_markup if section.marked else escape, section.paragraphs)
    if section.bullets:
        body = f'<ul class="points">{"".join(f"<li>{each}</li>" for each in texts)}</ul>'
    else:
        body = ''.join(f'<p class="note">{each}</p>' for each in texts)
    return render_panel(section.heading, body)


def render_markup(text: str) -> str:
    """Return text with the marks of Markdown as HTML."""

    def replace(match: re.Match[str]) -> str:
        tag = TAGS[(match.lastindex or 1) - 1]
        return f'<{tag}>{match[match.lastindex or 0]}</{tag}>'

    return MARKS.sub(replace, escape(text))


def write_report(
    report: Report, folder: Path, *, page: bool = True, pictures: Path | None = None
) -> Path | None:
    """
    Write the results of a study, and return the path of its page.

    `folder`: results folder, which exists. `page`: whether to write the page. `pictures`: folder
    for a PNG of each figure; needs Chromium, and the page. Raise `BadInput` if writing fails.
    """
    name = report.json_name or f'{report.command.split()[-1]}.json'
    write_json(report.data, folder / name)
    for other, text in report.outputs.items():
        write_file(text, folder / other)
    if not page:
        return None
    written = write_file(render_report(report), folder / PAGE)
    if pictures is not None:
        write_pictures(written, pictures)
    return written


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
