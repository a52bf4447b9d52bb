# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Declare the report of a study once; it renders to a page, a terminal, JSON and pictures.

A study returns a `Report`. `report_page` renders it as HTML and writes the files of the results
folder, `report_terminal` prints it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, final, Literal

from lta_report.formatting import Tile
from plotly.graph_objects import Figure

CellColor = Literal['good', 'bad', 'soft']
STOPPED: Final = 130  # exit status of a study that Ctrl-C ended, as in shells


@final
class Emphasis(str):
    """A cell of a table in bold."""

    __slots__ = ()


@final
@dataclass(frozen=True, slots=True)
class TextTable:
    """A table of text; the first cell of a row is its name."""

    heading: str  # title of the table
    heads: Sequence[str]  # one per column
    rows: Sequence[Sequence[str]]  # cells of each row; an `Emphasis` is bold
    note: str = ''  # remark below the table
    # Heads above the heads, each with the number of columns that it spans; none by default
    groups: tuple[tuple[str, int], ...] = ()
    printed: bool = True  # whether the terminal shows the table
    # Colour on the page of all cells with a text, such as a verdict
    colors: Mapping[str, CellColor] = field(default_factory=dict)


@final
@dataclass(frozen=True, slots=True)
class Picture:
    """A figure with heading and caption."""

    name: str  # id on the page, and name of its PNG file
    # Plain text
    heading: str
    caption: str
    figure: Figure
    height: int = 400  # height on the page [px]
    timed: bool = False  # whether x is time: such figures share a cursor and zoom together
    command: str = ''  # the command that draws it, shown below the caption


@final
@dataclass(frozen=True, slots=True)
class TextSection:
    """
    Paragraphs under a heading; the terminal shows them only if `printed`.

    With `bullets`, the paragraphs are the items of a list. With `marked`, they contain the marks
    of Markdown for *emphasis*, **strong emphasis** and `code`.
    """

    heading: str
    paragraphs: Sequence[str]
    bullets: bool = False
    printed: bool = False
    marked: bool = False


@final
@dataclass(frozen=True, slots=True)
class Grid:
    """Blocks beside each other where the page is wide enough; the name is its id on the page."""

    blocks: 'Sequence[Block]'
    columns: int = 2
    name: str = ''


@final
@dataclass(frozen=True, slots=True)
class ReportSection:
    """Blocks in one panel under a heading; a folded one opens on a click, on the page only."""

    heading: str
    blocks: 'Sequence[Block]'
    folded: bool = False


@final
@dataclass(frozen=True, slots=True)
class HtmlBlock:
    """Ready HTML, such as a menu or a drawing, in a panel if it has a heading; page only."""

    html: str
    heading: str = ''


Block = Picture | TextTable | TextSection | Grid | ReportSection | HtmlBlock


@final
@dataclass(frozen=True, slots=True)
class Report:
    """The results of a study, declared once."""

    command: str  # words of the command, such as 'energy budget'
    subject: str  # what was studied
    # The result in one sentence. It counts failed items.
    headline: str
    introduction: str  # what was done, in one or two sentences
    tiles: Sequence[Tile]  # key figures
    blocks: Sequence[Block]  # content in the order of the page
    data: Mapping[str, Any] | list[Any]  # content of the JSON file, in SI units
    # Footer of the page: origin of the results, next steps, and whole files
    facts: Mapping[str, str] = field(default_factory=dict)
    commands: Mapping[str, str] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    closing: Sequence[str] = ()  # lines that only the terminal shows, after the headline
    json_name: str = ''  # name of the JSON file; the last word of the command by default
    # Further files of the results folder: name and content
    outputs: Mapping[str, str | bytes] = field(default_factory=dict)
    status: int = 0  # exit status of the command
    # 3-D view above all blocks and its time bar, as HTML, and the curves of its cursor
    scene: str = ''
    time_bar: str = ''
    track: object = None
    asset: str = ''  # a file in `assets` with further styles and scripts of the page


def transpose_table(table: TextTable) -> TextTable:
    """Transpose a table, so that a few long rows fit a narrow terminal."""
    rows = [
        [head, *(row[place] for row in table.rows)]
        for place, head in enumerate(table.heads[1:], start=1)
    ]
    heads = [table.heads[0], *(row[0] for row in table.rows)]
    return TextTable(table.heading, heads, rows, table.note, colors=table.colors)
