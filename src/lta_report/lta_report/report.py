"""
Declare the report of a study once; it renders to a page, a terminal, JSON and pictures.

A study returns a `Report`. `report_page` renders it as HTML, `report_terminal` prints it, and
`report_output` writes the files of the results folder.
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
    """
    A table of text; the first cell of a row is its name.

    Attributes
    ----------
    heading : str
        Title of the table.
    heads : sequence of str
        One per column.
    rows : sequence of sequence of str
        Cells of each row; an `Emphasis` is bold.
    note : str
        Remark below the table.
    groups : tuple of (str, int)
        Heads above the heads, each with the number of columns that it spans; none by default.
    printed : bool
        Whether the terminal shows the table.
    colors : mapping of str to str
        Colour on the page of all cells with a text, such as a verdict.

    """

    heading: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ''
    groups: tuple[tuple[str, int], ...] = ()
    printed: bool = True
    colors: Mapping[str, CellColor] = field(default_factory=dict)


@final
@dataclass(frozen=True, slots=True)
class Picture:
    """
    A figure with heading and caption.

    Attributes
    ----------
    name : str
        Id on the page, and name of its PNG file.
    heading, caption : str
        Plain text.
    figure : Figure
        The figure.
    height : int
        Height on the page. [px]
    timed : bool
        Whether x is time: such figures share a cursor and zoom together.
    command : str
        The command that draws it, shown below the caption.
    bag : str
        The bag of its flight, relative to the page.

    """

    name: str
    heading: str
    caption: str
    figure: Figure
    height: int = 400
    timed: bool = False
    command: str = ''
    bag: str = ''


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


Block = Picture | TextTable | TextSection | Grid | ReportSection


@final
@dataclass(frozen=True, slots=True)
class Report:
    """
    The results of a study, declared once.

    Attributes
    ----------
    command : str
        Words of the command, such as 'energy hover'.
    subject : str
        What was studied.
    headline : str
        The result in one sentence. It counts failed items.
    introduction : str
        What was done, in one or two sentences.
    tiles : sequence of Tile
        Key figures.
    blocks : sequence of Block
        Content in the order of the page.
    data : mapping or list
        Content of the JSON file, in SI units.
    facts, commands, files : mapping of str to str
        Footer of the page: origin of the results, next steps, and whole files.
    closing : sequence of str
        Lines that only the terminal shows, after the headline.
    json_name : str
        Name of the JSON file; the last word of the command by default.
    outputs : mapping of str to str
        Further files of the results folder: name and content.
    status : int
        Exit status of the command.

    """

    command: str
    subject: str
    headline: str
    introduction: str
    tiles: Sequence[Tile]
    blocks: Sequence[Block]
    data: Mapping[str, Any] | list[Any]
    facts: Mapping[str, str] = field(default_factory=dict)
    commands: Mapping[str, str] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    closing: Sequence[str] = ()
    json_name: str = ''
    outputs: Mapping[str, str] = field(default_factory=dict)
    status: int = 0


def transpose_table(table: TextTable) -> TextTable:
    """Transpose a table, so that a few long rows fit a narrow terminal."""
    rows = [
        [head, *(row[place] for row in table.rows)]
        for place, head in enumerate(table.heads[1:], start=1)
    ]
    heads = [table.heads[0], *(row[0] for row in table.rows)]
    return TextTable(table.heading, heads, rows, table.note)
